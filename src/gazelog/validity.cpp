// SPDX-License-Identifier: Apache-2.0
#include "gazelog/columns.hpp"

#include <algorithm>

#include "core/text.hpp"

namespace gazetrace {

std::optional<GazeValidity> validity_by_name(std::string_view text) {
  for (const GazeValidity validity : {GazeValidity::ok, GazeValidity::low_confidence, GazeValidity::blink,
                                      GazeValidity::lost, GazeValidity::off_screen, GazeValidity::interpolated}) {
    if (text == to_string(validity)) {
      return validity;
    }
  }
  return std::nullopt;
}

ValidityReader::ValidityReader(const GazeColumns& columns, ValidityStyle style)
    : style_(style), mask_(columns.valid_mask) {
  for (const std::string& value : columns.valid_values) {
    wanted_.push_back(to_lower(trim(value)));
  }
  if (wanted_.empty()) {
    wanted_ = {"1", "true", "ok", "valid"};
  }
}

std::optional<GazeValidity> ValidityReader::read(std::string_view text) {
  if (text != last_text_ || !has_last_) {  // nearly always the same as in the row before
    last_text_ = text;
    has_last_ = true;
    last_ = interpret(last_text_);
  }
  return last_;
}

std::optional<GazeValidity> ValidityReader::interpret(const std::string& text) {
  if (seen_.size() < 6 && std::find(seen_.begin(), seen_.end(), text) == seen_.end()) {
    seen_.push_back(text);
  }
  const std::string lower = to_lower(text);
  if (mask_ != 0) {
    std::int64_t bits = 0;
    const bool is_integer = scaled_integer(lower, 0, bits) == NumberStatus::ok;
    return is_integer && (bits & mask_) == mask_ ? GazeValidity::ok : GazeValidity::lost;
  }
  const auto number = number_from(lower);
  for (const std::string& value : wanted_) {
    const auto wanted_number = number_from(value);
    if (lower == value || (number && wanted_number && *number == *wanted_number)) {
      return GazeValidity::ok;
    }
  }
  if (const auto named = validity_by_name(lower)) {
    return named;
  }
  const bool understood = style_ == ValidityStyle::any || is_missing(lower) || lower == "0" || lower == "false";
  return understood ? std::optional(GazeValidity::lost) : std::nullopt;
}

std::optional<Eye> eye_from(std::string_view text) {
  const std::string lower = to_lower(text);
  if (lower == "left" || lower == "l") {
    return Eye::left;
  }
  if (lower == "right" || lower == "r") {
    return Eye::right;
  }
  for (const std::string_view both : {"cyclopean", "c", "both", "b", "mean", "combined", "average", "binocular"}) {
    if (lower == both) {
      return Eye::cyclopean;
    }
  }
  return std::nullopt;
}

}  // namespace gazetrace
