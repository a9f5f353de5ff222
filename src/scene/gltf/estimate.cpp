// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/estimate.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>
#include <vector>

#include "core/memory_limit.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "scene/gltf/constants.hpp"
#include "scene/gltf/json.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Bytes of the JSON while it is parsed, for each of its own: two trees of values, one after the other, and the
// document.
constexpr std::uint64_t kJsonBytes = 12;
constexpr std::uint64_t kInstanceBytes = 400;  // in the scene and in the tree over instances
// A triangle in a tree of high quality while it is built, and prepared for shading; and what the program and its
// libraries take before. With these, what is reckoned for Sponza, Lost Empire, San Miguel and a grid of spheres is
// 0.97, 1.02, 1.33 and 0.82 times the peak that `gazetrace scene --bvh` measured.
constexpr std::uint64_t kTreeBytes = 240;
constexpr std::uint64_t kProgramBytes = std::uint64_t{100} << 20U;
constexpr std::uint64_t kTriangleBytes = 12;

// Counts and products that files claim stay below 2^62, so that sums of a few do not wrap.
std::uint64_t times(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 56U;
  return a == 0 || b <= kMost / a ? a * b : kMost;
}

void add_to(std::uint64_t& sum, std::uint64_t more) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 58U;
  sum = std::min(sum + more, kMost);
}

struct PrimitiveSize {
  std::uint64_t vertices = 0, triangles = 0, vertex_bytes = 0;
};

PrimitiveSize size_of(const GltfDocument& document, const GltfPrimitive& primitive) {
  const auto count = [&](int accessor) { return document.accessors[static_cast<std::size_t>(accessor)].count; };
  const auto has = [&](const char* name) { return primitive.attributes.contains(name); };
  PrimitiveSize size;
  if (primitive.mode < kTriangles || !has("POSITION")) {
    return size;
  }
  const std::uint64_t positions = count(primitive.attributes.at("POSITION"));
  const std::uint64_t corners = primitive.indices >= 0 ? count(primitive.indices) : positions;
  size.triangles = primitive.mode == kTriangles ? corners / 3 : corners;  // of a strip or fan nearly as many as corners
  // Without normals every triangle has vertices of its own.
  size.vertices = has("NORMAL") ? positions : std::max(positions, 3 * std::min(size.triangles, corners));
  size.vertex_bytes = 12 + 12 + 16 + (has("TEXCOORD_0") ? 8U : 0U) + (has("TEXCOORD_1") ? 8U : 0U) +
                      (has("COLOR_0") ? 16U : 0U) + (has("JOINTS_0") ? 24U : 0U) + 24 * primitive.targets.size();
  return size;
}

bool deforms(const GltfDocument& document, const GltfNode& node) {
  if (node.mesh < 0) {
    return false;
  }
  const auto& primitives = document.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return node.skin >= 0 ||
         std::any_of(primitives.begin(), primitives.end(), [](const auto& one) { return !one.targets.empty(); });
}

std::uint64_t instances_of(const GltfDocument& document, const GltfNode& node) {
  std::uint64_t count = node.mesh >= 0 ? 1 : 0;
  for (const auto& [name, accessor] : node.instancing) {
    count = std::max(count, document.accessors[static_cast<std::size_t>(accessor)].count);
  }
  return count;
}

