// SPDX-License-Identifier: Apache-2.0
// Reads the bytes of a glTF asset: the JSON text, the binary chunk of a .glb, and what uris refer to.
#pragma once

#include <cstdint>
#include <filesystem>
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
  std::vector<std::filesystem::path> roots;  // data_roots(), where its uris may lead; empty: anywhere
};

// A .glb is recognised by its first bytes, not by its name. Error(input) for a missing file and for broken chunks.
GltfFile read_gltf_file(const std::string& path);

// No more than so many of a file's bytes, since it may be any size. Error(input) for what is no file.
std::vector<std::uint8_t> read_bytes(const std::string& path, const std::string& place, std::uint64_t most_bytes);

bool is_data_uri(std::string_view uri);
// Decodes "data:<mime>;base64,<text>". Error(input) that names `place` for anything but well-formed base64.
std::vector<std::uint8_t> decode_data_uri(std::string_view uri, const std::string& place);

// The file system path for a uri: percent escapes are decoded, and it is relative to the folder of the glTF file.
// Error(input) for schemes such as https:, and for paths that lead out of `roots`, unless there are none.
std::string resolve_uri(const std::string& gltf_path, const std::vector<std::filesystem::path>& roots,
                        std::string_view uri, const std::string& place);

}  // namespace gazetrace
