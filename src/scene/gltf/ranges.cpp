// SPDX-License-Identifier: Apache-2.0
// Checks the ranges of bytes and the hierarchy of nodes, which the parser does not check.
#include <optional>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"

namespace gazetrace {
namespace {

// An accessor without a bufferView consists of zeros, and a file may state any size for it.
constexpr std::uint64_t kMaxZeroElements = std::uint64_t{1} << 26U;

class RangeCheck {
 public:
  explicit RangeCheck(const GltfDocument& document) : document_(document) {}

  [[noreturn]] void fail(const char* array, std::size_t index, const std::string& problem) const {
    throw Error(ErrorKind::input, document_.path + ": " + array + "[" + std::to_string(index) + "]", problem,
                "export the file again");
  }

  void views(const std::vector<GltfBufferSource>& buffers) const {
    for (std::size_t i = 0; i < document_.buffer_views.size(); ++i) {
      const GltfBufferView& view = document_.buffer_views[i];
      const std::uint64_t size = buffers[static_cast<std::size_t>(view.buffer)].byte_length;
      if (view.offset > size || view.length > size - view.offset) {
        fail("bufferViews", i,
             "bytes " + std::to_string(view.offset) + " + " + std::to_string(view.length) + " lie outside buffers[" +
                 std::to_string(view.buffer) + "] of " + std::to_string(size) + " bytes");
      }
    }
  }

  // Checks `count` elements of `size` bytes that lie `stride` apart, from `offset` of a view on.
  void elements(const char* array, std::size_t index, int view_index, std::uint64_t offset, std::uint64_t count,
                std::uint64_t size, std::uint64_t stride, std::uint64_t alignment) const {
    const GltfBufferView& view = document_.buffer_views[static_cast<std::size_t>(view_index)];
    if (stride < size) {
      fail(array, index,
           "elements of " + std::to_string(size) + " bytes do not fit the byteStride of " + std::to_string(stride));
    }
    if ((view.offset + offset) % alignment != 0 || stride % alignment != 0) {
      fail(array, index, "its bytes are not aligned to " + std::to_string(alignment));
    }
    // count < 2^32 and stride <= 252, so nothing overflows.
    const std::uint64_t needed = count == 0 ? 0 : (count - 1) * stride + size;
    if (offset > view.length || needed > view.length - offset) {
      fail(array, index,
           std::to_string(count) + " elements reach " + std::to_string(needed) + " bytes past byteOffset " +
               std::to_string(offset) + ", outside bufferViews[" + std::to_string(view_index) + "] of " +
               std::to_string(view.length) + " bytes");
    }
  }

  void accessors() const {
    for (std::size_t i = 0; i < document_.accessors.size(); ++i) {
      const GltfAccessor& accessor = document_.accessors[i];
      const std::uint64_t component = component_size(accessor.component_type);
      const std::uint64_t size = component * static_cast<std::uint64_t>(accessor.components);
      if (accessor.count == 0) {
        fail("accessors", i, "its count is 0");
      }
      if (accessor.buffer_view >= 0) {
        const std::uint64_t stride = document_.buffer_views[static_cast<std::size_t>(accessor.buffer_view)].stride;
        elements("accessors", i, accessor.buffer_view, accessor.offset, accessor.count, size,
                 stride != 0 ? stride : size, component);
      } else if (accessor.count > kMaxZeroElements) {
        fail("accessors", i, "has no bufferView and a count of " + std::to_string(accessor.count));
      }
      if (accessor.sparse) {
        const GltfAccessor::Sparse& sparse = *accessor.sparse;
        const int type = sparse.indices_component_type;
        if (type != 5121 && type != 5123 && type != 5125) {
          fail("accessors", i, "sparse.indices.componentType " + std::to_string(type) + " is not an unsigned integer");
        }
        if (sparse.count > accessor.count) {
          fail("accessors", i, "sparse.count exceeds its count");
        }
        const std::uint64_t index_size = component_size(type);
        elements("accessors", i, sparse.indices_view, sparse.indices_offset, sparse.count, index_size, index_size,
                 index_size);
        elements("accessors", i, sparse.values_view, sparse.values_offset, sparse.count, size, size, component);
      }
    }
  }

  void nodes() const {
    const std::size_t count = document_.nodes.size();
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> parent(count, kNone);
    for (std::size_t i = 0; i < count; ++i) {
      for (const int child_index : document_.nodes[i].children) {
        const auto child = static_cast<std::size_t>(child_index);
        if (parent[child] != kNone) {
          fail("nodes", child,
               "is a child of nodes[" + std::to_string(parent[child]) + "] and of nodes[" + std::to_string(i) +
                   "]; a node has one parent at most");
        }
        parent[child] = i;
      }
    }
    // Since every node has one parent, walking up from a node in a cycle leads back to a node of the same walk.
    std::vector<std::size_t> seen_by(count, kNone);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t at = i; at != kNone && seen_by[at] != i; at = parent[at]) {
        if (seen_by[at] != kNone) {
          break;
        }
        seen_by[at] = i;
        if (parent[at] != kNone && seen_by[parent[at]] == i) {
          fail("nodes", at, "is its own ancestor: its children form a cycle");
        }
      }
    }
    std::vector<bool> is_root(count, false);
    for (const int root : document_.roots) {
      const auto index = static_cast<std::size_t>(root);
      if (parent[index] != kNone || is_root[index]) {
        fail("nodes", index,
             is_root[index] ? "is listed twice in the scene" : "is listed in the scene and has a parent");
      }
      is_root[index] = true;
    }
  }

 private:
  const GltfDocument& document_;
};

}  // namespace

void check_gltf_ranges(const GltfDocument& document, const std::vector<GltfBufferSource>& buffers) {
  const RangeCheck check(document);
  check.views(buffers);
  check.accessors();
  check.nodes();
}

}  // namespace gazetrace
