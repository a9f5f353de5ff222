// SPDX-License-Identifier: Apache-2.0
// glTF animations of nodes, which move cameras and meshes alike.
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

// The nodes from the root to `node`.
std::vector<int> chain_to(int node, const std::vector<int>& parents);

// A chain of nodes with the tracks that move them. They are those of the first animation with a channel on the chain: a
// second animation is an alternative, so the two are not combined. `what` names the end of the chain in warnings.
std::vector<AnimatedNode> animated_chain(const GltfDocument& document, const std::vector<int>& chain,
                                         const std::string& what, Warnings& warnings);

// The weights of the node's morph targets over time, from the first animation that has a channel for them; empty where
// none has.
std::optional<WeightTrack> animated_weights(const GltfDocument& document, int node, std::size_t targets,
                                            const std::string& what, Warnings& warnings);

// Removes the channels of all animations but one, which is chosen by name, or by number where no animation has that
// name. Error(usage) lists the animations.
void keep_animation(GltfDocument& document, const std::string& name);

// The time of the last keyframe of all tracks; 0 where there is none.
std::int64_t last_key_ns(const std::vector<AnimatedNode>& nodes);

// For each node, 1 where it or a parent of it has a channel for translation, rotation or scale.
std::vector<char> moved_nodes(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                              const std::vector<int>& parents);

// Reports what animations move and gazetrace shows at rest, namely punctual lights.
void list_unshown_motion(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                         const std::vector<int>& parents, std::vector<std::string>& ignored, Warnings& warnings);

}  // namespace gazetrace
