// SPDX-License-Identifier: Apache-2.0
// How the samples of an EyeLink ASC file are laid out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_raw_rows.hpp"

namespace gazetrace {

// What the SAMPLES line of a recording block announces.
struct EyeLinkBlock {
  bool has_left = true, has_right = false;
  std::string data = "GAZE";  // GAZE, HREF or PUPIL
  double rate_hz = 0;
  bool has_velocity = false, has_resolution = false, has_input = false, has_buttons = false;

  [[nodiscard]] std::size_t eyes() const { return (has_left ? 1U : 0U) + (has_right ? 1U : 0U); }
  [[nodiscard]] std::size_t resolution_column() const { return 1 + 3 * eyes() + (has_velocity ? 2 * eyes() : 0); }
  [[nodiscard]] std::size_t flags_column() const {
    return resolution_column() + (has_resolution ? 2U : 0U) + (has_buttons ? 1U : 0U) + (has_input ? 1U : 0U);
  }
};

// Samples as edf2asc writes them without messages: a whole stamp, three or six numbers, and flags of dots and letters.
// Returns how many numbers there are; 0 for another text.
std::size_t numbers_of_bare_samples(std::string_view text);

struct TimeSpan {
  std::int64_t begin_ns, end_ns;
};
// A blink begins and ends in what the tracker takes for a saccade; all of it becomes blink. The spans are those of the
// eye's events, in the order of the file.
void mark_blinks(RawRows& rows, Eye eye, const std::vector<TimeSpan>& blinks, const std::vector<TimeSpan>& saccades);

// Whether displays have that many lines.
bool is_usual_display_height(double px);

}  // namespace gazetrace
