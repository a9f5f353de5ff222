// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/option_values.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kFixations = "fixations";  // of `frames`

[[noreturn]] void reject(std::string_view text, const std::string& place, std::string_view wanted) {
  throw Error(ErrorKind::usage, place, fmt::format("'{}' is not {}", text, wanted));
}

template <class T>
T parse_number(std::string_view text, const std::string& place, std::string_view wanted) {
  std::string_view digits = text;
  if (digits.starts_with('+')) {
    digits.remove_prefix(1);
  }
  T value{};
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code != std::errc() || end != digits.data() + digits.size() || digits.empty()) {
    reject(text, place, wanted);
  }
  return value;
}

double parse_finite(std::string_view text, const std::string& place, std::string_view wanted) {
  const auto value = parse_number<double>(text, place, wanted);
  if (!std::isfinite(value)) {
    reject(text, place, wanted);
  }
  return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t at = text.find(separator);
    std::string_view part = text.substr(0, at);
    while (part.starts_with(' ')) {
      part.remove_prefix(1);
    }
    while (part.ends_with(' ')) {
      part.remove_suffix(1);
    }
    parts.push_back(part);
    if (at == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(at + 1);
  }
}

template <std::size_t N>
std::array<std::string_view, N> split_exactly(std::string_view text, const std::string& place,
                                              std::string_view wanted) {
  const auto parts = split(text, ',');
  if (parts.size() != N) {
    reject(text, place, wanted);
  }
  std::array<std::string_view, N> result;
  std::copy(parts.begin(), parts.end(), result.begin());
  return result;
}

constexpr std::string_view kTwoNumbers = "two numbers with a comma between";
constexpr std::string_view kThreeNumbers = "three numbers with commas between";
constexpr std::string_view kDuration = "a duration with its unit, such as 50ms, 1.5s, 12000us, 3ns, 55m or 2h";

struct DurationUnit {
  std::string_view name;
  std::int64_t ns;
  int digits;  // the number of decimals that are still whole nanoseconds
};
// Texts are canonical in seconds at most, since digests are made of them.
constexpr std::array<DurationUnit, 4> kDurationUnits = {
    {{"ns", 1, 0}, {"us", 1'000, 3}, {"ms", 1'000'000, 6}, {"s", 1'000'000'000, 9}}};
struct LongUnit {
  std::string_view name;
  std::int64_t seconds;
};
constexpr std::array<LongUnit, 3> kLongUnits = {{{"min", 60}, {"m", 60}, {"h", 3600}}};
constexpr std::string_view kByteUnits = "KMGT";

}  // namespace

void parse_value(std::string_view text, const std::string& place, bool& value) {
  if (text != "true" && text != "false") {
    reject(text, place, "true or false");
  }
  value = text == "true";
}

void parse_value(std::string_view text, const std::string& place, int& value) {
  value = parse_number<int>(text, place, "a whole number");
}

void parse_value(std::string_view text, const std::string& place, std::uint32_t& value) {
  value = parse_number<std::uint32_t>(text, place, "a whole number from 0 to 4294967295");
}

void parse_value(std::string_view text, const std::string& place, std::uint64_t& value) {
  value = parse_number<std::uint64_t>(text, place, "a whole number from 0 to 18446744073709551615");
}

void parse_value(std::string_view text, const std::string& place, double& value) {
  value = parse_finite(text, place, "a number");
}

void parse_value(std::string_view text, const std::string& /*place*/, std::string& value) {
  value = text;
}

