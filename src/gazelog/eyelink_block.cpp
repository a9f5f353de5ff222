// SPDX-License-Identifier: Apache-2.0
#include "gazelog/eyelink_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/text.hpp"

namespace gazetrace {

std::size_t numbers_of_bare_samples(std::string_view text) {
  constexpr std::size_t kLooked = 20;
  std::size_t found = 0;
  std::size_t lines_seen = 0;
  std::vector<std::string_view> words;
  LineReader lines(text);
  for (std::string_view line; lines_seen < kLooked && lines.next(line);) {
    split_cells(line, ' ', words);
    if (words.empty()) {
      continue;
    }
    ++lines_seen;
    const std::size_t numbers = words.size() - 2;
    const std::string_view flags = words.back();
    const bool fits = words.size() > 4 && words[0].size() > 3 &&
                      words[0].find_first_not_of("0123456789.") == std::string_view::npos &&
                      (numbers == 3 || numbers == 6) && flags.size() == (numbers == 6 ? 5 : 3) &&
                      flags.find_first_not_of(".ICR") == std::string_view::npos &&
                      line.find('\t') != std::string_view::npos && (found == 0 || found == numbers);
    if (!fits) {
      return 0;
    }
    found = numbers;
  }
  return found;
}

void mark_blinks(RawRows& rows, Eye eye, const std::vector<TimeSpan>& blinks, const std::vector<TimeSpan>& saccades) {
  std::vector<TimeSpan> spans = blinks;
  std::size_t b = 0;
  for (const TimeSpan& saccade : saccades) {
    while (b < blinks.size() && blinks[b].end_ns < saccade.begin_ns) {
      ++b;
    }
    if (b < blinks.size() && blinks[b].begin_ns >= saccade.begin_ns && blinks[b].end_ns <= saccade.end_ns) {
      spans.push_back(saccade);
    }
  }
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& x, const TimeSpan& y) { return x.begin_ns < y.begin_ns; });
  std::size_t s = 0;
  for (std::size_t row = 0; row < rows.size() && !spans.empty(); ++row) {
    const RawSample sample = rows[row];
    if (sample.eye != eye) {
      continue;
    }
    while (s < spans.size() && spans[s].end_ns < sample.t_ns) {
      ++s;
    }
    // Spans may hold each other: a saccade and the blink within.
    for (std::size_t i = s; i < spans.size() && spans[i].begin_ns <= sample.t_ns; ++i) {
      if (sample.t_ns <= spans[i].end_ns) {
        rows.set_validity(row, GazeValidity::blink);
        break;
      }
    }
  }
}

bool is_usual_display_height(double px) {
  static constexpr std::array kHeights{480,  600,  720,  768,  800,  864,  900,  960,  1024,
                                       1050, 1080, 1200, 1280, 1440, 1536, 1600, 2160, 2880};
  return std::find(kHeights.begin(), kHeights.end(), static_cast<int>(std::lround(px))) != kHeights.end();
}

}  // namespace gazetrace
