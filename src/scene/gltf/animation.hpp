// SPDX-License-Identifier: Apache-2.0
// glTF animations of nodes: whatever hangs on them, cameras and meshes alike, follows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/keyframes.hpp"
#include "scene/gltf/node.hpp"

namespace gazetrace {

std::string animation_name(const GltfDocument& document, std::size_t index);

// Nodes from the root to `node`.
std::vector<int> chain_to(int node, const std::vector<int>& parents);

// A chain of nodes with the tracks that move them: those of the first animation with a channel on the chain; a second
// one is another take, not more of the same. `what` names the end of the chain in warnings.
std::vector<AnimatedNode> animated_chain(const GltfDocument& document, const std::vector<int>& chain,
                                         const std::string& what, Warnings& warnings);

// The weights of the node's morph targets over time: those of the first animation that has a channel of them. Nothing
// where none does.
std::optional<WeightTrack> animated_weights(const GltfDocument& document, int node, std::size_t targets,
                                            const std::string& what, Warnings& warnings);

// Leaves only one animation its channels: by name, or by number where no animation has that name. Error(usage) lists
// what there is.
void keep_animation(GltfDocument& document, const std::string& name);

// Of all tracks; 0 where there is none.
std::int64_t last_key_ns(const std::vector<AnimatedNode>& nodes);

// By node: 1 where it or a parent has a channel of translation, rotation or scale.
std::vector<char> moved_nodes(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                              const std::vector<int>& parents);

// What animations change and this program shows at rest: punctual lights.
void list_unshown_motion(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                         const std::vector<int>& parents, std::vector<std::string>& ignored, Warnings& warnings);

}  // namespace gazetrace