// The conversion is exact: digits are counted, and never multiplied in floating point.
void parse_value(std::string_view text, const std::string& place, DurationNs& value) {
  std::string_view rest = text;
  const bool negative = rest.starts_with('-');
  if (negative || rest.starts_with('+')) {
    rest.remove_prefix(1);
  }
  const DurationUnit* unit = nullptr;
  for (const DurationUnit& candidate : kDurationUnits) {
    if (rest.ends_with(candidate.name) && unit == nullptr) {
      unit = &candidate;
    }
  }
  for (const LongUnit& candidate : kLongUnits) {
    if (unit == nullptr && rest.ends_with(candidate.name)) {
      const std::string number(rest.substr(0, rest.size() - candidate.name.size()));
      if (number.empty() || number.find_first_not_of("0123456789.") != std::string::npos) {
        reject(text, place, kDuration);
      }
      DurationNs of_one;
      parse_value(number + "s", place, of_one);
      if (of_one.ns > std::numeric_limits<std::int64_t>::max() / candidate.seconds) {
        throw Error(ErrorKind::usage, place, fmt::format("'{}' is longer than 292 years", text));
      }
      value.ns = (negative ? -1 : 1) * of_one.ns * candidate.seconds;
      return;
    }
  }
  if (unit != nullptr) {
    rest.remove_suffix(unit->name.size());
  } else if (rest == "0") {
    unit = kDurationUnits.data();
  }
  const std::size_t point = rest.find('.');
  const std::string_view whole = rest.substr(0, point);
  std::string_view fraction = point == std::string_view::npos ? std::string_view() : rest.substr(point + 1);
  if (unit == nullptr || (whole.empty() && fraction.empty()) ||
      (std::string(whole) + std::string(fraction)).find_first_not_of("0123456789") != std::string::npos) {
    reject(text, place, kDuration);
  }
  while (fraction.ends_with('0')) {
    fraction.remove_suffix(1);
  }
  if (static_cast<int>(fraction.size()) > unit->digits) {
    throw Error(ErrorKind::usage, place, fmt::format("'{}' is finer than a nanosecond", text));
  }
  std::string digits = std::string(whole) + std::string(fraction);
  digits.append(static_cast<std::size_t>(unit->digits) - fraction.size(), '0');
  std::int64_t ns = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), ns);
  if (code != std::errc()) {
    throw Error(ErrorKind::usage, place, fmt::format("'{}' is longer than 292 years", text));
  }
  value.ns = negative ? -ns : ns;
}

void parse_value(std::string_view text, const std::string& place, ByteCount& value) {
  constexpr std::string_view kWanted = "a number of bytes, such as 4096, 500M, 1.5G or 2T";
  std::string_view rest = text;
  for (const std::string_view suffix : {"iB", "B"}) {
    if (rest.ends_with(suffix)) {
      rest.remove_suffix(suffix.size());
      break;
    }
  }
  const std::size_t unit = rest.empty() ? std::string_view::npos : kByteUnits.find(rest.back());
  if (unit != std::string_view::npos) {
    rest.remove_suffix(1);
  }
  const double bytes = parse_finite(rest, place, kWanted) *
                       std::exp2(unit == std::string_view::npos ? 0.0 : 10.0 * static_cast<double>(unit + 1));
  if (!(bytes >= 0 && bytes < 1e18)) {
    reject(text, place, kWanted);
  }
  value.bytes = static_cast<std::uint64_t>(bytes);
}

void parse_value(std::string_view text, const std::string& place, Chunk& value) {
  constexpr std::string_view kWanted = "a chunk such as 2/5, the second of five";
  const std::size_t slash = text.find('/');
  value.number = parse_number<std::uint32_t>(text.substr(0, slash), place, kWanted);
  value.count =
      parse_number<std::uint32_t>(slash == std::string_view::npos ? "" : text.substr(slash + 1), place, kWanted);
  if (value.number == 0 || value.number > value.count) {
    reject(text, place, kWanted);
  }
}

void parse_value(std::string_view text, const std::string& place, SizePx& value) {
  constexpr std::string_view kWanted = "a size in pixels such as 1920x1080";
  const auto parts = split(text, 'x');
  if (parts.size() != 2) {
    reject(text, place, kWanted);
  }
  value.width = parse_number<int>(parts[0], place, kWanted);
  value.height = parse_number<int>(parts[1], place, kWanted);
  if (value.width < 1 || value.height < 1 || value.width > 65535 || value.height > 65535) {
    throw Error(ErrorKind::usage, place, fmt::format("'{}' is outside 1x1 to 65535x65535 pixels", text));
  }
}

void parse_value(std::string_view text, const std::string& place, FrameList& value) {
  if (trim(text) == kFixations) {
    value.frames.clear();
    return;
  }
  try {
    value.frames = parse_frame_list(text);
  } catch (const Error& error) {
    throw Error(error.kind(), place, error.what());
  }
}

void parse_value(std::string_view text, const std::string& place, FrameRate& value) {
  try {
    value = parse_frame_rate(text);
  } catch (const Error& error) {
    throw Error(error.kind(), place, error.what());
  }
}

