// SPDX-License-Identifier: Apache-2.0
// What deforms the mesh of a glTF node: its skin, the weights of its morph targets, and the animation of both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"

namespace gazetrace {

// At most one of the two; neither where the mesh is shown as it is stored.
struct NodeDeformation {
  std::optional<MeshPose> fixed;        // no animation changes it
  std::optional<Deformation> animated;  // over time
};

// `label` names the node in warnings. Error(input) for joints that a vertex follows and the skin does not have, for too
// few inverse bind matrices, for weights that do not match the morph targets. Without inverse bind matrices they are
// the identity (glTF 2.0 section 5.28).
NodeDeformation deformation_of_node(const GltfDocument& document, int node, const std::vector<int>& parents,
                                    const Mesh& mesh, const std::string& label, Warnings& warnings);

}  // namespace gazetrace
