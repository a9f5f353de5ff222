// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_mesh.hpp"

#include <cstring>
#include <optional>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf_accessor.hpp"
#include "scene/gltf_material.hpp"
#include "scene/parallel_errors.hpp"
#include "scene/surface.hpp"

namespace gazetrace {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr int kTriangles = 4, kStrip = 5;  // else 6, a fan

std::string primitive_place(const GltfDocument& document, std::size_t mesh, std::size_t primitive) {
  return document.path + ": meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

// glTF 2.0 section 3.7.2.1: the order of corners keeps every triangle counter-clockwise.
std::vector<Triangle> assemble(int mode, const std::vector<std::uint32_t>& v) {
  std::vector<Triangle> triangles;
  if (mode == kTriangles) {
    triangles.reserve(v.size() / 3);
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
      triangles.push_back({v[i], v[i + 1], v[i + 2]});
    }
    return triangles;
  }
  for (std::size_t i = 0; i + 2 < v.size(); ++i) {
    if (mode == kStrip) {
      triangles.push_back({v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
    } else {
      triangles.push_back({v[i + 1], v[i + 2], v[0]});
    }
  }
  return triangles;
}

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, const GltfPrimitive& primitive, std::string place)
      : document_(document), primitive_(primitive), place_(std::move(place)) {}

  Geometry read(const Material& material, std::int32_t material_index, Warnings& warnings) {
    Geometry geometry;
    geometry.material = material_index;
    geometry.positions = vectors<Vec3f>("POSITION", 3);
    vertex_count_ = geometry.positions.size();
    geometry.triangles = triangles(warnings);
    const VertexNeeds needs = vertex_needs(material);
    if (needs.uv0) {
      geometry.uv0 = vectors<Vec2f>("TEXCOORD_0", 2);
    }
    if (needs.uv1) {
      geometry.uv1 = vectors<Vec2f>("TEXCOORD_1", 2);
    }
    read_colors(geometry);
    geometry.normals = vectors<Vec3f>("NORMAL", 3);
    if (geometry.normals.empty()) {
      make_flat_normals(geometry);
    } else {
      repair_normals(geometry);
      if (needs.tangents) {
        geometry.tangents = vectors<Vec4f>("TANGENT", 4);
        repair_tangents(geometry);
      }
    }
    if (needs.tangents && geometry.tangents.empty()) {
      make_tangents(geometry, material.normal_texture);
    }
    if ((needs.uv0 && geometry.uv0.empty()) || (needs.uv1 && geometry.uv1.empty())) {
      warnings.push_back(place_ + ": its material has textures, the primitive lacks their TEXCOORD; read at uv 0, 0");
    }
    return geometry;
  }

 private:
  std::optional<int> accessor(const char* attribute) const {
    const auto it = primitive_.attributes.find(attribute);
    return it == primitive_.attributes.end() ? std::nullopt : std::optional<int>(it->second);
  }
  std::string attribute_place(const char* attribute) const { return place_ + ".attributes." + attribute; }

  // Empty when the primitive has no such attribute.
  std::vector<float> floats(const char* attribute, int components) const {
    const auto index = accessor(attribute);
    if (!index) {
      return {};
    }
    const std::string place = attribute_place(attribute);
    std::vector<float> values = read_floats(document_, *index, components, place);
    const std::size_t count = values.size() / static_cast<std::size_t>(components);
    if (vertex_count_ && count != *vertex_count_) {
      throw Error(ErrorKind::input, place,
                  std::to_string(count) + " values for " + std::to_string(*vertex_count_) + " positions",
                  "export the file again");
    }
    return values;
  }

  template <class Vec>
  std::vector<Vec> vectors(const char* attribute, int components) const {
    const std::vector<float> values = floats(attribute, components);
    std::vector<Vec> result(values.size() / static_cast<std::size_t>(components));
    static_assert(std::is_trivially_copyable_v<Vec>);
    if (!result.empty()) {
      std::memcpy(static_cast<void*>(result.data()), values.data(), values.size() * sizeof(float));
    }
    return result;
  }

  void read_colors(Geometry& geometry) const {
    const auto index = accessor("COLOR_0");
    if (!index) {
      return;
    }
    if (document_.accessors[static_cast<std::size_t>(*index)].components != 3) {
      geometry.colors = vectors<Vec4f>("COLOR_0", 4);
      return;
    }
    for (const Vec3f& rgb : vectors<Vec3f>("COLOR_0", 3)) {
      geometry.colors.push_back({rgb.x, rgb.y, rgb.z, 1});
    }
  }

  std::vector<Triangle> triangles(Warnings& warnings) const {
    std::vector<std::uint32_t> corners;
    if (primitive_.indices >= 0) {
      const std::string place = place_ + ".indices";
      corners = read_indices(document_, primitive_.indices, place);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        if (corners[i] >= *vertex_count_) {
          throw Error(ErrorKind::input, place,
                      "index " + std::to_string(corners[i]) + " at position " + std::to_string(i) +
                          " is not below the vertex count of " + std::to_string(*vertex_count_),
                      "export the file again");
        }
      }
    } else {
      corners.resize(*vertex_count_);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] = static_cast<std::uint32_t>(i);
      }
    }
    if (primitive_.mode == kTriangles && corners.size() % 3 != 0) {
      warnings.push_back(place_ + ": " + std::to_string(corners.size()) +
                         " corners are no multiple of 3; the last ones are left out");
    }
    return assemble(primitive_.mode, corners);
  }

  const GltfDocument& document_;
  const GltfPrimitive& primitive_;
  std::string place_;
  std::optional<std::size_t> vertex_count_;
};

