// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/node.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <memory>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/constants.hpp"
#include "scene/gltf/skin.hpp"

namespace gazetrace {
namespace {

// A ray in an instance's own space must stay within what Embree accepts (1e18). World coordinates up to 1e6 do so where
// no entry of the inverse is larger than this.
constexpr double kMaxInverseEntry = 1e12;

double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Whether there is an inverse in single precision, too, since rays are traced in it.
bool has_usable_inverse(const Affine& map) {
  const double det = determinant(map);
  if (!is_finite(map.x) || !is_finite(map.y) || !is_finite(map.z) || !is_finite(map.t) || !(std::abs(det) >= FLT_MIN) ||
      !(std::abs(det) <= FLT_MAX) || largest(map.t) > kMaxInverseEntry) {
    return false;
  }
  // The rows of the inverse are cross products of the columns, divided by the determinant.
  const double entry =
      std::max({largest(cross(map.y, map.z)), largest(cross(map.z, map.x)), largest(cross(map.x, map.y))}) /
      std::abs(det);
  const double forward = std::max({largest(map.x), largest(map.y), largest(map.z)});
  return entry <= kMaxInverseEntry && forward <= kMaxInverseEntry;
}

std::string node_label(const GltfDocument& document, int node) {
  return "nodes[" + std::to_string(node) + "] '" + document.nodes[static_cast<std::size_t>(node)].name + "'";
}

// EXT_mesh_gpu_instancing: one transform for each element of its attributes.
std::vector<Affine> instancing_transforms(const GltfDocument& document, int node_index) {
  const GltfNode& node = document.nodes[static_cast<std::size_t>(node_index)];
  const std::string place =
      document.path + ": nodes[" + std::to_string(node_index) + "].extensions.EXT_mesh_gpu_instancing.attributes.";
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, int components) {
    const auto it = node.instancing.find(name);
    std::vector<float> values;
    if (it != node.instancing.end()) {
      const auto elements = document.accessors[static_cast<std::size_t>(it->second)].count;
      if (count && *count != elements) {
        throw Error(ErrorKind::input, place + name,
                    std::to_string(elements) + " elements, other attributes have " + std::to_string(*count),
                    "export the file again");
      }
      count = elements;
      values = read_floats(document, it->second, components, place + name);
    }
    return values;
  };
  const std::vector<float> t = read("TRANSLATION", 3);
  const std::vector<float> r = read("ROTATION", 4);
  const std::vector<float> s = read("SCALE", 3);
  std::vector<Affine> transforms(count.value_or(0));
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    const Vec3d translation = t.empty() ? Vec3d{} : Vec3d{t[3 * i], t[3 * i + 1], t[3 * i + 2]};
    const Quatd rotation = r.empty() ? Quatd{} : normalize(Quatd{r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]});
    const Vec3d scale = s.empty() ? Vec3d{1, 1, 1} : Vec3d{s[3 * i], s[3 * i + 1], s[3 * i + 2]};
    transforms[i] = make_affine(translation, rotation, scale);
  }
  return transforms;
}

// The mesh in a pose that never changes, without its morph targets and influences.
Mesh in_pose(const Mesh& mesh, const MeshPose& pose, const std::vector<Material>& materials) {
  Mesh posed = mesh;
  for (Geometry& geometry : posed.geometries) {
    const Material& material = materials[static_cast<std::size_t>(geometry.material)];
    DeformedVertices vertices = deform(geometry, pose, material.normal_texture);
    geometry.positions = std::move(vertices.positions);
    geometry.normals = std::move(vertices.normals);
    geometry.tangents = std::move(vertices.tangents);
    geometry.uv0 = vertices.uv0.empty() ? std::move(geometry.uv0) : std::move(vertices.uv0);
    geometry.uv1 = vertices.uv1.empty() ? std::move(geometry.uv1) : std::move(vertices.uv1);
    geometry.colors = vertices.colors.empty() ? std::move(geometry.colors) : std::move(vertices.colors);
    for (auto& triangle : geometry.triangles) {
      if (vertices.is_mirrored(triangle)) {
        std::swap(triangle[1], triangle[2]);
      }
    }
  }
  return posed;
}

// The parents of all glTF nodes, also of those outside the scene, since joints need not be in it.
std::vector<int> all_parents(const GltfDocument& document) {
  std::vector<int> parents(document.nodes.size(), -1);
  for (std::size_t i = 0; i < document.nodes.size(); ++i) {
    for (const int child : document.nodes[i].children) {
      parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
    }
  }
  return parents;
}

std::string name_of_node(const GltfDocument& document, int index) {
  const std::string& name = document.nodes[static_cast<std::size_t>(index)].name;
  return name.empty() ? "#" + std::to_string(index) : name;
}

