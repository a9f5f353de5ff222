// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/text.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kForms =
    "give the open part of a frame (0.5), an angle (180deg), opening and closing (0.25,0.75), or 0 for none";

[[noreturn]] void bad_shutter(std::string_view text, const char* problem) {
  throw Error(ErrorKind::usage, "", fmt::format("shutter '{}' {}", text, problem), kForms);
}

Shutter about_the_middle(double part) {
  return {0.5 - part / 2, 0.5 + part / 2};
}

}  // namespace

Shutter parse_shutter(std::string_view text) {
  std::string_view trimmed = trim(text);
  Shutter shutter;
  if (const std::size_t comma = trimmed.find(','); comma != std::string_view::npos) {
    const auto open = number_from(trim(trimmed.substr(0, comma)));
    const auto close = number_from(trim(trimmed.substr(comma + 1)));
    if (!open || !close) {
      bad_shutter(text, "is not two numbers");
    }
    if (*open == *close) {
      bad_shutter(text, "opens and closes at the same time");
    }
    shutter = {*open, *close};
  } else {
    const bool angle = trimmed.ends_with("deg");
    trimmed.remove_suffix(angle ? 3 : 0);
    const auto part = number_from(trim(trimmed));
    if (!part) {
      bad_shutter(text, "is not a number");
    }
    shutter = about_the_middle(angle ? *part / 360 : *part);
  }
  if (!(shutter.open >= 0 && shutter.open <= shutter.close && shutter.close <= 1)) {
    bad_shutter(text, "is not within its frame");
  }
  return shutter;
}

std::string to_string(const Shutter& shutter) {
  return shutter.blurs() ? fmt::format("{},{}", shutter.open, shutter.close) : "0";
}

}  // namespace gazetrace
