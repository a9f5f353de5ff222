// SPDX-License-Identifier: Apache-2.0
// Numbers out of accessors: every component type, normalised integers, strides, sparse accessors. All ranges have been
// checked by check_gltf_ranges before.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.hpp"

namespace gazetrace {

// bufferViews within buffers, accessors (and their sparse parts) within bufferViews, strides and alignment; every node
// with at most one parent and no cycle. Error(input) with the JSON place.
void check_gltf_ranges(const GltfDocument& document, const std::vector<GltfBufferSource>& buffers);

// What a file asks for beyond its own size: zeros of accessors without bufferView, over all their uses, and instances.
// After compressed geometry has been unpacked, whose accessors have no bufferView before. Error(input) with the place.
void check_gltf_size(const GltfDocument& document);

std::size_t component_size(int component_type);

// The bytes of a bufferView. Error(input) at `place` when the buffer has no data.
std::span<const std::uint8_t> view_bytes(const GltfDocument& document, int buffer_view, const std::string& place);

// count * components values; normalised integers become 0..1 or -1..1 (glTF 2.0 section 3.6.2.2), others keep their
// value. Error(input) at `place` when the accessor has not `components` or a value is not finite.
std::vector<float> read_floats(const GltfDocument& document, int accessor, int components, const std::string& place);

// Unsigned integers of any width.
std::vector<std::uint32_t> read_indices(const GltfDocument& document, int accessor, const std::string& place);

}  // namespace gazetrace
