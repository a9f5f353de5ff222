// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sealed_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ios>
#include <system_error>
#include <utility>

#include "core/hash.hpp"
#include "gazetrace/error.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kDigestLength = 32;
constexpr std::uint32_t kByteOrder = 0x01020304;

std::string beginning_of(const SealedKind& kind) {
  return std::string(kind.title) + ", ";
}

std::string digest_of(const char* begin, std::size_t size) {
  Digest digest;
  digest.add({begin, size});
  return digest.hex();
}

std::string read_all(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);  // fails for folders, which a stream opens
  if (!file || code) {
    throw Error(ErrorKind::input, path, "cannot be opened", "check the path");
  }
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be read", "check the path");
  }
  return bytes;
}

}  // namespace

SealedWriter::SealedWriter(const SealedKind& kind, const std::string& digest) {
  const std::string line = beginning_of(kind) + digest + "\n";
  add(line.data(), line.size());
  (*this)(kByteOrder);
}

void SealedWriter::add(const void* from, std::size_t size) {
  const auto* bytes = static_cast<const std::byte*>(from);
  bytes_.insert(bytes_.end(), bytes, bytes + size);
}

WrittenFile SealedWriter::save(const std::string& path) {
  const std::string seal = digest_of(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  add(seal.data(), seal.size());
  return write_frame_file(path, 0, bytes_);
}

SealedReader::SealedReader(const SealedKind& kind, std::string path, const std::string& digest)
    : kind_(kind), path_(std::move(path)), bytes_(read_all(path_)) {
  const std::string beginning = beginning_of(kind);
  const std::size_t line = bytes_.find('\n');
  if (!bytes_.starts_with(beginning) || line == std::string::npos) {
    throw Error(ErrorKind::input, path_, std::string("is no ") + kind.name + " of this version of gazetrace",
                kind.wanted);
  }
  at_ = line + 1;
  end_ = bytes_.size() - std::min(kDigestLength, bytes_.size() - at_);
  if (bytes_.size() < at_ + kDigestLength || digest_of(bytes_.data(), end_) != bytes_.substr(end_)) {
    fail();
  }
  if (bytes_.substr(beginning.size(), line - beginning.size()) != digest) {
    throw Error(ErrorKind::input, path_, "was made under other settings or from other files", kind.when_other_settings);
  }
  std::uint32_t order = 0;
  (*this)(order);
  if (order != kByteOrder) {
    fail();
  }
}

void SealedReader::take(void* to, std::size_t size) {
  if (size > left()) {
    fail();
  }
  if (size > 0) {
    std::memcpy(to, bytes_.data() + at_, size);
  }
  at_ += size;
}

void SealedReader::finish() const {
  if (left() != 0) {
    fail();
  }
}

void SealedReader::fail() const {
  throw Error(ErrorKind::input, path_, std::string("the ") + kind_.name + " is damaged", kind_.when_damaged);
}

std::string read_sealed_digest(const SealedKind& kind, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  const std::string beginning = beginning_of(kind);
  if (!std::getline(file, line) || file.eof() || !line.starts_with(beginning)) {  // eof: cut within the line
    return {};
  }
  return line.substr(beginning.size());
}

bool is_sealed(const std::string& path) {
  const std::string bytes = read_all(path);
  const std::size_t end = bytes.size() - std::min(kDigestLength, bytes.size());
  return digest_of(bytes.data(), end) == bytes.substr(end);
}

}  // namespace gazetrace