struct OneMesh {
  Mesh mesh;
  std::vector<std::string> ignored;
  Warnings warnings;
};

OneMesh make_mesh(const GltfDocument& document, std::size_t index, const std::vector<Material>& materials,
                  std::int32_t default_material) {
  OneMesh result;
  const GltfMesh& from = document.meshes[index];
  result.mesh.name = from.name;
  for (std::size_t p = 0; p < from.primitives.size(); ++p) {
    const GltfPrimitive& primitive = from.primitives[p];
    const std::string place = primitive_place(document, index, p);
    if (primitive.mode < kTriangles) {
      result.ignored.push_back("meshes[" + std::to_string(index) + "].primitives[" + std::to_string(p) +
                               "]: " + (primitive.mode == 0 ? "points" : "lines") + " are not rendered");
      continue;
    }
    if (!primitive.attributes.contains("POSITION")) {
      result.ignored.push_back("meshes[" + std::to_string(index) + "].primitives[" + std::to_string(p) +
                               "]: has no POSITION");
      continue;
    }
    const std::int32_t material = primitive.material >= 0 ? primitive.material : default_material;
    Geometry geometry = PrimitiveReader(document, primitive, place)
                            .read(materials[static_cast<std::size_t>(material)], material, result.warnings);
    if (!geometry.triangles.empty()) {
      result.mesh.geometries.push_back(std::move(geometry));
    }
  }
  return result;
}

}  // namespace

MeshResult make_meshes(const GltfDocument& document, const std::vector<Material>& materials,
                       std::int32_t default_material, int threads, const std::function<void()>& mesh_done) {
  std::vector<OneMesh> parts(document.meshes.size());
  parallel_for_first_error(parts.size(), threads, [&](std::size_t i) {
    parts[i] = make_mesh(document, i, materials, default_material);
    mesh_done();
  });
  MeshResult result;
  result.meshes.reserve(parts.size());
  for (OneMesh& part : parts) {
    result.meshes.push_back(std::move(part.mesh));
    result.ignored.insert(result.ignored.end(), part.ignored.begin(), part.ignored.end());
    result.warnings.insert(result.warnings.end(), part.warnings.begin(), part.warnings.end());
  }
  return result;
}

}  // namespace gazetrace
