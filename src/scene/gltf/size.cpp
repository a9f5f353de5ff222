// SPDX-License-Identifier: Apache-2.0
// Limits how much data a file may ask for that it does not contain, since a few bytes of JSON can name any number of
// zeros any number of times.
#include <algorithm>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/constants.hpp"

namespace gazetrace {
namespace {

// Zeros in place of positions and other attributes are of no use in such numbers: 22 million vertices.
constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 26U;
// Morph targets are mostly zero, and exporters leave the zeros out, so more are allowed: 89 million displacements, 1
// GiB.
constexpr std::uint64_t kMaxMorphZeros = std::uint64_t{1} << 28U;
// Instances whose attributes are all zeros, so that they lie upon each other.
constexpr std::uint64_t kMaxZeroInstances = std::uint64_t{1} << 16U;
constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 24U;

class SizeCheck {
 public:
  explicit SizeCheck(const GltfDocument& document) : document_(document) {}

  void meshes() {
    std::vector<std::uint64_t> posed(document_.meshes.size(), 0);  // number of nodes that need vertices of their own
    for (const GltfNode& node : document_.nodes) {
      if (node.mesh >= 0 && (node.skin >= 0 || has_targets(node.mesh))) {
        ++posed[static_cast<std::size_t>(node.mesh)];
      }
    }
    for (std::size_t m = 0; m < document_.meshes.size(); ++m) {
      const auto& primitives = document_.meshes[m].primitives;
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        const GltfPrimitive& primitive = primitives[p];
        const std::string place = "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]";
        if (primitive.mode < kTriangles) {
          continue;  // not rendered, so nothing is read
        }
        for (const auto& [name, accessor] : primitive.attributes) {
          add(zeros_, std::max<std::uint64_t>(posed[m], 1) * zeros_of(accessor), kMaxZeros, place + ".attributes");
        }
        if (primitive.indices >= 0) {
          add(zeros_, zeros_of(primitive.indices), kMaxZeros, place + ".indices");
        }
        for (const auto& target : primitive.targets) {
          for (const auto& [name, accessor] : target) {
            add(morph_zeros_, zeros_of(accessor), kMaxMorphZeros, place + ".targets");
          }
        }
      }
    }
  }

  void skins_and_animations() {
    for (std::size_t i = 0; i < document_.skins.size(); ++i) {
      if (const int matrices = document_.skins[i].inverse_bind_matrices; matrices >= 0) {
        add(zeros_, zeros_of(matrices), kMaxZeros, "skins[" + std::to_string(i) + "].inverseBindMatrices");
      }
    }
    for (std::size_t i = 0; i < document_.animations.size(); ++i) {
      for (const GltfAnimation::Sampler& sampler : document_.animations[i].samplers) {
        add(zeros_, zeros_of(sampler.input) + zeros_of(sampler.output), kMaxZeros,
            "animations[" + std::to_string(i) + "].samplers");
      }
    }
  }

  void instances() {
    std::uint64_t all = 0;
    std::uint64_t without_data = 0;
    for (std::size_t n = 0; n < document_.nodes.size(); ++n) {
      const GltfNode& node = document_.nodes[n];
      std::uint64_t count = 0;
      bool any_data = false;
      for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
        if (const auto it = node.instancing.find(name); it != node.instancing.end()) {
          count = std::max(count, accessor(it->second).count);
          any_data = any_data || accessor(it->second).buffer_view >= 0;
        }
      }
      if (node.mesh < 0 || count == 0) {
        continue;
      }
      const std::string place = "nodes[" + std::to_string(n) + "].extensions.EXT_mesh_gpu_instancing";
      add(all, count, kMaxInstances, place, "instances");
      if (!any_data) {
        add(without_data, count, kMaxZeroInstances, place, "instances without data");
      }
    }
  }

 private:
  [[nodiscard]] const GltfAccessor& accessor(int index) const {
    return document_.accessors[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] bool has_targets(int mesh) const {
    const auto& primitives = document_.meshes[static_cast<std::size_t>(mesh)].primitives;
    return std::any_of(primitives.begin(), primitives.end(),
                       [](const GltfPrimitive& primitive) { return !primitive.targets.empty(); });
  }
  // The number of zeros, counting components. count < 2^32, so a product with any number of nodes stays below 2^64.
  [[nodiscard]] std::uint64_t zeros_of(int index) const {
    const GltfAccessor& from = accessor(index);
    return from.buffer_view >= 0 ? 0 : from.count * static_cast<std::uint64_t>(from.components);
  }
  void add(std::uint64_t& sum, std::uint64_t more, std::uint64_t most, const std::string& place,
           const char* what = "zeros of accessors without bufferView") const {
    sum += more;
    if (sum > most) {
      throw Error(ErrorKind::input, document_.path + ": " + place,
                  "brings the file to " + std::to_string(sum) + " " + what + "; at most " + std::to_string(most) +
                      " can be loaded",
                  "export the file again");
    }
  }

  const GltfDocument& document_;
  std::uint64_t zeros_ = 0, morph_zeros_ = 0;
};

}  // namespace

void check_gltf_size(const GltfDocument& document) {
  SizeCheck check(document);
  check.meshes();
  check.skins_and_animations();
  check.instances();
}

}  // namespace gazetrace
