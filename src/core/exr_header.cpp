// SPDX-License-Identifier: Apache-2.0
// The layout of OpenEXR files ("OpenEXR File Layout", openexr.com): magic number, version, then for each part a list of
// attributes, which are name, type, size and value, ended by an empty name; of several parts an empty list ends all.
#include "core/exr_header.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kMultiPart = 0x1000;
constexpr std::int64_t kMostSidePx = 65536;
constexpr std::uint32_t kMostTilePx = 8192;
constexpr std::size_t kMostName = 255;
constexpr int kMostParts = 64;

// Bytes one after another, of memory or of a file.
class Source {
 public:
  explicit Source(std::span<const std::uint8_t> bytes) : bytes_(bytes), size_(bytes.size()) {}
  Source(std::ifstream& file, std::uint64_t size) : file_(&file), size_(size) {}

  [[nodiscard]] std::uint64_t left() const { return size_ - at_; }
  bool take(void* to, std::size_t count) {
    if (count > left()) {
      return false;
    }
    if (file_ == nullptr) {
      std::memcpy(to, bytes_.data() + at_, count);
    } else if (!file_->read(static_cast<char*>(to), static_cast<std::streamsize>(count))) {
      return false;
    }
    at_ += count;
    return true;
  }
  bool skip(std::uint64_t count) {
    if (count > left()) {
      return false;
    }
    at_ += count;
    return file_ == nullptr || static_cast<bool>(file_->seekg(static_cast<std::streamoff>(count), std::ios::cur));
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::ifstream* file_ = nullptr;
  std::uint64_t size_, at_ = 0;
};

// Types of attributes whose values have one size. OpenEXR reads that many bytes whatever the size that is stated, and
// takes what follows for the next attribute.
struct FixedType {
  std::string_view name;
  std::uint32_t bytes;
};
constexpr std::array<FixedType, 24> kFixedTypes{{{"box2i", 16},
                                                 {"box2f", 16},
                                                 {"chromaticities", 32},
                                                 {"compression", 1},
                                                 {"deepImageState", 1},
                                                 {"double", 8},
                                                 {"envmap", 1},
                                                 {"float", 4},
                                                 {"int", 4},
                                                 {"keycode", 28},
                                                 {"lineOrder", 1},
                                                 {"m33f", 36},
                                                 {"m33d", 72},
                                                 {"m44f", 64},
                                                 {"m44d", 128},
                                                 {"rational", 8},
                                                 {"tiledesc", 9},
                                                 {"timecode", 8},
                                                 {"v2i", 8},
                                                 {"v2f", 8},
                                                 {"v3i", 12},
                                                 {"v3f", 12},
                                                 {"v2d", 16},
                                                 {"v3d", 24}}};
constexpr std::uint32_t kChannelBytes = 16;  // of a list of channels, for each beside its name

class HeaderCheck {
 public:
  HeaderCheck(Source source, const std::string& place) : source_(source), place_(place) {}

