// SPDX-License-Identifier: Apache-2.0
// Reads numbers from accessors, of every component type, normalised, strided or sparse. check_gltf_ranges() must have
// checked all ranges before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.hpp"

namespace gazetrace {

// Checks that bufferViews lie within buffers and accessors (with their sparse parts) within bufferViews, that strides
// and alignment are valid, and that every node has at most one parent and there is no cycle. Error(input) with the
// place in the JSON.
void check_gltf_ranges(const GltfDocument& document, const std::vector<GltfBufferSource>& buffers);

// Limits what a file may ask for beyond its own size: the zeros of accessors without bufferView, over all their uses,
// and instances. Call it after compressed geometry has been unpacked, whose accessors have no bufferView before.
// Error(input) with the place in the JSON.
void check_gltf_size(const GltfDocument& document);

std::size_t component_size(int component_type);

// The bytes of a bufferView. Error(input) that names `place` where the buffer has no data.
std::span<const std::uint8_t> view_bytes(const GltfDocument& document, int buffer_view, const std::string& place);

// The accessor's count * components values. Normalised integers become 0..1 or -1..1 (glTF 2.0 section 3.6.2.2), others
// keep their value. Error(input) that names `place` where the accessor has other components or a value is not finite;
// with `not_finite`, elements with such values become `instead` and are counted there.
std::vector<float> read_floats(const GltfDocument& document, int accessor, int components, const std::string& place,
                               std::size_t* not_finite = nullptr, float instead = 0);

// The values of an accessor of unsigned integers of any width. Error(input) that names `place` for other accessors.
std::vector<std::uint32_t> read_indices(const GltfDocument& document, int accessor, const std::string& place);

}  // namespace gazetrace
