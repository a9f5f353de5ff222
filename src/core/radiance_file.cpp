// SPDX-License-Identifier: Apache-2.0
#include "core/radiance_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Rgbe = std::array<std::uint8_t, 4>;

// Radiance's own, which a header need not state: they count as Rec.709's, since they are what its pictures are seen in.
constexpr std::array<double, 8> kOwnPrimaries{0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 1 / 3.0, 1 / 3.0};

constexpr std::string_view kCut = "its pixels end early, or a run is longer than its line";

class RadianceReader final : public PictureReader {
 public:
  RadianceReader(Bytes bytes, const std::string& place) : rest_(bytes), place_(place) {
    read_header();
    read_size();
    format = "hdr";
    channels = 3;
    facts.is_deep = facts.is_linear = true;
    decoded_bytes =
        std::uint64_t{4} * static_cast<std::uint64_t>(facts.width_px) * static_cast<std::uint64_t>(facts.height_px);
    check_claim();
    for (std::size_t e = 0; e < steps_.size(); ++e) {
      steps_[e] = static_cast<float>(std::ldexp(1.0, static_cast<int>(e) - 136) / exposure_);
    }
  }

  std::string read(int /*count*/, std::span<std::uint8_t> /*values*/) override { return "its values are floats"; }

  // Scanlines are rows or columns, from either end.
  std::string read(int count, std::span<float> values) override {
    const auto step = static_cast<std::size_t>(count);
    std::vector<Rgbe> line(static_cast<std::size_t>(length()));
    Bytes rest = rest_;
    for (int s = 0; s < lines(); ++s) {
      if (!read_line(rest, line)) {
        return std::string(kCut);
      }
      for (int i = 0; i < length(); ++i) {
        int x = by_columns_ ? s : i;
        int y = by_columns_ ? i : s;
        x = from_right_ ? facts.width_px - 1 - x : x;
        y = from_bottom_ ? facts.height_px - 1 - y : y;
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(facts.width_px) + static_cast<std::size_t>(x);
        decode(line[static_cast<std::size_t>(i)], values.subspan(pixel * step, step));
      }
    }
    return {};
  }

 private:
  [[nodiscard]] int lines() const { return by_columns_ ? facts.width_px : facts.height_px; }
  [[nodiscard]] int length() const { return by_columns_ ? facts.height_px : facts.width_px; }

  // The lines of a picture that claims far more than its bytes hold are counted before there is room for its pixels.
  void check_claim() {
    constexpr std::uint64_t kUsual = 16;
    constexpr int kLongestPx = 1 << 20;
    if (decoded_bytes <= kUsual * rest_.size() || length() > kLongestPx) {
      return;
    }
    std::vector<Rgbe> line(static_cast<std::size_t>(length()));
    Bytes rest = rest_;
    for (int s = 0; s < lines(); ++s) {
      if (!read_line(rest, line)) {
        fail("the picture is damaged: " + std::string(kCut), "export it again");
      }
    }
  }

  [[noreturn]] void fail(const std::string& problem, const std::string& hint) const {
    throw Error(ErrorKind::input, place_, problem, hint);
  }
  [[noreturn]] void fail_for_header() const {
    fail("cannot be read: the header of the Radiance picture is damaged", "export it again");
  }

  std::string_view next_line() {
    constexpr std::size_t kLongest = 65536;
    const auto end =
        std::find(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(std::min(rest_.size(), kLongest)),
                  std::uint8_t{'\n'});
    if (end == rest_.end() || *end != '\n') {
      fail_for_header();
    }
    const auto length = static_cast<std::size_t>(end - rest_.begin());
    const std::string_view line(reinterpret_cast<const char*>(rest_.data()), length);
    rest_ = rest_.subspan(length + 1);
    return line.ends_with('\r') ? line.substr(0, length - 1) : line;
  }

  // Lines that begin with a blank are the headers of pictures that this one was made of.
  void read_header() {
    next_line();  // the kind, by which it was chosen
    for (std::string_view line = next_line(); !line.empty(); line = next_line()) {
      const std::size_t equals = line.find('=');
      if (line.front() == ' ' || line.front() == '\t' || line.front() == '#' || equals == std::string_view::npos) {
        continue;
      }
      const std::string_view value = trim(line.substr(equals + 1));
      if (line.starts_with("FORMAT=") && value != "32-bit_rle_rgbe") {
        fail("a Radiance picture of the kind '" + bounded(value, 40) + "'" +
                 (value == "32-bit_rle_xyze" ? " holds CIE XYZ without its white" : "") + "; 32-bit_rle_rgbe is read",
             "convert it, for example by Radiance's ra_xyze -r -u");
      }
      if (line.starts_with("EXPOSURE=")) {
        exposure_ *= numbers<1>(value)[0];
      } else if (line.starts_with("COLORCORR=")) {
        const std::array<double, 3> gains = numbers<3>(value);
        correction_ = {correction_.x * gains[0], correction_.y * gains[1], correction_.z * gains[2]};
      } else if (line.starts_with("PRIMARIES=")) {
        take_primaries(numbers<8>(value));
      }
    }
    const double least = std::min({exposure_, correction_.x, correction_.y, correction_.z});
    if (!(least > 0) || !std::isfinite(exposure_ * correction_.x * correction_.y * correction_.z)) {
      fail_for_header();
    }
  }