  void run() {
    std::array<std::uint32_t, 2> start{};  // magic number and version
    if (!source_.take(start.data(), sizeof start) || start[0] != kMagic) {
      return;
    }
    const bool several = (start[1] & kMultiPart) != 0;
    for (int part = 0;; ++part) {
      if (part > kMostParts) {
        fail("it has more than " + std::to_string(kMostParts) + " parts");
      }
      if (attributes() == 0 || !several) {
        return;
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(ErrorKind::input, place_, "the EXR cannot be used: " + problem, "export it again");
  }

  std::string name() {
    std::string text;
    for (char c = 0; text.size() <= kMostName; text += c) {
      if (!source_.take(&c, 1)) {
        fail("its header is cut");
      }
      if (c == 0) {
        return text;
      }
    }
    fail("its header has a name of more than " + std::to_string(kMostName) + " letters");
  }

  std::size_t attributes() {
    for (std::size_t count = 0;; ++count) {
      const std::string attribute = name();
      if (attribute.empty()) {
        return count;
      }
      const std::string type = name();
      std::int32_t size = 0;
      if (!source_.take(&size, sizeof size)) {
        fail("its header is cut");
      }
      if (size < 0 || static_cast<std::uint64_t>(size) > source_.left()) {
        fail("its attribute '" + bounded(attribute, 40) + "' states " + std::to_string(size) + " bytes, of " +
             std::to_string(source_.left()) + " that are left");
      }
      const auto* const fixed = std::find_if(kFixedTypes.begin(), kFixedTypes.end(),
                                             [&](const FixedType& known) { return known.name == type; });
      if (fixed != kFixedTypes.end() && static_cast<std::uint32_t>(size) != fixed->bytes) {
        fail_for_size(attribute, size);
      }
      if (type == "floatvector" && size % 4 != 0) {
        fail_for_size(attribute, size);
      }
      const std::uint64_t left = source_.left() - static_cast<std::uint64_t>(size);
      value(type, static_cast<std::uint32_t>(size));
      if (source_.left() != left) {
        fail_for_size(attribute, size);
      }
    }
  }

  [[noreturn]] void fail_for_size(const std::string& attribute, std::int32_t size) const {
    fail("its attribute '" + bounded(attribute, 40) + "' states " + std::to_string(size) +
         " bytes, and a value of its type has others");
  }

  // Each with a name, which an empty one ends.
  void channels() {
    while (!name().empty()) {
      if (!source_.skip(kChannelBytes)) {
        fail("its header is cut");
      }
    }
  }

  // Texts, each behind its length, as many as there is room for.
  void texts(std::uint32_t size) {
    const std::uint64_t end = source_.left() - size;
    while (source_.left() > end) {
      std::uint32_t length = 0;
      if (!source_.take(&length, sizeof length) || length > source_.left() || source_.left() - length < end) {
        fail("a text in its header is longer than its attribute");
      }
      source_.skip(length);
    }
  }

  void value(std::string_view type, std::uint32_t size) {
    std::array<std::int32_t, 4> box{};    // of windows
    std::array<std::uint32_t, 2> tile{};  // followed by a byte, the mode
    if (type == "box2i" && size == sizeof box) {
      source_.take(box.data(), sizeof box);
      const std::int64_t width = std::int64_t{box[2]} - box[0] + 1;
      const std::int64_t height = std::int64_t{box[3]} - box[1] + 1;
      if (width < 1 || height < 1 || width > kMostSidePx || height > kMostSidePx) {
        fail("a window of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
      }
    } else if (type == "tiledesc" && size == sizeof tile + 1) {
      source_.take(tile.data(), sizeof tile);
      source_.skip(1);
      if (std::min(tile[0], tile[1]) < 1 || std::max(tile[0], tile[1]) > kMostTilePx) {
        fail("tiles of " + std::to_string(tile[0]) + " x " + std::to_string(tile[1]) + " pixels");
      }
    } else if (type == "chlist") {
      channels();
    } else if (type == "stringvector") {
      texts(size);
    } else if (std::array<std::uint32_t, 2> preview{};
               type == "preview" && source_.take(preview.data(), sizeof preview)) {
      source_.skip(std::uint64_t{4} * preview[0] * preview[1]);  // fails, or is found to be another size
    } else {
      source_.skip(size);
    }
  }

  Source source_;
  const std::string& place_;
};

}  // namespace

void check_exr_header(std::span<const std::uint8_t> file_bytes, const std::string& place) {
  HeaderCheck(Source(file_bytes), place).run();
}

void check_exr_header(const std::string& path, const std::string& place) {
  std::error_code unknown;
  const std::uint64_t bytes = std::filesystem::file_size(path, unknown);
  std::ifstream file(path, std::ios::binary);
  if (file && !unknown) {
    HeaderCheck(Source(file, bytes), place).run();
  }
}

}  // namespace gazetrace
