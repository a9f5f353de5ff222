// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/mesh.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/constants.hpp"
#include "scene/gltf/material.hpp"
#include "scene/normals_and_tangents.hpp"
#include "scene/parallel_errors.hpp"

namespace gazetrace {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr double kWeightTolerance = 0.02;  // the rounding error of four weights in 8 bits
constexpr float kRounding = 1e-4F;         // weights that are this little below zero are none

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
    if (mode == kTriangleStrip) {
      triangles.push_back({v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
    } else {
      triangles.push_back({v[i + 1], v[i + 2], v[0]});
    }
  }
  return triangles;
}

// What is no number of a joint becomes one that no skin has, which is refused where vertices and skin meet.
std::uint32_t joint_of(float number) {
  constexpr float kMost = 16777216;  // 2^24, up to which every whole number is a float
  return number >= 0 && number < kMost ? static_cast<std::uint32_t>(number) : std::numeric_limits<std::uint32_t>::max();
}

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, const GltfPrimitive& primitive, std::string place, Warnings& warnings)
      : document_(document), primitive_(primitive), place_(std::move(place)), warnings_(warnings) {}

  Geometry read(const Material& material, std::int32_t material_index, bool with_skin) {
    Geometry geometry;
    geometry.material = material_index;
    geometry.positions = vectors<Vec3f>("POSITION", 3);
    vertex_count_ = geometry.positions.size();
    geometry.triangles = triangles();
    const VertexNeeds needs = vertex_needs(material);
    if (needs.uv0) {
      geometry.uv0 = vectors<Vec2f>("TEXCOORD_0", 2);
    }
    if (needs.uv1) {
      geometry.uv1 = vectors<Vec2f>("TEXCOORD_1", 2);
    }
    read_colors(geometry);
    read_morph_targets(geometry);
    if (with_skin) {
      read_influences(geometry);
    }
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
      warnings_.push_back(place_ + ": its material has textures, the primitive lacks their TEXCOORD; read at uv 0, 0");
    }
    return geometry;
  }

 private:
  using Attributes = std::map<std::string, int>;

  // Empty where there is no such attribute. `owner` is the place of the attributes in the JSON.
  std::vector<float> floats(const Attributes& attributes, const std::string& owner, const std::string& attribute,
                            int components) const {
    const auto it = attributes.find(attribute);
    if (it == attributes.end()) {
      return {};
    }
    const std::string place = owner + "." + attribute;
    const auto count = document_.accessors[static_cast<std::size_t>(it->second)].count;
    if (vertex_count_ && count != *vertex_count_) {
      throw Error(ErrorKind::input, place,
                  std::to_string(count) + " values for " + std::to_string(*vertex_count_) + " positions",
                  "export the file again");
    }
    // Without a direction, a color or a place in a picture a vertex can still be drawn; without a position or a weight
    // it cannot.
    const bool is_direction = attribute == "NORMAL" || attribute == "TANGENT";
    const bool is_color = attribute.starts_with("COLOR_");
    const bool is_white = is_color && &attributes == &primitive_.attributes;  // what morph targets add is nothing then
    const bool can_be_mended = is_direction || is_color || attribute.starts_with("TEXCOORD_");
    std::size_t mended = 0;
    std::vector<float> values = read_floats(document_, it->second, components, place, can_be_mended ? &mended : nullptr,
                                            is_white ? 1.0F : 0.0F);
    if (mended > 0) {
      warnings_.push_back(place + ": " + std::to_string(mended) + " elements are not finite; they are taken as " +
                          (is_white       ? "white"
                           : is_direction ? "zero, and made from the triangles"
                                          : "zero"));
    }
    return values;
  }

  std::vector<float> floats(const std::string& attribute, int components) const {
    return floats(primitive_.attributes, place_ + ".attributes", attribute, components);
  }

  template <class Vec>
  std::vector<Vec> vectors(const char* attribute, int components) const {
    return as_vectors<Vec>(floats(attribute, components), components);
  }
  template <class Vec>
  static std::vector<Vec> as_vectors(const std::vector<float>& values, int components) {
    std::vector<Vec> result(values.size() / static_cast<std::size_t>(components));
    static_assert(std::is_trivially_copyable_v<Vec>);
    if (!result.empty()) {
      std::memcpy(static_cast<void*>(result.data()), values.data(), values.size() * sizeof(float));
    }
    return result;
  }

  void read_morph_targets(Geometry& geometry) const {
    for (std::size_t t = 0; t < primitive_.targets.size(); ++t) {
      const std::string owner = place_ + ".targets[" + std::to_string(t) + "]";
      const auto displacements = [&](const char* attribute) {
        return as_vectors<Vec3f>(floats(primitive_.targets[t], owner, attribute, 3), 3);
      };
      MorphTarget target{displacements("POSITION"), displacements("NORMAL"), displacements("TANGENT"), {}, {}, {}};
      const auto coordinates = [&](const char* attribute, const std::vector<Vec2f>& base) {
        return base.empty() ? std::vector<Vec2f>()
                            : as_vectors<Vec2f>(floats(primitive_.targets[t], owner, attribute, 2), 2);
      };
      target.uv0 = coordinates("TEXCOORD_0", geometry.uv0);
      target.uv1 = coordinates("TEXCOORD_1", geometry.uv1);
      if (!geometry.colors.empty()) {
        target.colors = colors(primitive_.targets[t], owner, 0);
      } else if (primitive_.targets[t].contains("COLOR_0")) {
        warnings_.push_back(owner + ".COLOR_0: the primitive has no colours that it could change; it is left out");
      }
      geometry.morph_targets.push_back(std::move(target));
    }
  }

  // Reads JOINTS_n and WEIGHTS_n for all n that exist. Weights are scaled to a sum of 1; where their sum is off by more
  // than rounding, there is a warning.
  void read_influences(Geometry& geometry) const {
    std::vector<std::vector<float>> joints;
    std::vector<std::vector<float>> weights;
    for (std::size_t set = 0;; ++set) {
      const std::string number = std::to_string(set);
      joints.push_back(floats("JOINTS_" + number, 4));
      weights.push_back(floats("WEIGHTS_" + number, 4));
      if (joints.back().empty() != weights.back().empty()) {
        throw Error(ErrorKind::input, place_ + ".attributes",
                    joints.back().empty() ? "WEIGHTS_" + number + " comes without JOINTS_" + number
                                          : "JOINTS_" + number + " comes without WEIGHTS_" + number,
                    "export the file again");
      }
      if (joints.back().empty()) {
        break;
      }
    }
    const std::size_t sets = joints.size() - 1;
    JointInfluences& influences = geometry.influences;
    influences.per_vertex = static_cast<std::uint32_t>(4 * sets);
    std::size_t far_off = 0;
    std::size_t unbound = 0;
    for (std::size_t vertex = 0; vertex < *vertex_count_ && sets > 0; ++vertex) {
      double sum = 0;
      for (std::size_t k = 0; k < 4 * sets; ++k) {
        float weight = weights[k / 4][4 * vertex + k % 4];
        weight = weight < 0 && weight > -kRounding ? 0 : weight;
        if (weight < 0) {
          throw Error(ErrorKind::input, place_ + ".attributes.WEIGHTS_" + std::to_string(k / 4),
                      "vertex " + std::to_string(vertex) + " has a negative weight",
                      "repair the skin and export again");
        }
        sum += static_cast<double>(weight);
        influences.weights.push_back(weight);
        // The joint of a weight of 0 may be any number.
        influences.joints.push_back(weight > 0 ? joint_of(joints[k / 4][4 * vertex + k % 4]) : 0);
      }
      if (!(sum > 0)) {  // as other programs do, it follows the first joint that it names
        influences.joints[vertex * 4 * sets] = joint_of(joints[0][4 * vertex]);
        influences.weights[vertex * 4 * sets] = 1;
        ++unbound;
        continue;
      }
      far_off += std::abs(sum - 1) > kWeightTolerance ? 1 : 0;
      for (auto weight = influences.weights.end() - static_cast<std::ptrdiff_t>(4 * sets);
           weight != influences.weights.end(); ++weight) {
        *weight = static_cast<float>(static_cast<double>(*weight) / sum);
      }
    }
    if (unbound > 0) {
      warnings_.push_back(place_ + ": all joint weights of " + std::to_string(unbound) +
                          " vertices are zero; they follow their first joint");
    }
    if (far_off > 0) {
      warnings_.push_back(place_ + ": the joint weights of " + std::to_string(far_off) +
                          " vertices do not sum to 1; they were scaled to do so");
    }
  }

  // COLOR_0, with this alpha where there are three components.
  std::vector<Vec4f> colors(const Attributes& attributes, const std::string& owner, float alpha) const {
    const auto it = attributes.find("COLOR_0");
    if (it == attributes.end() || document_.accessors[static_cast<std::size_t>(it->second)].components != 3) {
      return as_vectors<Vec4f>(floats(attributes, owner, "COLOR_0", 4), 4);
    }
    std::vector<Vec4f> colors;
    for (const Vec3f& rgb : as_vectors<Vec3f>(floats(attributes, owner, "COLOR_0", 3), 3)) {
      colors.push_back({rgb.x, rgb.y, rgb.z, alpha});
    }
    return colors;
  }

  // Colours are clamped to 0..1 (glTF 2.0, 3.7.2.1), since larger ones would reflect more light than arrives.
  void read_colors(Geometry& geometry) const {
    geometry.colors = colors(primitive_.attributes, place_ + ".attributes", 1);
    std::size_t outside = 0;
    const auto unit = [](float value) { return value > 0 ? std::min(value, 1.0F) : 0.0F; };
    for (Vec4f& color : geometry.colors) {
      const Vec4f clamped{unit(color.x), unit(color.y), unit(color.z), unit(color.w)};
      outside += clamped == color ? 0 : 1;
      color = clamped;
    }
    if (outside > 0) {
      warnings_.push_back(place_ + ".attributes.COLOR_0: the colours of " + std::to_string(outside) +
                          " vertices are outside 0..1 and were clamped");
    }
  }

  std::vector<Triangle> triangles() const {
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
      warnings_.push_back(place_ + ": " + std::to_string(corners.size()) +
                          " corners are not a multiple of 3; the last ones are left out");
    }
    return assemble(primitive_.mode, corners);
  }

  const GltfDocument& document_;
  const GltfPrimitive& primitive_;
  std::string place_;
  Warnings& warnings_;
  std::optional<std::size_t> vertex_count_;
};

struct OneMesh {
  Mesh mesh;
  std::vector<std::string> ignored;
  Warnings warnings;
};

OneMesh make_mesh(const GltfDocument& document, std::size_t index, const std::vector<Material>& materials,
                  std::int32_t default_material, bool with_skin) {
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
    Geometry geometry = PrimitiveReader(document, primitive, place, result.warnings)
                            .read(materials[static_cast<std::size_t>(material)], material, with_skin);
    if (!geometry.triangles.empty()) {
      result.mesh.geometries.push_back(std::move(geometry));
    }
  }
  return result;
}

}  // namespace

MeshResult make_meshes(const GltfDocument& document, const std::vector<Material>& materials,
                       std::int32_t default_material, int threads, const std::function<void()>& mesh_done) {
  std::vector<char> has_skin(document.meshes.size(), 0);
  for (const GltfNode& node : document.nodes) {
    if (node.mesh >= 0 && node.skin >= 0) {
      has_skin[static_cast<std::size_t>(node.mesh)] = 1;
    }
  }
  std::vector<OneMesh> parts(document.meshes.size());
  parallel_for_first_error(parts.size(), threads, [&](std::size_t i) {
    parts[i] = make_mesh(document, i, materials, default_material, has_skin[i] != 0);
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
