// SPDX-License-Identifier: Apache-2.0
// Markers and segments: ITU-T T.81, annex B.
#include "core/jpeg_file.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t kApplication = 0xE0, kComment = 0xFE, kScan = 0xDA, kEnd = 0xD9;

bool is_alone(std::uint8_t marker) {
  return marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
}

// Kinds of segments that OpenImageIO makes something of that is used here; of each the first is kept.
struct Kind {
  std::uint8_t marker;
  std::string_view start;
};
constexpr std::array<Kind, 4> kKinds{
    {{kApplication, "JFIF"}, {kApplication + 1, "Exif"}, {kApplication + 14, "Adobe"}, {kComment, ""}}};

class JpegCopy {
 public:
  JpegCopy(Bytes bytes, const std::string& place) : bytes_(bytes), place_(place) { copy_.reserve(bytes.size()); }

  std::vector<std::uint8_t> run() {
    while (at_ < bytes_.size()) {
      if (bytes_[at_] != 0xFF) {  // of a scan, or damage
        const auto rest = bytes_.subspan(at_);
        add(static_cast<std::size_t>(std::find(rest.begin(), rest.end(), 0xFF) - rest.begin()));
        continue;
      }
      const std::uint8_t marker = at_ + 1 < bytes_.size() ? bytes_[at_ + 1] : kEnd;
      if (marker == 0xFF) {  // a fill byte
        ++at_;
      } else if (marker == 0 || is_alone(marker)) {
        add(2);
      } else if (marker == kEnd) {
        add(2);
        break;
      } else {
        segment(marker);
      }
    }
    return std::move(copy_);
  }

 private:
  void add(std::size_t count) {
    count = std::min(count, bytes_.size() - at_);
    copy_.insert(copy_.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
    at_ += count;
  }

  void segment(std::uint8_t marker) {
    const std::size_t left = bytes_.size() - at_ - 2;
    const std::size_t length = left < 2 ? 0 : std::size_t{bytes_[at_ + 2]} << 8U | bytes_[at_ + 3];
    if (length < 2 || length > left) {
      add(left + 2);
      return;
    }
    constexpr int kMostScans = 100;
    if (marker == kScan && ++scans_ > kMostScans) {
      throw Error(ErrorKind::input, place_,
                  "the picture is damaged: a JPEG has no use for more than " + std::to_string(kMostScans) + " scans",
                  "export it again");
    }
    if (is_needed(marker, bytes_.subspan(at_ + 4, length - 2))) {
      add(length + 2);
    } else {
      at_ += length + 2;
    }
  }

  bool is_needed(std::uint8_t marker, Bytes data) {
    if (marker != kComment && (marker < kApplication || marker > kApplication + 15)) {
      return true;
    }
    const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      if (kKinds.at(k).marker == marker && !text.empty() && text.starts_with(kKinds.at(k).start) && !seen_.at(k)) {
        seen_.at(k) = true;
        return true;
      }
    }
    return false;
  }

  Bytes bytes_;
  const std::string& place_;
  std::vector<std::uint8_t> copy_;
  std::size_t at_ = 0;
  int scans_ = 0;
  std::array<bool, kKinds.size()> seen_{};
};

}  // namespace

std::vector<std::uint8_t> essential_jpeg(Bytes file_bytes, const std::string& place) {
  return JpegCopy(file_bytes, place).run();
}

}  // namespace gazetrace
