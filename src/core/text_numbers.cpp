// SPDX-License-Identifier: Apache-2.0
// The numbers of text.hpp: decimal numbers as integers and as doubles, and units of time.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Digits alone, so few that an int64 holds them: nearly all time stamps.
bool is_short_whole_number(std::string_view text) {
  return !text.empty() && text.size() <= 18 && std::all_of(text.begin(), text.end(), is_digit);
}

NumberStatus scaled_whole_number(std::string_view text, std::int64_t factor, std::int64_t& value) {
  std::int64_t whole = 0;
  for (const char c : text) {
    whole = 10 * whole + (c - '0');
  }
  return __builtin_mul_overflow(whole, factor, &value) ? NumberStatus::overflow : NumberStatus::ok;
}

// A decimal number as it is written.
struct WrittenNumber {
  bool is_negative = false;
  std::string_view text;   // its digits, with the decimal point or comma where there is one
  std::int64_t whole = 0;  // of the digits, those before the point
  std::int64_t count = 0;  // of all digits
  std::int64_t power = 0;  // of ten, by which it is multiplied

  // Zero behind the last one.
  [[nodiscard]] std::uint64_t digit(std::int64_t i) const {
    if (i >= count) {
      return 0;
    }
    const std::int64_t at = i < whole ? i : i + 1;
    return static_cast<std::uint64_t>(text[static_cast<std::size_t>(at)] - '0');
  }
};

// "e-3": its power of ten, or one that is beyond every number where an int cannot hold it.
std::optional<std::int64_t> written_power(std::string_view text) {
  std::string_view power = text.substr(1);
  if ((text.front() != 'e' && text.front() != 'E') || power.empty()) {
    return std::nullopt;
  }
  if (power.front() == '+') {
    power.remove_prefix(1);
  }
  std::int32_t given = 0;
  const auto [rest, status] = std::from_chars(power.data(), power.data() + power.size(), given);
  if (rest != power.data() + power.size() || status == std::errc::invalid_argument) {
    return std::nullopt;
  }
  if (status != std::errc{}) {
    return power.front() == '-' ? -1'000'000 : 1'000'000;
  }
  return given;
}

std::optional<WrittenNumber> written_number(std::string_view text) {
  WrittenNumber number;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    number.is_negative = text.front() == '-';
    text.remove_prefix(1);
  }
  std::size_t end = 0;
  std::size_t mark = std::string_view::npos;  // of the decimal point
  for (; end < text.size(); ++end) {
    if ((text[end] == '.' || text[end] == ',') && mark == std::string_view::npos) {
      mark = end;
    } else if (!is_digit(text[end])) {
      break;
    }
  }
  number.text = text.substr(0, end);
  number.whole = static_cast<std::int64_t>(std::min(mark, end));
  number.count = static_cast<std::int64_t>(end) - (mark == std::string_view::npos ? 0 : 1);
  if (number.count == 0) {
    return std::nullopt;
  }
  if (end < text.size()) {
    const std::optional<std::int64_t> power = written_power(text.substr(end));
    if (!power) {
      return std::nullopt;
    }
    number.power = *power;
  }
  return number;
}

// The number without what follows its digit `kept`, which decides the rounding.
NumberStatus rounded(const WrittenNumber& number, std::int64_t kept, std::int64_t& value) {
  const std::uint64_t limit = number.is_negative ? std::uint64_t{1} << 63U : (std::uint64_t{1} << 63U) - 1;
  std::uint64_t magnitude = 0;
  for (std::int64_t i = 0; i < kept; ++i) {
    if (i >= number.count && magnitude == 0) {
      break;
    }
    const std::uint64_t d = number.digit(i);
    if (magnitude > (limit - d) / 10) {
      return NumberStatus::overflow;
    }
    magnitude = magnitude * 10 + d;
  }
  if (kept >= 0 && kept < number.count && number.digit(kept) >= 5) {
    if (magnitude == limit) {
      return NumberStatus::overflow;
    }
    ++magnitude;
  }
  value = static_cast<std::int64_t>(number.is_negative ? 0 - magnitude : magnitude);
  return NumberStatus::ok;
}

}  // namespace

NumberStatus scaled_integer(std::string_view text, int exponent, std::int64_t& value) {
  constexpr std::array<std::int64_t, 10> kPowers{1,       10,        100,        1'000,       10'000,
                                                 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
  if (exponent >= 0 && exponent < 10 && is_short_whole_number(text)) {
    return scaled_whole_number(text, kPowers[static_cast<std::size_t>(exponent)], value);
  }
  const std::optional<WrittenNumber> number = written_number(text);
  return number ? rounded(*number, number->whole + number->power + exponent, value) : NumberStatus::malformed;
}

std::optional<double> number_from(std::string_view text) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text.front() == '-') {
      return std::nullopt;
    }
  }
  double value = 0;
  const auto [rest, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc{} && rest == text.data() + text.size()) {
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }
  const std::size_t comma = text.find(',');
  std::array<char, 64> copy{};
  if (comma == std::string_view::npos || text.find('.') != std::string_view::npos || text.size() > copy.size()) {
    return std::nullopt;
  }
  std::copy(text.begin(), text.end(), copy.begin());
  copy[comma] = '.';
  const char* const end = copy.data() + text.size();
  const auto with_point = std::from_chars(copy.data(), end, value);
  const bool good = with_point.ec == std::errc{} && with_point.ptr == end && std::isfinite(value);
  return good ? std::optional(value) : std::nullopt;
}

std::optional<std::size_t> count_from(std::string_view text) {
  std::size_t count = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), count);
  return code == std::errc() && end == text.data() + text.size() ? std::optional(count) : std::nullopt;
}

std::optional<int> time_exponent(std::string_view unit) {
  struct Spelling {
    std::string_view text;
    int exponent;
  };
  static constexpr std::array<Spelling, 26> kSpellings{{
      {"s", 9},           {"sec", 9},          {"secs", 9},        {"second", 9},
      {"seconds", 9},     {"in secs", 9},      {"ms", 6},          {"msec", 6},
      {"millisecond", 6}, {"milliseconds", 6}, {"us", 3},          {"usec", 3},
      {"\xC2\xB5s", 3},   {"\xCE\xBCs", 3},    {"microsecond", 3}, {"microseconds", 3},
      {"100ns", 2},       {"100 ns", 2},       {"ns", 0},          {"nsec", 0},
      {"nanosecond", 0},  {"nanoseconds", 0},  {"\xC2\xB5sec", 3}, {"\xCE\xBCsec", 3},
      {"millis", 6},      {"nanos", 0},
  }};
  const std::string lower = to_lower(trim(unit));
  for (const Spelling& spelling : kSpellings) {
    if (lower == spelling.text) {
      return spelling.exponent;
    }
  }
  return std::nullopt;
}

}  // namespace gazetrace