// Whatever moves keeps the transforms of its parents up to the root, each with its keys: a few bytes of JSON can be the
// children of a long chain. Called once the nodes are known to form trees.
class MotionSizes {
 public:
  explicit MotionSizes(const GltfDocument& document)
      : document_(document),
        parent_(document.nodes.size(), -1),
        path_bytes_(document.nodes.size(), kAnimatedNodeBytes),
        moves_(document.nodes.size(), 0) {
    add_keys();
    std::vector<int> order;
    for (std::size_t i = 0; i < document.nodes.size(); ++i) {
      for (const int child : document.nodes[i].children) {
        parent_[at(child)] = static_cast<int>(i);
      }
    }
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      if (parent_[i] < 0) {
        order.push_back(static_cast<int>(i));
      }
    }
    for (std::size_t k = 0; k < order.size(); ++k) {  // parents before children
      const auto parent = at(order[k]);
      for (const int child : document.nodes[parent].children) {
        add_to(path_bytes_[at(child)], path_bytes_[parent]);
        moves_[at(child)] = static_cast<char>(moves_[at(child)] | moves_[parent]);
        order.push_back(child);
      }
    }
  }

  // Of all bodies, cameras and skins.
  [[nodiscard]] std::uint64_t bytes() const {
    constexpr std::uint64_t kEnough = std::uint64_t{1} << 38U;  // above what any machine is asked for
    std::uint64_t sum = 0;
    std::vector<std::size_t> seen_by(document_.nodes.size(), 0);
    for (std::size_t i = 0; i < document_.nodes.size() && sum < kEnough; ++i) {
      const GltfNode& node = document_.nodes[i];
      if ((node.mesh >= 0 || node.camera >= 0) && moves_[i] != 0) {
        add_to(sum, path_bytes_[i]);
      }
      if (node.mesh >= 0 && node.skin >= 0) {
        for (const int joint : document_.skins[at(node.skin)].joints) {
          for (int up = joint; up >= 0 && seen_by[at(up)] != i + 1 && sum < kEnough; up = parent_[at(up)]) {
            seen_by[at(up)] = i + 1;
            add_to(sum, own_bytes(up));
          }
          add_to(sum, kJointBytes);
        }
      }
    }
    return sum;
  }

 private:
  static constexpr std::uint64_t kAnimatedNodeBytes = 600, kJointBytes = 300;
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  [[nodiscard]] std::uint64_t own_bytes(int node) const {
    const int parent = parent_[at(node)];
    return path_bytes_[at(node)] - (parent < 0 ? 0 : std::min(path_bytes_[at(parent)], path_bytes_[at(node)]));
  }
  void add_keys() {
    for (const GltfAnimation& animation : document_.animations) {
      for (const GltfAnimation::Channel& channel : animation.channels) {
        if (channel.node >= 0) {
          const GltfAnimation::Sampler& sampler = animation.samplers[at(channel.sampler)];
          // A time and a value of four doubles for each.
          add_to(path_bytes_[at(channel.node)], times(document_.accessors[at(sampler.input)].count, 8) +
                                                    times(document_.accessors[at(sampler.output)].count, 32));
          moves_[at(channel.node)] = 1;
        }
      }
    }
  }

  const GltfDocument& document_;
  std::vector<int> parent_;
  std::vector<std::uint64_t> path_bytes_;  // of a node and all its parents
  std::vector<char> moves_;
};

std::string mib(std::uint64_t bytes) {
  constexpr std::uint64_t kMib = std::uint64_t{1} << 20U;
  return bytes < kMib ? std::to_string(bytes) + " bytes" : std::to_string(bytes >> 20U) + " MiB";
}

}  // namespace

std::uint64_t most_memory_bytes() {
  return memory_of_process_bytes() / 4 * 3;
}

