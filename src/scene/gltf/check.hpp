// SPDX-License-Identifier: Apache-2.0
// Reads the JSON before the parser does and refuses what it would stumble over or not notice: unknown required
// extensions, references and ranges that lead nowhere, node cycles.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/compression.hpp"

namespace gazetrace {

struct GltfBufferSource {
  std::string uri;  // empty: the .glb chunk, or no data at all
  std::uint64_t byte_length = 0;
  bool fallback = false;  // EXT_meshopt_compression: for programs without it; mostly without data
};

struct GltfImageSource {
  std::string name, uri;
  int buffer_view = -1;
};

struct CheckedGltf {
  std::string json;  // buffers and images replaced by one-byte placeholders
  std::vector<GltfBufferSource> buffers;
  std::vector<GltfImageSource> images;
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
};

// Extensions that are understood; extensionsRequired may name no others.
const std::vector<std::string>& known_gltf_extensions();

// Error(input) names the file, the JSON place and what is wrong.
CheckedGltf check_gltf_json(const std::string& path, std::string_view json_text);

}  // namespace gazetrace
