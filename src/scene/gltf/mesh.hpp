// SPDX-License-Identifier: Apache-2.0
// Makes indexed triangles from glTF primitives.
#pragma once

#include <functional>

#include "gazetrace/scene.hpp"
#include "scene/gltf/document.hpp"

namespace gazetrace {

struct MeshResult {
  std::vector<Mesh> meshes;          // one per glTF mesh; without geometries where it holds no triangles
  std::vector<std::string> ignored;  // primitives of points and lines
  Warnings warnings;
};

// `default_material` is the index for primitives without one; `mesh_done` is called for each mesh, from several
// threads. Error(input) names mesh, primitive and attribute.
MeshResult make_meshes(const GltfDocument& document, const std::vector<Material>& materials,
                       std::int32_t default_material, int threads, const std::function<void()>& mesh_done);

}  // namespace gazetrace
