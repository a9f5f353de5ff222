// SPDX-License-Identifier: Apache-2.0
// The deformation of a glTF node's mesh: its skin, the weights of its morph targets, and the animation of both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"

namespace gazetrace {

// At most one of the two is set; neither where the mesh is used as it is stored.
struct NodeDeformation {
  std::optional<MeshPose> fixed;        // no animation changes it
  std::optional<Deformation> animated;  // over time
  Vec3d about_m;                        // of a skin: the point of the world from which its vertices count
};

// `label` names the node in warnings. Missing inverse bind matrices are the identity (glTF 2.0 section 5.28).
// Error(input) where a vertex follows a joint that the skin does not have, for too few inverse bind matrices, and for
// weights that do not match the morph targets.
NodeDeformation deformation_of_node(const GltfDocument& document, int node, const std::vector<int>& parents,
                                    const Mesh& mesh, const std::string& label, Warnings& warnings);

}  // namespace gazetrace