SceneEstimate estimate_geometry(const GltfFile& file, const CheckedGltf& checked, const GltfDocument& document) {
  SceneEstimate estimate;
  estimate.file_bytes = file.bytes.size() + times(file.json.size(), kJsonBytes);
  for (std::size_t i = 0; i < checked.buffers.size(); ++i) {
    const std::string& uri = checked.buffers[i].uri;
    if (!uri.empty() && !is_data_uri(uri)) {
      std::error_code ignored;
      const std::string path =
          resolve_uri(file.path, file.roots, uri, file.path + ": buffers[" + std::to_string(i) + "]");
      const auto size = fs::file_size(path, ignored);
      add_to(estimate.file_bytes, ignored ? 0 : size);
    }
  }
  for (const MeshoptView& packed : checked.meshopt_views) {
    // Of a claim beyond what the packed bytes can hold, meshopt.cpp says more.
    constexpr std::uint64_t kMostOfAByte = 64;
    add_to(estimate.file_bytes, std::min(times(packed.count, packed.stride), times(packed.length, kMostOfAByte)));
  }
  std::vector<std::uint64_t> mesh_bytes(document.meshes.size()), mesh_triangles(document.meshes.size());
  for (std::size_t m = 0; m < document.meshes.size(); ++m) {
    for (const GltfPrimitive& primitive : document.meshes[m].primitives) {
      const PrimitiveSize size = size_of(document, primitive);
      add_to(mesh_bytes[m], times(size.vertices, size.vertex_bytes));
      add_to(mesh_bytes[m], times(size.triangles, kTriangleBytes));
      add_to(mesh_triangles[m], size.triangles);
    }
    add_to(estimate.geometry_bytes, mesh_bytes[m]);
    add_to(estimate.triangles, mesh_triangles[m]);
  }
  std::uint64_t instances = 0;
  std::uint64_t tree_triangles = estimate.triangles;
  for (const GltfNode& node : document.nodes) {
    add_to(instances, instances_of(document, node));
    if (deforms(document, node)) {  // it has vertices and a tree of its own
      add_to(estimate.geometry_bytes, mesh_bytes[static_cast<std::size_t>(node.mesh)]);
      add_to(tree_triangles, mesh_triangles[static_cast<std::size_t>(node.mesh)]);
    }
  }
  estimate.nodes = document.nodes.size();
  estimate.node_bytes = times(estimate.nodes, kNodeBytes) + times(instances, kInstanceBytes);
  add_to(estimate.node_bytes, MotionSizes(document).bytes());
  estimate.tree_bytes = times(tree_triangles, kTreeBytes) + kProgramBytes;
  return estimate;
}

void check_file_memory(const std::string& path, std::uint64_t memory_bytes) {
  std::error_code unknown;
  const std::uint64_t bytes = fs::is_regular_file(path, unknown) ? fs::file_size(path, unknown) : 0;
  if (!unknown && bytes > std::max(memory_bytes, kProgramBytes)) {  // smaller ones are read, and what they need is told
    throw Error(ErrorKind::input, path, "is a file of " + mib(bytes) + "; the limit of memory is " + mib(memory_bytes),
                "raise `max-memory`");
  }
}

void check_json_memory(const std::string& path, std::uint64_t file_bytes, std::string_view json,
                       std::uint64_t memory_bytes) {
  const std::uint64_t wanted = kProgramBytes + file_bytes + json_memory_bytes(json);
  if (wanted > memory_bytes) {
    throw Error(ErrorKind::input, path,
                "will take about " + mib(wanted) + " of memory to be parsed; the limit is " + mib(memory_bytes),
                "keep large data in buffers, or raise `max-memory`");
  }
}

void add_pictures(const TextureTable& textures, int threads, SceneEstimate& estimate) {
  std::vector<std::uint64_t> decoded;
  for (const PictureSize& size : textures.sizes()) {
    const std::uint64_t texels =
        times(static_cast<std::uint64_t>(size.width_px), static_cast<std::uint64_t>(size.height_px));
    // Pictures of more than 8 bits are kept in 16 and decoded in 32.
    add_to(estimate.texture_bytes, times(texels, size.is_deep ? 8 : 4) / 3 * 4 * size.uses);
    decoded.push_back(times(texels, size.is_deep ? 16 : 4) * size.uses);
  }
  estimate.pictures = decoded.size();
  std::sort(decoded.begin(), decoded.end(), std::greater<>());
  for (std::size_t i = 0; i < std::min(decoded.size(), static_cast<std::size_t>(resolve_threads(threads))); ++i) {
    add_to(estimate.picture_bytes, decoded[i]);
  }
}

void check_memory(const SceneEstimate& estimate, std::uint64_t memory_bytes, const std::string& path) {
  if (estimate.total_bytes() <= memory_bytes) {
    return;
  }
  throw Error(ErrorKind::input, path,
              "will take about " + mib(estimate.total_bytes()) + " of memory (geometry " +
                  mib(estimate.geometry_bytes) + ", tree " + mib(estimate.tree_bytes) + ", textures " +
                  mib(estimate.texture_bytes + estimate.picture_bytes) + ", nodes " + mib(estimate.node_bytes) +
                  ", files " + mib(estimate.file_bytes) + "); the limit is " + mib(memory_bytes),
              "make it smaller, or raise `max-memory`");
}

}  // namespace gazetrace