// Of each node, the outermost one above it; see Instance::asset. Parents come before their children.
std::vector<int> outermost_nodes(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                 const std::vector<int>& parents) {
  std::vector<int> outermost(document.nodes.size(), -1);
  int wrapper = -1;  // the last node in a row that holds all others and no mesh
  for (std::vector<int> level = document.roots; level.size() == 1;) {
    const GltfNode& only = document.nodes[static_cast<std::size_t>(level.front())];
    if (only.mesh >= 0 || only.children.empty()) {
      break;
    }
    wrapper = level.front();
    level = only.children;
  }
  for (const WorldNode& world : nodes) {
    const int parent = parents[static_cast<std::size_t>(world.node)];
    const bool is_outermost = parent < 0 || parent == wrapper || outermost[static_cast<std::size_t>(parent)] < 0;
    outermost[static_cast<std::size_t>(world.node)] =
        is_outermost ? world.node : outermost[static_cast<std::size_t>(parent)];
  }
  return outermost;
}

// Frees the morph targets and influences of meshes that nothing deforms, and meshes that are used only in another pose.
void drop_unused_shapes(const PlacedMeshes& placed, const std::vector<char>& was_posed, std::vector<Mesh>& meshes) {
  std::vector<char> deforms(meshes.size(), 0);
  std::vector<char> used(meshes.size(), 0);
  for (const Instance& instance : placed.instances) {
    char& mark = deforms[static_cast<std::size_t>(instance.mesh)];
    mark = static_cast<char>(mark | (instance.deformation >= 0 ? 1 : 0));
    used[static_cast<std::size_t>(instance.mesh)] = 1;
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (m < was_posed.size() && was_posed[m] != 0 && used[m] == 0) {
      meshes[m].geometries.clear();
    }
    for (Geometry& geometry : meshes[m].geometries) {
      if (deforms[m] == 0) {
        geometry.morph_targets = {};
        geometry.influences = {};
      }
    }
  }
}

}  // namespace

Affine local_transform(const GltfNode& node) {
  return node.has_matrix ? node.matrix : make_affine(node.translation, node.rotation, node.scale);
}

Quatd rotation_or(const Affine& map, const Quatd& fallback) {
  const double y = length(map.y);
  const double z = length(map.z);
  const bool usable =
      std::isfinite(y) && std::isfinite(z) && y > 0 && z > 0 && length(cross(map.y / y, map.z / z)) > 1e-12;
  return usable ? rotation_of(map) : fallback;
}

std::vector<WorldNode> world_nodes(const GltfDocument& document, std::vector<int>& parents) {
  parents.assign(document.nodes.size(), -1);
  std::vector<WorldNode> nodes;
  nodes.reserve(document.nodes.size());
  const auto add = [&](int index, const WorldNode& parent) {
    const GltfNode& node = document.nodes[static_cast<std::size_t>(index)];
    const Quatd own = node.has_matrix ? rotation_or(node.matrix, Quatd{}) : node.rotation;
    nodes.push_back({index, parent.to_world * local_transform(node), normalize(parent.rotation * own),
                     parent.hidden || node.hidden});
  };
  for (const int root : document.roots) {
    add(root, WorldNode{});
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const WorldNode parent = nodes[i];
    for (const int child : document.nodes[static_cast<std::size_t>(parent.node)].children) {
      parents[static_cast<std::size_t>(child)] = parent.node;
      add(child, parent);
    }
  }
  return nodes;
}