  template <std::size_t N>
  std::array<double, N> numbers(std::string_view text) const {
    std::vector<std::string_view> cells;
    split_cells(text, ' ', cells);
    std::array<double, N> values{};
    for (std::size_t i = 0; i < N; ++i) {
      const std::optional<double> number = i < cells.size() ? number_from(cells[i]) : std::nullopt;
      if (!number) {
        fail_for_header();
      }
      values.at(i) = *number;
    }
    return values;
  }

  void take_primaries(const std::array<double, 8>& v) {
    constexpr double kSame = 1e-3;
    if (!std::equal(v.begin(), v.end(), kOwnPrimaries.begin(),
                    [](double a, double b) { return std::fabs(a - b) < kSame; })) {
      facts.primaries = Primaries{{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}};
    }
  }

  // "-Y 512 +X 1024": the first axis counts scanlines; - on Y is from the top, as a picture is read.
  void read_size() {
    std::vector<std::string_view> cells;
    split_cells(next_line(), ' ', cells);
    if (cells.size() != 4 || cells[0].size() != 2 || cells[2].size() != 2) {
      fail_for_header();
    }
    by_columns_ = cells[0][1] == 'X';
    const std::string_view x = cells[by_columns_ ? 0 : 2];
    const std::string_view y = cells[by_columns_ ? 2 : 0];
    const std::optional<double> width = number_from(cells[by_columns_ ? 1 : 3]);
    const std::optional<double> height = number_from(cells[by_columns_ ? 3 : 1]);
    const bool is_right = x[1] == 'X' && y[1] == 'Y' && (x[0] == '+' || x[0] == '-') && (y[0] == '+' || y[0] == '-');
    constexpr double kMost = 1e9;
    if (!is_right || !width || !height || !(*width >= 1 && *width < kMost && *height >= 1 && *height < kMost)) {
      fail_for_header();
    }
    from_right_ = x[0] == '-';
    from_bottom_ = y[0] == '+';
    facts.width_px = static_cast<int>(*width);
    facts.height_px = static_cast<int>(*height);
  }

  // False where the bytes end or a run is too long.
  static bool read_line(Bytes& rest, std::vector<Rgbe>& line) {
    constexpr std::size_t kShortest = 8;
    constexpr std::size_t kLongest = 32767;
    const std::size_t n = line.size();
    const bool is_new = n >= kShortest && n <= kLongest && rest.size() >= 4 && rest[0] == 2 && rest[1] == 2 &&
                        (std::size_t{rest[2]} << 8U | rest[3]) == n;
    return is_new ? read_runs(rest, line) : read_pixels(rest, line);
  }

  // Each of the four components of a scanline by itself: runs, and bytes as they are.
  static bool read_runs(Bytes& rest, std::vector<Rgbe>& line) {
    rest = rest.subspan(4);
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t i = 0; i < line.size();) {
        if (rest.size() < 2) {
          return false;
        }
        const bool is_run = rest[0] > 128;
        const std::size_t count = is_run ? rest[0] - 128U : rest[0];
        const std::size_t bytes = is_run ? 1 : count;
        if (count == 0 || count > line.size() - i || bytes > rest.size() - 1) {
          return false;
        }
        for (std::size_t k = 0; k < count; ++k) {
          line[i + k][c] = rest[is_run ? 1 : 1 + k];
        }
        i += count;
        rest = rest.subspan(1 + bytes);
      }
    }
    return true;
  }

  // Pixels as they are. One with mantissas of 1 is no color but says how often the pixel before it is repeated: digits
  // to the base of 256 where several follow each other.
  static bool read_pixels(Bytes& rest, std::vector<Rgbe>& line) {
    unsigned shift = 0;
    for (std::size_t i = 0; i < line.size();) {
      if (rest.size() < 4) {
        return false;
      }
      const Rgbe pixel{rest[0], rest[1], rest[2], rest[3]};
      rest = rest.subspan(4);
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        line[i++] = pixel;
        shift = 0;
        continue;
      }
      const std::uint64_t count = shift < 32 ? std::uint64_t{pixel[3]} << shift : line.size() + 1;
      if (i == 0 || count > line.size() - i) {
        return false;
      }
      std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(i), count, line[i - 1]);
      i += count;
      shift += 8;
    }
    return true;
  }

  // As OpenImageIO and Blender, and other than Radiance itself, nothing is added for mantissas that were rounded down.
  void decode(const Rgbe& pixel, std::span<float> values) const {
    const float step = pixel[3] == 0 ? 0.0F : steps_.at(pixel[3]);
    const std::array<double, 3> gains{correction_.x, correction_.y, correction_.z};
    for (std::size_t c = 0; c < values.size(); ++c) {
      values[c] = static_cast<float>(pixel.at(c)) * step / static_cast<float>(gains.at(c));
    }
  }

  Bytes rest_;
  std::string place_;
  bool by_columns_ = false, from_right_ = false, from_bottom_ = false;
  double exposure_ = 1;  // what the numbers are larger by than the light
  Vec3d correction_{1, 1, 1};
  std::array<float, 256> steps_{};
};

}  // namespace

std::unique_ptr<PictureReader> open_radiance(Bytes bytes, const std::string& place) {
  return std::make_unique<RadianceReader>(bytes, place);
}

}  // namespace gazetrace
