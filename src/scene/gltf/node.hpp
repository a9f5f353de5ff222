// SPDX-License-Identifier: Apache-2.0
// Flattens the hierarchy of nodes to world space: instances, lights and cameras.
#pragma once

#include <optional>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"

namespace gazetrace {

struct WorldNode {
  int node = 0;
  Affine to_world;
  Quatd rotation;  // product of all rotations on the chain, without scales; gives a direction where to_world has none
  bool hidden = false;  // or a node above it is
};

// The nodes of the scene at rest, parents before children. It does not recurse, so only memory limits the depth.
std::vector<WorldNode> world_nodes(const GltfDocument& document, std::vector<int>& parents);

Affine local_transform(const GltfNode& node);
// The rotation of an affine map, or `fallback` where it has none.
Quatd rotation_or(const Affine& map, const Quatd& fallback);

// Makes instances of the meshes that hold triangles; those whose transform has no inverse are left out with one
// warning. Each animated instance gets a motion, and each one that changes its shape a deformation. Meshes with a skin
// follow its joints, not their node (glTF 2.0 section 3.7.3.3). A skin or morph weights that never change are applied
// to `meshes` at once.
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
