// SPDX-License-Identifier: Apache-2.0
// The bytes of a glTF asset: the JSON text, the .glb binary chunk, and what uris point to.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

struct GltfFile {
  std::string path;
  std::vector<std::uint8_t> bytes;
  std::string_view json;                    // into `bytes`
  std::span<const std::uint8_t> bin_chunk;  // into `bytes`; empty for .gltf
  bool is_binary = false;
};

// Tells .glb from .gltf by its first bytes, not by its name. Error(input) for a missing file and for broken chunks.
GltfFile read_gltf_file(const std::string& path);

std::vector<std::uint8_t> read_whole_file(const std::string& path, const std::string& place);

bool is_data_uri(std::string_view uri);
// "data:<mime>;base64,<text>"; Error(input) at `place` for anything but well-formed base64.
std::vector<std::uint8_t> decode_data_uri(std::string_view uri, const std::string& place);

// A uri beside the glTF file as a file system path: percent escapes decoded, relative to the file's folder.
// Error(input) for schemes such as https:.
std::string resolve_uri(const std::string& gltf_path, std::string_view uri, const std::string& place);

}  // namespace gazetrace
