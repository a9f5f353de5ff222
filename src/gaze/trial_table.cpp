// SPDX-License-Identifier: Apache-2.0
#include "gaze/trial_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/text.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {

std::vector<GazeTrial> read_trial_table(const std::string& path) {
  const GazeFile file{path, read_text_file(path)};
  const DelimitedTable table = open_table(file);
  const auto fail_header = [&](const std::string& problem) {
    throw Error(ErrorKind::input, place_of(file, std::max<std::int64_t>(table.header_line, 1)), problem,
                "name its columns onset and duration (seconds), or onset_ns and offset_ns, on the clock of the log");
  };
  if (table.headings.empty()) {
    fail_header("is empty");
  }
  const auto name = table.find_any({"name", "trial_type"});
  const auto onset = table.find("onset");  // or onset_ns, as their units tell
  const auto offset = table.find("offset");
  const auto duration = table.find("duration");
  if (!onset || (!offset && !duration)) {
    fail_header("names no columns onset and duration (seconds), nor onset_ns and offset_ns");
  }
  std::vector<GazeTrial> trials;
  TableRows rows(file, table, table.headings.size());
  const auto time = [&](std::size_t column) {
    return rows.time_ns(column, {time_exponent(table.headings[column].unit).value_or(9), 0});
  };
  while (rows.next()) {
    GazeTrial trial;
    trial.name = rows.cell(name);
    trial.begin_ns = time(*onset);
    const bool fits = offset || !__builtin_add_overflow(trial.begin_ns, time(*duration), &trial.end_ns);
    trial.end_ns = offset ? time(*offset) : trial.end_ns;
    if (fits && trial.end_ns < trial.begin_ns) {
      rows.fail("the trial ends before it begins", "mend the row");
    }
    // As of a log: durations are taken everywhere, and half of what an int64 holds leaves room for their sums.
    std::int64_t duration_ns = 0;
    if (!fits || __builtin_sub_overflow(trial.end_ns, trial.begin_ns, &duration_ns) ||
        duration_ns > std::numeric_limits<std::int64_t>::max() / 2) {
      rows.fail("the trial lasts more than a hundred years",
                "give onset and duration in seconds, or onset_ns and offset_ns");
    }
    trials.push_back(std::move(trial));
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const GazeTrial& a, const GazeTrial& b) { return a.begin_ns < b.begin_ns; });
  return trials;
}

}  // namespace gazetrace