PlacedMeshes make_instances(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                            const std::vector<int>& parents, const std::vector<Material>& materials,
                            std::vector<Mesh>& meshes, Warnings& warnings) {
  PlacedMeshes placed;
  const std::vector<int> skeleton_parents = all_parents(document);
  std::vector<char> was_posed(meshes.size(), 0);
  const std::vector<char> moved = moved_nodes(document, nodes, parents);
  const std::vector<int> outermost = outermost_nodes(document, nodes, parents);
  Warnings of_motions;
  std::size_t left_out = 0;
  int first_left_out = -1;
  for (const WorldNode& world : nodes) {
    const GltfNode& node = document.nodes[static_cast<std::size_t>(world.node)];
    if (world.hidden || node.mesh < 0 || meshes[static_cast<std::size_t>(node.mesh)].geometries.empty()) {
      continue;
    }
    const bool has_skin = node.skin >= 0;
    std::vector<Affine> places{Affine{}};  // in the node's own space
    if (!node.instancing.empty() && !has_skin) {
      places = instancing_transforms(document, world.node);
    }
    std::shared_ptr<const std::vector<AnimatedNode>> chain;
    if (moved[static_cast<std::size_t>(world.node)] != 0 && !has_skin) {
      chain = std::make_shared<const std::vector<AnimatedNode>>(
          animated_chain(document, chain_to(world.node, parents), node_label(document, world.node), of_motions));
    }
    NodeDeformation shape =
        deformation_of_node(document, world.node, skeleton_parents, meshes[static_cast<std::size_t>(node.mesh)],
                            node_label(document, world.node), of_motions);
    std::int32_t mesh = node.mesh;
    if (shape.fixed) {
      was_posed[static_cast<std::size_t>(mesh)] = 1;
      meshes.push_back(in_pose(meshes[static_cast<std::size_t>(mesh)], *shape.fixed, materials));
      mesh = static_cast<std::int32_t>(meshes.size()) - 1;
    }
    std::int32_t deformation = -1;
    if (shape.animated) {
      deformation = static_cast<std::int32_t>(placed.deformations.size());
      placed.deformations.push_back(std::move(*shape.animated));
    }
    const std::string name = name_of_node(document, world.node);
    const std::string asset = name_of_node(document, outermost[static_cast<std::size_t>(world.node)]);
    for (const Affine& place : places) {
      const Affine to_world =
          has_skin ? Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, shape.about_m} : world.to_world * place;
      if (chain) {
        // Kept whatever its transform is at rest, since the tracer checks the transform at each time.
        placed.instances.push_back(
            {mesh, to_world, static_cast<std::int32_t>(placed.motions.size()), deformation, name, asset});
        placed.motions.push_back(
            {[chain, place](std::int64_t t_ns) { return transform_of_chain(*chain, t_ns) * place; },
             last_key_ns(*chain)});
      } else if (has_usable_inverse(to_world)) {
        placed.instances.push_back({mesh, to_world, -1, deformation, name, asset});
      } else if (left_out++ == 0) {
        first_left_out = world.node;
      }
    }
  }
  if (left_out > 0) {
    warnings.push_back(std::to_string(left_out) + (left_out == 1 ? " instance is" : " instances are") +
                       " left out: a scale of zero, or too small or large for single precision (" +
                       (left_out == 1 ? "" : "first: ") + node_label(document, first_left_out) + ")");
  }
  if (!of_motions.empty()) {
    warnings.push_back(
        of_motions.front() +
        (of_motions.size() == 1 ? "" : "; and " + std::to_string(of_motions.size() - 1) + " more like this"));
  }
  drop_unused_shapes(placed, was_posed, meshes);
  return placed;
}

std::vector<PunctualLight> make_lights(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                                       Warnings& warnings) {
  std::vector<PunctualLight> lights;
  for (const WorldNode& world : nodes) {
    const int index = document.nodes[static_cast<std::size_t>(world.node)].light;
    if (index < 0 || world.hidden) {
      continue;
    }
    const GltfLight& from = document.lights[static_cast<std::size_t>(index)];
    PunctualLight light;
    light.name = from.name.empty() ? document.nodes[static_cast<std::size_t>(world.node)].name : from.name;
    light.kind = from.type == "directional" ? LightKind::directional
                 : from.type == "spot"      ? LightKind::spot
                                            : LightKind::point;
    // Scale changes neither intensity nor range (KHR_lights_punctual, "Light shared properties").
    light.intensity = to_float(Vec3d{from.color[0], from.color[1], from.color[2]} * from.intensity);
    const float most = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    if (std::min({light.intensity.x, light.intensity.y, light.intensity.z}) < 0) {
      warnings.push_back("light '" + light.name + "': its intensity is negative, and was taken as 0");
    }
    if (most > kMostLight && is_finite(light.intensity)) {
      warnings.push_back("light '" + light.name + "': its intensity is above 1e30, which is the most, and was clamped");
      light.intensity = {std::min(light.intensity.x, kMostLight), std::min(light.intensity.y, kMostLight),
                         std::min(light.intensity.z, kMostLight)};
    }
    light.position_m = world.to_world.t;
    Vec3d direction = normalize(transform_vector(world.to_world, {0, 0, -1}));
    if (!is_finite(direction) || length(direction) == 0) {
      direction = rotate(world.rotation, {0, 0, -1});
    }
    light.direction = to_float(direction);
    light.range_m = static_cast<float>(std::max(from.range, 0.0));
    const double outer = std::clamp(from.outer_cone_rad, 1e-4, kPi / 2);
    const double inner = std::clamp(from.inner_cone_rad, 0.0, outer);
    if (light.kind == LightKind::spot && (outer != from.outer_cone_rad || inner != from.inner_cone_rad)) {
      warnings.push_back("light '" + light.name + "': cone angles were brought into 0 <= inner <= outer <= pi/2");
    }
    light.cos_outer = static_cast<float>(std::cos(outer));
    light.cos_inner = static_cast<float>(std::cos(inner));
    if (!is_finite(light.intensity) || !is_finite(light.position_m)) {
      warnings.push_back("light '" + light.name + "' is left out: its intensity or position is not finite");
      continue;
    }
    lights.push_back(light);
  }
  return lights;
}

}  // namespace gazetrace
