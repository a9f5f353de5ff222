// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/draco_claims.hpp"

#include <algorithm>
#include <array>

namespace gazetrace {
namespace {

constexpr std::array<std::uint8_t, 5> kMagic{'D', 'R', 'A', 'C', 'O'};
constexpr int kMesh = 1, kSequential = 0, kEdgebreaker = 1;
constexpr std::uint32_t kHasMetadata = 0x8000;
constexpr int kMostNested = 16;

// Reads forward; once it has met the end, it gives zeros and is not good() any more.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  [[nodiscard]] bool good() const { return good_; }
  void skip(std::uint64_t count) {
    good_ = good_ && count <= bytes_.size();
    bytes_ = good_ ? bytes_.subspan(static_cast<std::size_t>(count)) : std::span<const std::uint8_t>();
  }
  std::uint32_t little_endian(std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size && i < bytes_.size(); ++i) {
      value |= static_cast<std::uint32_t>(bytes_[i]) << 8U * i;
    }
    skip(size);
    return good_ ? value : 0;
  }
  // Seven bits in a byte, the lowest first.
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35 && good_; shift += 7) {
      const std::uint32_t byte = little_endian(1);
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) {
        return value;
      }
    }
    good_ = false;
    return 0;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  bool good_ = true;
};

void skip_metadata(Reader& reader, int nested) {
  const std::uint64_t entries = reader.varint();
  for (std::uint64_t i = 0; i < entries && reader.good(); ++i) {
    reader.skip(reader.little_endian(1));  // the name
    reader.skip(reader.varint());
  }
  const std::uint64_t inner = reader.varint();
  for (std::uint64_t i = 0; i < inner && reader.good(); ++i) {
    reader.skip(reader.little_endian(1));
    if (nested == kMostNested) {
      reader.skip(~std::uint64_t{0});
      return;
    }
    skip_metadata(reader, nested + 1);
  }
}

void skip_geometry_metadata(Reader& reader) {
  const std::uint64_t attributes = reader.varint();
  for (std::uint64_t i = 0; i < attributes && reader.good(); ++i) {
    reader.varint();  // the attribute
    skip_metadata(reader, 0);
  }
  skip_metadata(reader, 0);
}

}  // namespace

std::optional<DracoClaims> draco_claims(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    return std::nullopt;
  }
  Reader reader(bytes.subspan(kMagic.size()));
  const std::uint32_t major = reader.little_endian(1);
  const std::uint32_t version = major * 256 + reader.little_endian(1);
  constexpr std::uint32_t k2_0 = 0x200, k2_2 = 0x202, kFirstWithMetadata = 0x103;
  const auto type = static_cast<int>(reader.little_endian(1));
  const auto method = static_cast<int>(reader.little_endian(1));
  const std::uint32_t flags = reader.little_endian(2);
  if (type != kMesh || (method != kSequential && method != kEdgebreaker)) {
    return std::nullopt;
  }
  if (version >= kFirstWithMetadata && (flags & kHasMetadata) != 0) {
    skip_geometry_metadata(reader);
  }
  DracoClaims claims;
  if (method == kSequential) {
    const auto count = [&] { return version < k2_2 ? reader.little_endian(4) : reader.varint(); };
    claims.faces = count();
    claims.vertices = count();
  } else {
    const auto count = [&] { return version < k2_0 ? reader.little_endian(4) : reader.varint(); };
    reader.skip(1);  // how the symbols are coded
    if (version < k2_2) {
      claims.vertices = count();  // those that are added at splits
    }
    claims.vertices += count();
    claims.faces = count();
  }
  return reader.good() ? std::optional(claims) : std::nullopt;
}

}  // namespace gazetrace
