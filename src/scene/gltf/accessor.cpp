// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "gazetrace/error.hpp"
#include "scene/gltf/constants.hpp"

namespace gazetrace {
namespace {

template <class T>
T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);  // copied, since T need not be aligned
  return value;
}

// glTF 2.0 section 3.6.2.2: f = c / max for unsigned, max(c / max, -1) for signed.
template <class T>
float to_float(T value, bool normalized) {
  if constexpr (std::is_floating_point_v<T>) {
    return value;
  } else {
    const auto number = static_cast<float>(value);
    return normalized ? std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.0F) : number;
  }
}

struct Source {
  const std::uint8_t* data;
  std::size_t stride;
};

template <class T>
void copy_as(const Source& source, std::size_t count, std::size_t components, bool normalized, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* from = source.data + i * source.stride;
    for (std::size_t c = 0; c < components; ++c) {
      *out++ = to_float(load<T>(from + c * sizeof(T)), normalized);
    }
  }
}

void copy_floats(const Source& source, const GltfAccessor& accessor, std::size_t count, float* out) {
  const auto components = static_cast<std::size_t>(accessor.components);
  switch (accessor.component_type) {
    case kByte:
      return copy_as<std::int8_t>(source, count, components, accessor.normalized, out);
    case kUnsignedByte:
      return copy_as<std::uint8_t>(source, count, components, accessor.normalized, out);
    case kShort:
      return copy_as<std::int16_t>(source, count, components, accessor.normalized, out);
    case kUnsignedShort:
      return copy_as<std::uint16_t>(source, count, components, accessor.normalized, out);
    case kUnsignedInt:
      return copy_as<std::uint32_t>(source, count, components, accessor.normalized, out);
    default:
      return copy_as<float>(source, count, components, false, out);
  }
}

void copy_integers(const Source& source, int component_type, std::size_t count, std::uint32_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* from = source.data + i * source.stride;
    out[i] = component_type == kUnsignedByte    ? *from
             : component_type == kUnsignedShort ? load<std::uint16_t>(from)
                                                : load<std::uint32_t>(from);
  }
}

bool is_unsigned_integer(int component_type) {
  return component_type == kUnsignedByte || component_type == kUnsignedShort || component_type == kUnsignedInt;
}

Source source_of(const GltfDocument& document, const GltfAccessor& accessor, const std::string& place) {
  const GltfBufferView& view = document.buffer_views[static_cast<std::size_t>(accessor.buffer_view)];
  const std::size_t packed = component_size(accessor.component_type) * static_cast<std::size_t>(accessor.components);
  return {view_bytes(document, accessor.buffer_view, place).data() + accessor.offset,
          view.stride != 0 ? view.stride : packed};
}

// Overwrites the elements that a sparse accessor lists; `copy` reads `count` elements into the result.
template <class T, class Copy>
void apply_sparse(const GltfDocument& document, const GltfAccessor& accessor, const std::string& place,
                  std::vector<T>& values, Copy copy) {
  const GltfAccessor::Sparse& sparse = *accessor.sparse;
  std::vector<std::uint32_t> indices(sparse.count);
  const Source index_source{view_bytes(document, sparse.indices_view, place).data() + sparse.indices_offset,
                            component_size(sparse.indices_component_type)};
  copy_integers(index_source, sparse.indices_component_type, indices.size(), indices.data());
  const auto components = static_cast<std::size_t>(accessor.components);
  const std::size_t step = component_size(accessor.component_type) * components;
  const std::uint8_t* from = view_bytes(document, sparse.values_view, place).data() + sparse.values_offset;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= accessor.count) {
      throw Error(ErrorKind::input, place,
                  "sparse index " + std::to_string(indices[i]) + " is not below the accessor's count of " +
                      std::to_string(accessor.count),
                  "export the file again");
    }
    copy(Source{from + i * step, step}, &values[indices[i] * components]);
  }
}

}  // namespace

std::size_t component_size(int component_type) {
  switch (component_type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    default:
      return 4;
  }
}

std::span<const std::uint8_t> view_bytes(const GltfDocument& document, int buffer_view, const std::string& place) {
  const GltfBufferView& view = document.buffer_views[static_cast<std::size_t>(buffer_view)];
  const std::span<const std::uint8_t> buffer = document.buffers[static_cast<std::size_t>(view.buffer)];
  if (view.offset + view.length > buffer.size()) {
    throw Error(ErrorKind::input, place, "buffers[" + std::to_string(view.buffer) + "] has no data",
                "give it a uri or a .glb chunk");
  }
  return buffer.subspan(view.offset, view.length);
}

std::vector<float> read_floats(const GltfDocument& document, int accessor_index, int components,
                               const std::string& place, std::size_t* not_finite, float instead) {
  const GltfAccessor& accessor = document.accessors[static_cast<std::size_t>(accessor_index)];
  if (accessor.components != components) {
    throw Error(ErrorKind::input, place,
                "accessors[" + std::to_string(accessor_index) + "] has " + std::to_string(accessor.components) +
                    " components where " + std::to_string(components) + " are needed",
                "export the file again");
  }
  std::vector<float> values(accessor.count * static_cast<std::size_t>(components));
  if (accessor.buffer_view >= 0) {
    copy_floats(source_of(document, accessor, place), accessor, accessor.count, values.data());
  }
  if (accessor.sparse) {
    apply_sparse(document, accessor, place, values,
                 [&](const Source& source, float* out) { copy_floats(source, accessor, 1, out); });
  }
  const auto is_finite = [](float value) { return std::isfinite(value); };
  for (auto bad = std::find_if_not(values.begin(), values.end(), is_finite); bad != values.end();
       bad = std::find_if_not(bad, values.end(), is_finite)) {
    if (not_finite != nullptr) {
      std::fill_n(bad - (bad - values.begin()) % components, components, instead);
      ++*not_finite;
      continue;
    }
    throw Error(ErrorKind::input, place,
                "element " + std::to_string((bad - values.begin()) / components) + " of accessors[" +
                    std::to_string(accessor_index) + "] is not finite",
                "repair the model and export it again");
  }
  return values;
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document, int accessor_index, const std::string& place) {
  const GltfAccessor& accessor = document.accessors[static_cast<std::size_t>(accessor_index)];
  if (accessor.components != 1 || !is_unsigned_integer(accessor.component_type)) {
    throw Error(ErrorKind::input, place,
                "accessors[" + std::to_string(accessor_index) + "] does not hold unsigned scalars, as indices must be",
                "export the file again");
  }
  std::vector<std::uint32_t> values(accessor.count);
  if (accessor.buffer_view >= 0) {
    copy_integers(source_of(document, accessor, place), accessor.component_type, values.size(), values.data());
  }
  if (accessor.sparse) {
    apply_sparse(document, accessor, place, values, [&](const Source& source, std::uint32_t* out) {
      copy_integers(source, accessor.component_type, 1, out);
    });
  }
  return values;
}

}  // namespace gazetrace
