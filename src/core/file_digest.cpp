// SPDX-License-Identifier: Apache-2.0
#include "core/file_digest.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "core/hash.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{8} << 20U;

// Takes eight bytes a step: scenes are hundreds of megabytes, and every run begins with this.
std::uint64_t hash_chunk(std::span<const std::byte> bytes) {
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
    hash = hash_combine(hash, std::to_integer<std::uint64_t>(bytes[at]));
  }
  for (const std::uint64_t lane : lanes) {
    hash = hash_combine(hash, lane);
  }
  return hash;
}

void add_chunk(Digest& digest, std::span<const std::byte> bytes) {
  digest.add(std::to_string(hash_chunk(bytes)) + ";");
}

}  // namespace

std::string digest_bytes(std::span<const std::byte> bytes) {
  Digest digest;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(kChunkBytes, bytes.size()))) {
    add_chunk(digest, bytes.first(std::min(kChunkBytes, bytes.size())));
  }
  return digest.hex();
}

std::ifstream open_for_reading(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
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

std::string digest_file(const std::string& path) {
  std::ifstream file = open_for_reading(path);
  Digest digest;
  std::vector<std::byte> bytes(kChunkBytes);
  while (file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())) ||
         file.gcount() > 0) {
    add_chunk(digest, std::span(bytes).first(static_cast<std::size_t>(file.gcount())));
  }
  if (file.bad()) {
    throw Error(ErrorKind::input, path, "reading failed");
  }
  return digest.hex();
}

}  // namespace gazetrace