void parse_value(std::string_view text, const std::string& place, Shutter& value) {
  try {
    value = parse_shutter(text);
  } catch (const Error& error) {
    throw Error(error.kind(), place, error.what());
  }
}

void parse_value(std::string_view text, const std::string& place, Aperture& value) {
  constexpr std::string_view kForm = "an f-number as f/2.8, or a radius in metres";
  const bool is_f_number = text.starts_with("f/");
  const double number = parse_finite(text.substr(is_f_number ? 2 : 0), place, kForm);
  if (number < 0 || (is_f_number && number == 0)) {
    throw Error(ErrorKind::usage, place, fmt::format("'{}' is no aperture", text), std::string("give ") + kForm.data());
  }
  value = is_f_number ? Aperture{number, 0} : Aperture{0, number};
}

void parse_value(std::string_view text, const std::string& place, Vec2d& value) {
  const auto [x, y] = split_exactly<2>(text, place, kTwoNumbers);
  value = {parse_finite(x, place, kTwoNumbers), parse_finite(y, place, kTwoNumbers)};
}

void parse_value(std::string_view text, const std::string& place, Vec3d& value) {
  const auto [x, y, z] = split_exactly<3>(text, place, kThreeNumbers);
  value = {parse_finite(x, place, kThreeNumbers), parse_finite(y, place, kThreeNumbers),
           parse_finite(z, place, kThreeNumbers)};
}

void parse_value(std::string_view text, const std::string& place, FrameRect& value) {
  constexpr std::string_view kWanted = "a rectangle in display pixels: X,Y,WIDTH,HEIGHT";
  const auto [x, y, w, h] = split_exactly<4>(text, place, kWanted);
  value = {parse_finite(x, place, kWanted), parse_finite(y, place, kWanted), parse_finite(w, place, kWanted),
           parse_finite(h, place, kWanted)};
  if (value.width_px <= 0 || value.height_px <= 0) {
    reject(text, place, "a rectangle with positive width and height");
  }
}

void parse_value(std::string_view text, const std::string& place, FrameCrop& value) {
  constexpr std::string_view kWanted = "a rectangle in pixels of the frame: X,Y,WIDTH,HEIGHT";
  const auto [x, y, w, h] = split_exactly<4>(text, place, kWanted);
  const auto side = [&](std::string_view part) { return int{parse_number<std::uint16_t>(part, place, kWanted)}; };
  value = {side(x), side(y), side(w), side(h)};
  if (value.width_px == 0 || value.height_px == 0) {
    reject(text, place, "a rectangle with positive width and height");
  }
}

void parse_value(std::string_view text, const std::string& place, PixelIndex& value) {
  constexpr std::string_view kWanted = "a pixel: X,Y counted from 0 at the top left";
  const auto [x, y] = split_exactly<2>(text, place, kWanted);
  value = {parse_number<std::uint16_t>(x, place, kWanted), parse_number<std::uint16_t>(y, place, kWanted)};
}

void parse_value(std::string_view text, const std::string& place, std::array<std::uint32_t, 3>& value) {
  constexpr std::string_view kWanted = "three whole numbers with commas between";
  const auto parts = split_exactly<3>(text, place, kWanted);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    value[i] = parse_number<std::uint32_t>(parts[i], place, kWanted);
  }
}

void parse_value(std::string_view text, const std::string& place, std::array<int, 2>& value) {
  constexpr std::string_view kWanted = "two whole numbers with a comma between";
  const auto parts = split_exactly<2>(text, place, kWanted);
  value = {parse_number<int>(parts[0], place, kWanted), parse_number<int>(parts[1], place, kWanted)};
}

void parse_value(std::string_view text, const std::string& place, std::array<double, 2>& value) {
  const auto [a, b] = split_exactly<2>(text, place, kTwoNumbers);
  value = {parse_finite(a, place, kTwoNumbers), parse_finite(b, place, kTwoNumbers)};
}

void parse_value(std::string_view text, const std::string& place, std::vector<std::string>& value) {
  value.clear();
  for (const std::string_view part : split(text, ',')) {
    if (part.empty()) {
      reject(text, place, "a list of names with commas between");
    }
    value.emplace_back(part);
  }
}

