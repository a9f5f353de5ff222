// SPDX-License-Identifier: Apache-2.0
// Which files a run reads, and digests of their content.
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunkBytes = std::size_t{8} << 20U;

std::ifstream open_for_reading(const std::string& path) {
  if (fs::is_directory(path)) {
    throw Error(ErrorKind::input, path, "this is a folder, not a file");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, std::string("cannot be opened: ") + std::strerror(errno == 0 ? EIO : errno),
                "check the path");
  }
  return file;
}

std::string read_bytes(std::ifstream& file, std::size_t count) {
  std::string bytes(count, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

// Takes eight bytes a step: scenes are hundreds of megabytes, and every run begins with this.
std::uint64_t hash_chunk(const std::string& bytes) {
  std::array<std::uint64_t, 4> lanes{1, 2, 3, 4};
  std::size_t at = 0;
  for (std::size_t i = 0; at + 8 <= bytes.size(); at += 8, ++i) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, 8);
    std::uint64_t& lane = lanes[i % lanes.size()];
    lane = std::rotl((lane ^ word) * 0x9e3779b97f4a7c15ULL, 31);
  }
  std::uint64_t hash = bytes.size();
  for (; at < bytes.size(); ++at) {
    hash = hash_combine(hash, static_cast<unsigned char>(bytes[at]));
  }
  for (const std::uint64_t lane : lanes) {
    hash = hash_combine(hash, lane);
  }
  return hash;
}

std::string digest_file(const std::string& path) {
  std::ifstream file = open_for_reading(path);
  Digest digest;
  for (std::string bytes = read_bytes(file, kChunkBytes); !bytes.empty(); bytes = read_bytes(file, kChunkBytes)) {
    digest.add(std::to_string(hash_chunk(bytes)) + ";");
  }
  if (file.bad()) {
    throw Error(ErrorKind::input, path, "reading failed");
  }
  return digest.hex();
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  if (c >= 'a' && c <= 'f') {
    return c - 'a' + 10;
  }
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// RFC 3986, section 2.1.
std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_value(uri[i + 1]) >= 0 && hex_value(uri[i + 2]) >= 0) {
      text += static_cast<char>(hex_value(uri[i + 1]) * 16 + hex_value(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

// The JSON of a .gltf, or of a .glb's first chunk (glTF 2.0, section 4.4). What is broken here is left to the reader
// of scenes, whose messages are better: the result is then empty.
std::string json_text(const std::string& path) {
  std::ifstream file = open_for_reading(path);
  std::string head = read_bytes(file, 20);
  if (head.size() == 20 && head.starts_with("glTF")) {
    std::uint32_t length = 0;
    std::memcpy(&length, head.data() + 12, sizeof(length));
    std::error_code ignored;
    const auto size = fs::file_size(path, ignored);
    return ignored || length > size ? std::string() : read_bytes(file, length);
  }
  std::string rest((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return head + rest;
}

}  // namespace

std::vector<std::string> scene_files(const std::string& path) {
  std::vector<std::string> files{path};
  const auto json = nlohmann::json::parse(json_text(path), nullptr, false);
  if (!json.is_object()) {
    return files;
  }
  for (const char* kind : {"buffers", "images"}) {
    const auto list = json.find(kind);
    if (list == json.end() || !list->is_array()) {
      continue;
    }
    for (const auto& item : *list) {
      const auto uri = item.is_object() ? item.find("uri") : item.end();
      if (!item.is_object() || uri == item.end() || !uri->is_string()) {
        continue;
      }
      const auto text = uri->get<std::string>();
      if (text.starts_with("data:")) {
        continue;
      }
      const std::string file = (fs::path(path).parent_path() / percent_decoded(text)).string();
      // A missing image is the scene reader's business: it may go on with a warning.
      if (fs::is_regular_file(file) && std::find(files.begin(), files.end(), file) == files.end()) {
        files.push_back(file);
      }
    }
  }
  return files;
}

std::map<std::string, std::string> digest_files(const std::vector<std::string>& paths, int threads) {
  std::vector<std::string> digests(paths.size());
  parallel_for(paths.size(), threads, [&](std::size_t i) { digests[i] = digest_file(paths[i]); });
  std::map<std::string, std::string> result;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    result[paths[i]] = digests[i];
  }
  return result;
}

}  // namespace gazetrace
