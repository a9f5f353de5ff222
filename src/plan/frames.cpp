// SPDX-License-Identifier: Apache-2.0
// Parses and formats frame rates and frame lists.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <optional>

#include "core/text.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kRateRemedy = "write frames per second as 24, 23.976 or 24000/1001";
constexpr std::string_view kListRemedy = "write frames as 1-100, 1-100x2 or 1,5,9-12";

[[noreturn]] void bad_rate(std::string_view text, std::string_view problem) {
  throw Error(ErrorKind::usage, "", fmt::format("'{}' {}", text, problem), kRateRemedy);
}

[[noreturn]] void bad_list(std::string_view text, std::string_view problem) {
  throw Error(ErrorKind::usage, "", fmt::format("'{}' {}", text, problem), kListRemedy);
}

template <class Integer>
std::optional<Integer> integer_from(std::string_view text) {
  Integer value = 0;
  const auto [rest, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc{} && rest == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

void append_range(std::string_view item, std::vector<std::int32_t>& frames) {
  std::string_view range = item;
  std::int64_t step = 1;
  if (const std::size_t x = item.find('x'); x != std::string_view::npos) {
    const auto given = integer_from<std::int32_t>(trim(item.substr(x + 1)));
    if (!given || *given < 1) {
      bad_list(item, "has no step of 1 or more after its x");
    }
    step = *given;
    range = item.substr(0, x);
  }
  const std::size_t dash = range.find('-', 1);
  if (dash == std::string_view::npos && range.size() != item.size()) {
    bad_list(item, "has a step, but no range");
  }
  const auto first = integer_from<std::int32_t>(trim(range.substr(0, dash)));
  const auto last = dash == std::string_view::npos ? first : integer_from<std::int32_t>(trim(range.substr(dash + 1)));
  if (!first || !last) {
    bad_list(item, fmt::format("is neither a frame from 1 to {} nor a range of them",
                               std::numeric_limits<std::int32_t>::max()));
  }
  if (*first < 1 || *last < 1) {
    bad_list(item, "does not exist: frames are numbered from 1");
  }
  if (*last < *first) {
    bad_list(item, "counts backwards");
  }
  if ((std::int64_t{*last} - *first) / step + static_cast<std::int64_t>(frames.size()) >= kMostPlannedFrames) {
    bad_list(item, fmt::format("makes more than {} frames", kMostPlannedFrames));
  }
  for (std::int64_t frame = *first; frame <= *last; frame += step) {
    frames.push_back(static_cast<std::int32_t>(frame));
  }
}

}  // namespace

FrameRate parse_frame_rate(std::string_view text) {
  const std::string_view trimmed = trim(text);
  FrameRate rate;
  if (const std::size_t slash = trimmed.find('/'); slash != std::string_view::npos) {
    const auto numerator = integer_from<std::int64_t>(trim(trimmed.substr(0, slash)));
    const auto denominator = integer_from<std::int64_t>(trim(trimmed.substr(slash + 1)));
    if (!numerator || !denominator) {
      bad_rate(text, "is not a fraction of two whole numbers");
    }
    rate = {*numerator, *denominator};
  } else {
    const std::size_t point = trimmed.find('.');
    const std::size_t decimals = point == std::string_view::npos ? 0 : trimmed.size() - point - 1;
    const bool digits_only = trimmed.find_first_not_of("+-.0123456789") == std::string_view::npos;
    if (!digits_only || decimals > 9 ||
        scaled_integer(trimmed, static_cast<int>(decimals), rate.numerator) != NumberStatus::ok) {
      bad_rate(text, "is not a frame rate");
    }
    for (std::size_t i = 0; i < decimals; ++i) {
      rate.denominator *= 10;
    }
  }
  if (rate.numerator <= 0 || rate.denominator <= 0) {
    bad_rate(text, "is not positive");
  }
  const std::int64_t divisor = std::gcd(rate.numerator, rate.denominator);
  return {rate.numerator / divisor, rate.denominator / divisor};
}

std::string to_string(const FrameRate& rate) {
  return rate.denominator == 1 ? fmt::format("{}", rate.numerator)
                               : fmt::format("{}/{}", rate.numerator, rate.denominator);
}

std::vector<std::int32_t> parse_frame_list(std::string_view text) {
  std::vector<std::int32_t> frames;
  if (trim(text).empty()) {
    bad_list(text, "names no frame");
  }
  std::vector<std::string_view> items;
  split_cells(text, ',', items);
  for (const std::string_view item : items) {
    if (trim(item).empty()) {
      bad_list(text, "has an empty part");
    }
    append_range(trim(item), frames);
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::string format_frame_list(const std::vector<std::int32_t>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    // Finds the longest run with one step; with a step of two or more, a range is worth it from three frames on.
    std::size_t end = i + 1;
    const std::int64_t step = end < frames.size() ? std::int64_t{frames[end]} - frames[i] : 1;
    while (end < frames.size() && std::int64_t{frames[end]} - frames[end - 1] == step) {
      ++end;
    }
    if (end - i < 3 && step != 1) {
      end = i + 1;
    }
    text += text.empty() ? "" : ",";
    text += fmt::format("{}", frames[i]);
    if (end - i > 1) {
      text += fmt::format("-{}", frames[end - 1]);
      text += step == 1 ? "" : fmt::format("x{}", step);
    }
    i = end;
  }
  return text;
}

}  // namespace gazetrace