void parse_value(std::string_view text, const std::string& place, ExposureSettings& value) {
  constexpr std::string_view kWanted = "stops (such as -1.5), auto, or auto and a shift (auto+0.5)";
  const bool automatic = text.starts_with("auto");
  const std::string_view stops = automatic ? text.substr(4) : text;
  if (automatic && !stops.empty() && !stops.starts_with('+') && !stops.starts_with('-')) {
    reject(text, place, kWanted);
  }
  value.mode = automatic ? ExposureMode::log_average : ExposureMode::fixed;
  value.ev = stops.empty() && automatic ? 0.0 : parse_finite(stops, place, kWanted);
}

std::string format_value(bool value) {
  return value ? "true" : "false";
}

std::string format_value(int value) {
  return std::to_string(value);
}

std::string format_value(std::uint32_t value) {
  return std::to_string(value);
}

std::string format_value(std::uint64_t value) {
  return std::to_string(value);
}

// The shortest text that reads back as the same number; minus zero is written as zero.
std::string format_value(double value) {
  return fmt::format("{}", value == 0 ? 0.0 : value);
}

std::string format_value(const std::string& value) {
  return value;
}

std::string format_value(const DurationNs& value) {
  for (auto unit = kDurationUnits.rbegin(); unit != kDurationUnits.rend(); ++unit) {
    if (value.ns % unit->ns == 0 && value.ns != 0) {
      return fmt::format("{}{}", value.ns / unit->ns, unit->name);
    }
  }
  return "0s";
}

std::string format_value(const ByteCount& value) {
  std::uint64_t bytes = value.bytes;
  std::size_t unit = 0;
  while (bytes > 0 && bytes % 1024 == 0 && unit < kByteUnits.size()) {
    bytes /= 1024;
    ++unit;
  }
  return std::to_string(bytes) + (unit == 0 ? std::string() : std::string(1, kByteUnits[unit - 1]));
}

std::string format_value(const Chunk& value) {
  return fmt::format("{}/{}", value.number, value.count);
}

std::string format_value(const SizePx& value) {
  return fmt::format("{}x{}", value.width, value.height);
}

std::string format_value(const FrameList& value) {
  return value.frames.empty() ? std::string(kFixations) : format_frame_list(value.frames);
}

std::string format_value(const FrameRate& value) {
  return to_string(value);
}

std::string format_value(const Shutter& value) {
  return to_string(value);
}

std::string format_value(const Aperture& value) {
  return value.f_number > 0 ? "f/" + format_value(value.f_number) : format_value(value.radius_m);
}

std::string format_value(const Vec2d& value) {
  return format_value(value.x) + "," + format_value(value.y);
}

std::string format_value(const Vec3d& value) {
  return format_value(value.x) + "," + format_value(value.y) + "," + format_value(value.z);
}

std::string format_value(const FrameRect& value) {
  return format_value(Vec2d{value.x_px, value.y_px}) + "," + format_value(Vec2d{value.width_px, value.height_px});
}

std::string format_value(const FrameCrop& value) {
  return fmt::format("{},{},{},{}", value.x_px, value.y_px, value.width_px, value.height_px);
}

std::string format_value(const PixelIndex& value) {
  return fmt::format("{},{}", value.x, value.y);
}

std::string format_value(const std::array<std::uint32_t, 3>& value) {
  return fmt::format("{},{},{}", value[0], value[1], value[2]);
}

std::string format_value(const std::array<int, 2>& value) {
  return fmt::format("{},{}", value[0], value[1]);
}

std::string format_value(const std::array<double, 2>& value) {
  return format_value(Vec2d{value[0], value[1]});
}

std::string format_value(const std::vector<std::string>& value) {
  return fmt::format("{}", fmt::join(value, ","));
}

void parse_value(std::string_view text, const std::string& place, Sampling& value) {
  value = parse_sampling(text, place);
}

std::string format_value(const Sampling& value) {
  return to_string(value);
}

void parse_value(std::string_view text, const std::string& place, DensitySampling& value) {
  value = parse_density(text, place);
}

std::string format_value(const DensitySampling& value) {
  return to_string(value);
}

std::string format_value(const ExposureSettings& value) {
  if (value.mode == ExposureMode::fixed) {
    return format_value(value.ev);
  }
  return value.ev == 0 ? "auto" : "auto" + std::string(value.ev > 0 ? "+" : "") + format_value(value.ev);
}

}  // namespace gazetrace
