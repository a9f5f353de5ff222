// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "core/data_root.hpp"
#include "gazetrace/error.hpp"
#include "scene/gltf/foreign_scene.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kChunkJson = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kChunkBin = 0x004E4942;   // "BIN"

std::uint32_t little_endian_u32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8U |
         static_cast<std::uint32_t>(p[2]) << 16U | static_cast<std::uint32_t>(p[3]) << 24U;
}

[[noreturn]] void fail_glb(const std::string& path, const std::string& problem) {
  throw Error(ErrorKind::input, path, problem, "export or copy the .glb again");
}

// glTF 2.0 section 4.4: a 12-byte header, then chunks of length, type, data.
void split_glb(GltfFile& file) {
  const std::span<const std::uint8_t> bytes = file.bytes;
  if (bytes.size() < 20) {
    fail_glb(file.path, "truncated .glb: " + std::to_string(bytes.size()) + " bytes are less than its headers");
  }
  const std::uint32_t version = little_endian_u32(&bytes[4]);
  if (version != 2) {
    throw Error(ErrorKind::input, file.path, "is a .glb of version " + std::to_string(version), "only 2 can be read");
  }
  const std::size_t length = little_endian_u32(&bytes[8]);
  if (length > bytes.size()) {
    fail_glb(file.path, "truncated .glb: its header says " + std::to_string(length) + " bytes, the file has " +
                            std::to_string(bytes.size()));
  }
  std::size_t at = 12;
  bool first = true;
  while (at + 8 <= length) {
    const std::size_t chunk_length = little_endian_u32(&bytes[at]);
    const std::uint32_t type = little_endian_u32(&bytes[at + 4]);
    at += 8;
    if (chunk_length > length - at) {
      fail_glb(file.path, "truncated .glb: a chunk of " + std::to_string(chunk_length) + " bytes at byte " +
                              std::to_string(at) + " ends after the file");
    }
    if (first && type != kChunkJson) {
      fail_glb(file.path, "broken .glb: the first chunk is not JSON");
    }
    if (first) {
      file.json = std::string_view(reinterpret_cast<const char*>(&bytes[at]), chunk_length);
    } else if (type == kChunkBin && file.bin_chunk.empty()) {
      file.bin_chunk = bytes.subspan(at, chunk_length);
    }
    first = false;
    at += chunk_length;
  }
  if (first) {
    fail_glb(file.path, "broken .glb: no JSON chunk");
  }
}

constexpr std::array<std::int8_t, 256> make_base64_table() {
  std::array<std::int8_t, 256> table{};
  for (auto& value : table) {
    value = -1;
  }
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  return table;
}

// RFC 4648 section 4; padding may be missing. Empty where a character is invalid.
std::optional<std::vector<std::uint8_t>> decode_base64(std::string_view text) {
  static constexpr auto kTable = make_base64_table();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) {
    text.remove_suffix(1);
  }
  if (text.size() % 4 == 1) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::int8_t value = kTable[static_cast<unsigned char>(c)];
    if (value < 0) {
      return std::nullopt;
    }
    bits = bits << 6U | static_cast<std::uint32_t>(value);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(held) & 0xFFU));
    }
  }
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> read_bytes(const std::string& path, const std::string& place, std::uint64_t most_bytes) {
  std::error_code error;
  const std::filesystem::path file(path);
  if (std::filesystem::is_directory(file, error)) {
    throw Error(ErrorKind::input, place, "'" + path + "' is a folder, not a file");
  }
  // Checked first, since opening a pipe would wait for its other end forever.
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
    throw Error(ErrorKind::input, place, "'" + path + "' is a pipe or a device, not a file",
                "write its content to a file");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(ErrorKind::input, place, "cannot open '" + path + "'", "check the name and the permissions");
  }
  const auto size = std::filesystem::file_size(file, error);
  std::vector<std::uint8_t> bytes(error ? 0 : std::min<std::uint64_t>(size, most_bytes));
  if (error || !stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    throw Error(ErrorKind::input, place, "cannot read '" + path + "'");
  }
  return bytes;
}

GltfFile read_gltf_file(const std::string& path) {
  GltfFile file;
  file.path = path;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (path.find("://") != std::string::npos) {
      throw Error(ErrorKind::input, path, "this is an address, and files are read", "download it, and give its path");
    }
    throw Error(ErrorKind::input, path, "there is no such file",
                path.starts_with("~/") ? "write the folder out, or leave out the quotes, which keep ~ as it is"
                                       : "give the path of a .gltf or .glb");
  }
  if (std::filesystem::is_directory(path, error)) {
    refuse_folder_as_scene(path);
  }
  file.bytes = read_bytes(path, path, std::numeric_limits<std::uint64_t>::max());
  if (file.bytes.empty()) {
    throw Error(ErrorKind::input, path, "the file is empty", "copy or export it again");
  }
  if (file.bytes.size() >= 4 && little_endian_u32(file.bytes.data()) == kGlbMagic) {
    file.is_binary = true;
    split_glb(file);
  } else {
    file.json = std::string_view(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    if (file.json.starts_with("\xEF\xBB\xBF")) {
      file.json.remove_prefix(3);
    }
    refuse_foreign_scene(path, file.json);
  }
  return file;
}

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

std::vector<std::uint8_t> decode_data_uri(std::string_view uri, const std::string& place) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    throw Error(ErrorKind::input, place, "the data: uri is not base64", "write data:<type>;base64,<text>");
  }
  auto bytes = decode_base64(uri.substr(comma + 1));
  if (!bytes) {
    throw Error(ErrorKind::input, place, "the data: uri holds broken base64", "export the file again");
  }
  return std::move(*bytes);
}

std::string resolve_uri(const std::string& gltf_path, const std::vector<std::filesystem::path>& roots,
                        std::string_view uri, const std::string& place) {
  if (uri.empty()) {
    throw Error(ErrorKind::input, place, "the uri is empty");
  }
  if (uri.find("://") != std::string_view::npos) {
    throw Error(ErrorKind::input, place, "'" + bounded(uri, 200) + "' is not a file", "download it and use its name");
  }
  std::string path = file_of_uri(gltf_path, uri);
  if (!roots.empty()) {
    check_within(roots, path, std::string(uri), place);
  }
  return path;
}

}  // namespace gazetrace
