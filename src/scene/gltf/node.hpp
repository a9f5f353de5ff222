// SPDX-License-Identifier: Apache-2.0
// The node hierarchy flattened to world space: instances, lights, cameras.
#pragma once

#include <optional>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"

namespace gazetrace {

struct WorldNode {
  int node = 0;
  Affine to_world;
  Quatd rotation;  // of all rotations on the way, scales left out: a direction where to_world has none
};

// The nodes of the scene at rest, parents before children. No recursion: depth is only bounded by memory.
std::vector<WorldNode> world_nodes(const GltfDocument& document, std::vector<int>& parents);

Affine local_transform(const GltfNode& node);
// The rotation of an affine map where it has one, else `fallback`.
Quatd rotation_or(const Affine& map, const Quatd& fallback);

// Instances of meshes that hold triangles; those that cannot be inverted are left out with one warning. Animated ones
// get a motion each, those that change their shape a deformation. Meshes with a skin follow its joints, not their node
// (glTF 2.0 section 3.7.3.3). A skin or morph weights that never change are applied to `meshes` here and now.
struct PlacedMeshes {
  std::vector<Instance> instances;
  std::vector<Motion> motions;
  std::vector<Deformation> deformations;
};
PlacedMeshes make_instances(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                            const std::vector<int>& parents, const std::vector<Material>& materials,
                            std::vector<Mesh>& meshes, Warnings& warnings);

std::vector<PunctualLight> make_lights(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                       Warnings& warnings);

// Cameras with the animation of their node and its parents.
std::vector<SceneCamera> make_cameras(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                      const std::vector<int>& parents, Warnings& warnings);

}  // namespace gazetrace
