// SPDX-License-Identifier: Apache-2.0
#include "core/png_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
constexpr std::uint32_t kMaxLength = 0x7FFFFFFF;  // of a chunk
constexpr std::uint32_t kMaxSidePx = 1000000;     // libpng's limit, unless it is told otherwise
constexpr std::uint8_t kPalette = 3;

// `bytes` are those of a chunk, so their number fits zlib's integer.
std::uint32_t crc_of(Bytes bytes) {
  return static_cast<std::uint32_t>(::crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

std::uint32_t big_endian_u32(Bytes p) {
  return static_cast<std::uint32_t>(p[0]) << 24U | static_cast<std::uint32_t>(p[1]) << 16U |
         static_cast<std::uint32_t>(p[2]) << 8U | static_cast<std::uint32_t>(p[3]);
}

struct Chunk {
  std::string_view type;
  Bytes data;
  Bytes whole;  // including length, type and checksum
};

class PngCheck {
 public:
  PngCheck(Bytes file, const std::string& place) : rest_(file.subspan(kSignature.size())), place_(place) {}

  std::vector<std::uint8_t> essential() {
    std::vector<std::uint8_t> png(kSignature.begin(), kSignature.end());
    const auto keep = [&](const Chunk& chunk) { png.insert(png.end(), chunk.whole.begin(), chunk.whole.end()); };
    const Chunk header = next();
    check_header(header);
    keep(header);
    bool palette = false;
    bool transparency = false;
    bool pixels = false;
    bool after_pixels = false;
    for (Chunk chunk = next();; chunk = next()) {
      after_pixels = after_pixels || (pixels && chunk.type != "IDAT");
      if (chunk.type == "IEND") {
        if (!pixels) {
          fail("it has no IDAT chunk");
        }
        keep(chunk);
        return png;
      }
      if (chunk.type == "IDAT") {
        if (after_pixels) {
          fail("its IDAT chunks are not consecutive");
        }
        if (color_ == kPalette && !palette) {
          fail("it has no palette");
        }
        pixels = true;
        keep(chunk);
      } else if (chunk.type == "PLTE") {
        if (color_ == kPalette) {  // otherwise it is only a suggestion for displays of few colours
          const std::size_t length = chunk.data.size();
          if (palette || pixels || length == 0 || length > 768 || length % 3 != 0) {
            fail("its palette is out of order or has a wrong length");
          }
          palette = true;
          palette_size_ = std::min(length / 3, std::size_t{1} << depth_);
          keep(chunk);
        }
      } else if (chunk.type == "tRNS") {
        if (color_ < 4) {  // the others have an alpha channel
          if (transparency || pixels || !is_transparency_length(chunk.data.size())) {
            fail("its tRNS chunk is out of order or has a wrong length");
          }
          transparency = true;
          keep(chunk);
        }
      } else if (is_critical(chunk.type)) {
        fail("it has a second header, or a chunk that is marked as essential but unknown to PNG");
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(ErrorKind::input, place_, "the picture is damaged: " + problem, "export it again");
  }

  static bool is_critical(std::string_view type) { return (static_cast<unsigned char>(type[0]) & 0x20U) == 0; }

  // The checksums of chunks that are left out are not checked.
  Chunk next() {
    if (rest_.size() < 12) {
      fail("the file ends before its IEND chunk");
    }
    const std::uint32_t length = big_endian_u32(rest_);
    if (length > kMaxLength || length > rest_.size() - 12) {
      fail("the file ends within a chunk of " + std::to_string(length) + " bytes");
    }
    Chunk chunk;
    chunk.whole = rest_.first(length + 12);
    chunk.data = chunk.whole.subspan(8, length);
    chunk.type = {reinterpret_cast<const char*>(&chunk.whole[4]), 4};
    const bool is_kept = is_critical(chunk.type) || chunk.type == "tRNS";
    if (is_kept && crc_of(chunk.whole.subspan(4, length + 4)) != big_endian_u32(chunk.whole.last(4))) {
      fail("the checksum of a chunk is wrong");
    }
    rest_ = rest_.subspan(chunk.whole.size());
    return chunk;
  }

  // ISO/IEC 15948 section 11.2.2 (IHDR).
  void check_header(const Chunk& chunk) {
    if (chunk.type != "IHDR" || chunk.data.size() != 13) {
      fail("it does not begin with a header");
    }
    const std::uint32_t width = big_endian_u32(chunk.data);
    const std::uint32_t height = big_endian_u32(chunk.data.subspan(4));
    if (width == 0 || height == 0 || width > kMaxSidePx || height > kMaxSidePx) {
      fail("its header says " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
    depth_ = chunk.data[8];
    color_ = chunk.data[9];
    const bool is_power = depth_ == 1 || depth_ == 2 || depth_ == 4 || depth_ == 8 || depth_ == 16;
    const bool is_allowed = color_ == 0                                 ? true
                            : color_ == kPalette                        ? depth_ <= 8
                            : color_ == 2 || color_ == 4 || color_ == 6 ? depth_ >= 8
                                                                        : false;
    if (!is_power || !is_allowed) {
      fail("its header says colour type " + std::to_string(color_) + " with " + std::to_string(depth_) + " bits");
    }
    if (chunk.data[10] != 0 || chunk.data[11] != 0 || chunk.data[12] > 1) {
      fail("its header names a compression, filter or order of rows that does not exist");
    }
  }

  [[nodiscard]] bool is_transparency_length(std::size_t length) const {
    return color_ == kPalette ? length > 0 && length <= palette_size_ : length == (color_ == 0 ? 2U : 6U);
  }

  Bytes rest_;
  const std::string& place_;
  std::uint8_t depth_ = 0, color_ = 0;
  std::size_t palette_size_ = 0;
};

}  // namespace

bool is_png(Bytes file_bytes) {
  return file_bytes.size() >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), file_bytes.begin());
}

std::vector<std::uint8_t> essential_png(Bytes file_bytes, const std::string& place) {
  return PngCheck(file_bytes, place).essential();
}

}  // namespace gazetrace
