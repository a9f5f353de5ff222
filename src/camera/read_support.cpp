// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "camera/path_format.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

__extension__ using Int128 = __int128;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Removes the digits at the front of `text` and returns them without leading zeros.
std::string_view take_number(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

}  // namespace

std::optional<std::int64_t> mid_frame_ns(std::int64_t frame, const FrameRate& fps, std::int64_t start_ns) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max() / 1'000'000'000;
  if (fps.numerator <= 0 || fps.denominator <= 0 || fps.denominator > kMost) {
    return std::nullopt;
  }
  // floor((2 k - 1) 10^9 den / (2 num)), which fits 128 bits: |2 k - 1| < 2^64 and 10^9 den < 2^63.
  const Int128 numerator = (Int128{2} * frame - 1) * (1'000'000'000 * fps.denominator);
  const Int128 divisor = Int128{2} * fps.numerator;
  const Int128 quotient = numerator / divisor;
  const Int128 t = start_ns + (numerator % divisor < 0 ? quotient - 1 : quotient);
  if (t > std::numeric_limits<std::int64_t>::max() || t < std::numeric_limits<std::int64_t>::min()) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>(t);
}

double number_at(std::string_view text, const std::string& place, std::string_view form) {
  const auto value = number_from(text);
  if (!value) {
    throw Error(ErrorKind::input, place, fmt::format("'{}' is not a finite number", text.substr(0, 40)), form);
  }
  return *value;
}

std::int64_t time_at(std::string_view text, int exponent, const std::string& place, std::string_view form) {
  std::int64_t t_ns = 0;
  const NumberStatus status = scaled_integer(text, exponent, t_ns);
  if (status != NumberStatus::ok) {
    throw Error(ErrorKind::input, place,
                fmt::format("time '{}' {}", text.substr(0, 40),
                            status == NumberStatus::overflow ? "does not fit int64 nanoseconds" : "is not a number"),
                form);
  }
  return t_ns;
}

std::int64_t frame_time_at(std::int64_t number, std::int64_t first, const CameraReadOptions& options,
                           const std::string& place) {
  std::int64_t frame = 0;
  const bool lost = __builtin_sub_overflow(number, options.keep_time ? options.first_frame : first, &frame) ||
                    __builtin_add_overflow(frame, std::int64_t{1}, &frame);
  const auto t_ns = lost ? std::nullopt : mid_frame_ns(frame, options.fps, 0);
  if (!t_ns) {
    throw Error(ErrorKind::input, place,
                fmt::format("frame {} at {}/{} a second lies beyond int64 nanoseconds", number, options.fps.numerator,
                            options.fps.denominator),
                "check the frame's number and `camera-fps`");
  }
  return *t_ns;
}

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view x = take_number(a);
      const std::string_view y = take_number(b);
      if (x.size() != y.size()) {
        return x.size() < y.size();
      }
      if (x != y) {
        return x < y;
      }
    } else if (a.front() != b.front()) {
      return a.front() < b.front();
    } else {
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.empty() == b.empty() ? whole_a < whole_b : a.empty();
}

std::optional<double> one_field_of_view(const std::vector<double>& yfovs_rad, const std::string& path,
                                        Warnings& warnings) {
  if (yfovs_rad.empty()) {
    return std::nullopt;
  }
  const auto [least, most] = std::minmax_element(yfovs_rad.begin(), yfovs_rad.end());
  // Extreme ratios of size to focal length round to 0 or 180 degrees.
  if (!(*least > 0 && *most < kPi)) {
    throw Error(ErrorKind::input, path,
                fmt::format("its picture sizes and focal lengths give a vertical field of view of {} degrees",
                            (*least > 0 ? *most : *least) * kDegPerRad),
                "correct them, or take them out and give `yfov`");
  }
  if ((*most - *least) * kDegPerRad > 1e-3) {
    warnings.push_back(
        fmt::format("{}: the vertical field of view changes from {:.4g} to {:.4g} degrees along the path; {:.4g}, the "
                    "first, is used",
                    path, *least * kDegPerRad, *most * kDegPerRad, yfovs_rad.front() * kDegPerRad));
  }
  return yfovs_rad.front();
}

}  // namespace gazetrace
