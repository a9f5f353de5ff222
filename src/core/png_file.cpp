// SPDX-License-Identifier: Apache-2.0
#include "core/png_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
constexpr std::uint32_t kMaxLength = 0x7FFFFFFF;  // of a chunk
constexpr std::uint32_t kMaxPngSidePx = 1000000;  // libpng's limit, unless it is told otherwise
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
    if (width == 0 || height == 0 || width > kMaxPngSidePx || height > kMaxPngSidePx) {
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

// The rows of a picture in the order in which they are stored, each with a byte for its filter before it. ISO/IEC
// 15948, sections 7.2 and 8.2 (seven passes over an interlaced picture).
class RowCheck {
 public:
  explicit RowCheck(Bytes header) : width_(big_endian_u32(header)), height_(big_endian_u32(header.subspan(4))) {
    constexpr std::array<unsigned, 7> kChannels{1, 0, 3, 1, 2, 0, 4};
    bits_ = std::uint64_t{header[8]} * kChannels.at(header[9]);
    passes_ = header[12] == 0 ? std::span(&kWhole, 1) : std::span<const Pass>(kAdam7);
    begin_pass();
  }
  [[nodiscard]] bool is_complete() const { return passes_.empty(); }

  // False where a row has a filter that does not exist. Bytes beyond the last row are counted.
  bool take(Bytes bytes) {
    while (!bytes.empty() && !is_complete()) {
      if (left_in_row_ == row_bytes_ && bytes.front() > kLastFilter) {
        return false;
      }
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_in_row_, bytes.size()));
      bytes = bytes.subspan(count);
      left_in_row_ -= count;
      if (left_in_row_ == 0) {
        left_in_row_ = row_bytes_;
        if (--rows_ == 0) {
          passes_ = passes_.subspan(1);
          begin_pass();
        }
      }
    }
    beyond_ += bytes.size();
    return true;
  }
  [[nodiscard]] std::uint64_t beyond() const { return beyond_; }

 private:
  struct Pass {
    std::uint32_t x, y, step_x, step_y;
  };
  static constexpr Pass kWhole{0, 0, 1, 1};
  static constexpr std::array<Pass, 7> kAdam7{
      {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}}};
  static constexpr std::uint8_t kLastFilter = 4;

  // Passes without pixels have no rows.
  void begin_pass() {
    for (; !passes_.empty(); passes_ = passes_.subspan(1)) {
      const Pass& pass = passes_.front();
      if (width_ > pass.x && height_ > pass.y) {
        const std::uint64_t columns = (width_ - pass.x + pass.step_x - 1) / pass.step_x;
        rows_ = (height_ - pass.y + pass.step_y - 1) / pass.step_y;
        row_bytes_ = left_in_row_ = 1 + (columns * bits_ + 7) / 8;
        return;
      }
    }
  }

  std::uint32_t width_, height_;
  std::uint64_t bits_ = 0;  // of a pixel
  std::span<const Pass> passes_;
  std::uint64_t rows_ = 0, row_bytes_ = 0, left_in_row_ = 0, beyond_ = 0;
};

struct Inflater {
  Inflater() { ready = inflateInit(&stream) == Z_OK; }
  ~Inflater() { inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  z_stream stream{};
  bool ready = false;
};

// Calls take(type, data) for each chunk until it returns false; whether the end of the file came in order.
template <class Take>
bool each_chunk(Bytes rest, const Take& take) {
  while (rest.size() >= 12) {
    const std::uint32_t length = big_endian_u32(rest);
    if (length > rest.size() - 12) {
      return false;
    }
    const std::string_view type(reinterpret_cast<const char*>(&rest[4]), 4);
    if (type == "IEND" || !take(type, rest.subspan(8, length))) {
      return true;
    }
    rest = rest.subspan(length + std::size_t{12});
  }
  return false;
}

}  // namespace

bool is_png(Bytes file_bytes) {
  return file_bytes.size() >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), file_bytes.begin());
}

std::vector<std::uint8_t> essential_png(Bytes file_bytes, const std::string& place) {
  return PngCheck(file_bytes, place).essential();
}

void check_png_pixels(Bytes essential, const std::string& place) {
  constexpr std::uint64_t kMostBeyond = 65536;  // some writers leave a little
  const auto fail = [&](const std::string& problem) {
    throw Error(ErrorKind::input, place, "the picture is damaged: " + problem, "export it again");
  };
  Inflater inflater;
  if (!inflater.ready) {
    throw Error(ErrorKind::runtime, place, "there is no memory to unpack the picture");
  }
  RowCheck rows(essential.subspan(kSignature.size() + 8, 13));
  std::array<std::uint8_t, 32768> buffer{};
  int status = Z_OK;
  each_chunk(essential.subspan(kSignature.size()), [&](std::string_view type, Bytes data) {
    if (type != "IDAT") {
      return true;
    }
    z_stream& stream = inflater.stream;
    stream.next_in = const_cast<std::uint8_t*>(data.data());  // zlib only reads through it
    stream.avail_in = static_cast<uInt>(data.size());
    do {
      stream.next_out = buffer.data();
      stream.avail_out = static_cast<uInt>(buffer.size());
      status = inflate(&stream, Z_NO_FLUSH);
      if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
        fail(std::string("its pixels cannot be unpacked: ") + (stream.msg == nullptr ? "no reason known" : stream.msg));
      }
      if (!rows.take(Bytes(buffer).first(buffer.size() - stream.avail_out))) {
        fail("a row has a filter that does not exist");
      }
      if (rows.beyond() > kMostBeyond) {
        fail("it holds more data than its pixels");
      }
    } while (status == Z_OK && (stream.avail_in > 0 || stream.avail_out == 0));
    return status != Z_STREAM_END;
  });
  if (!rows.is_complete()) {
    fail("its pixels end early");
  }
  if (status != Z_STREAM_END) {
    fail("the packed stream of its pixels does not end");
  }
}

std::optional<std::string> png_description(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes(kSignature.size());
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())) || !is_png(bytes)) {
    return std::nullopt;
  }
  bytes.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  std::string title;
  std::string description;
  const bool complete = each_chunk(bytes, [&](std::string_view type, Bytes data) {
    const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
    const std::size_t end = text.find('\0');
    if (type == "tEXt" && end != std::string_view::npos) {
      if (text.substr(0, end) == "Title") {
        title = text.substr(end + 1);
      } else if (text.substr(0, end) == "Description") {
        description = text.substr(end + 1);
      }
    }
    return true;
  });
  return !complete ? std::string() : !title.empty() ? title : description;
}

}  // namespace gazetrace
