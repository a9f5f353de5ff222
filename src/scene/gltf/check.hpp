// SPDX-License-Identifier: Apache-2.0
// Reads the JSON before the parser does, and refuses what the parser would fail on or not notice: unknown required
// extensions, invalid references and ranges, cycles of nodes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/scene.hpp"
#include "scene/gltf/compression.hpp"

namespace gazetrace {

struct GltfBufferSource {
  std::string uri;  // empty: the chunk of the .glb, or no data at all
  std::uint64_t byte_length = 0;
  bool fallback = false;  // EXT_meshopt_compression: for programs that do not know it, and mostly without data
};

struct GltfImageSource {
  std::string name, uri;
  int buffer_view = -1;
};

struct CheckedGltf {
  std::string json;  // with buffers and images replaced by one-byte placeholders
  std::vector<GltfBufferSource> buffers;
  std::vector<GltfImageSource> images;
  std::vector<MeshoptView> meshopt_views;
  std::vector<DracoPrimitive> draco_primitives;
};

// The extensions that are supported; extensionsRequired may name these and the next ones.
const std::vector<std::string>& known_gltf_extensions();
// What is shown of an extension that is not supported and changes no picture of ours; nullptr for every other name.
const char* shown_without(std::string_view extension);

// `memory_bytes`: as SceneReadOptions, never 0. Error(input) names the file, the JSON place and what is wrong.
CheckedGltf check_gltf_json(const std::string& path, std::string_view json_text, std::uint64_t memory_bytes);

}  // namespace gazetrace
