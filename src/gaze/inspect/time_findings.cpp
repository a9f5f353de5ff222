// SPDX-License-Identifier: Apache-2.0
// What is wrong with the stamps: their order, their unit, and when they were taken.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "gaze/inspect/inspect.hpp"
#include "gazelog/stamps.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

constexpr double kPlausibleLowHz = 5, kPlausibleHighHz = 5000;

void order(const GazeLog& log, GazeInspection& report) {
  const GazeOrder& found = log.order;
  if (found.backward_steps == 0 && found.duplicates == 0) {
    return;
  }
  const bool repeats = found.duplicates > 0 && found.identical_duplicates * 10 >= found.duplicates * 9;
  // A repeated block of rows goes back in time as well, and one finding for both is enough.
  const std::string problem = found.backward_steps > 0
                                  ? fmt::format("line {}: {}", found.first_backward_row, unordered_problem(found))
                                  : fmt::format("line {}: {}", found.first_duplicate_row, duplicate_problem(found));
  const std::string seen = fmt::format("{} of {} rows go back in time, {} stand at a time that is there already",
                                       found.backward_steps, found.rows, found.duplicates);
  const std::string setting = loses_much(found) ? "" : "`order` sort";
  const auto add = [&](const char* code, const std::string& what, const std::string& more = {}) {
    add_finding(report, FindingKind::fault, code, what, seen + more, setting);
  };
  if (found.backward_steps * 50 > found.rows) {
    add("unordered", "the rows are not in the order of time: " + problem);
  } else if (repeats) {
    add("repeated-rows",
        fmt::format("{} rows are repeated, the first in line {}", found.duplicates, found.first_duplicate_row),
        fmt::format("; {} of these have the same position, too", found.identical_duplicates));
  } else if (found.duplicates > 0 && found.backward_steps == 0) {
    add("duplicates",
        fmt::format("{} rows stand at the time of another row with another position: {}", found.duplicates, problem),
        setting.empty() ? fmt::format("; dropping them would keep {} of {} rows: export again with finer stamps",
                                      found.rows - found.duplicates, found.rows)
                        : "");
  } else {
    add("unordered", "some rows are not in the order of time: " + problem);
  }
}

// Stamps that were taken when a buffer was written: runs of steps that are far shorter than the others.
void bursts(const GazeLog& log, GazeInspection& report) {
  // Where most rows stand in bursts, the median step is that within them.
  const double median_ns = report.timing.median_rate_hz > 0 ? 1e9 / report.timing.median_rate_hz : 0;
  const double mean_ns =
      static_cast<double>(report.span_ns) / static_cast<double>(std::max<std::size_t>(1, log.samples.size()));
  const bool are_packets = mean_ns > 4 * median_ns;
  const double step_ns = are_packets ? mean_ns : median_ns;
  constexpr std::size_t kShortestRun = 4;
  constexpr std::size_t kLongestPacket = 64;
  std::size_t runs = 0;
  std::size_t rows = 0;
  std::size_t run = 0;
  std::int64_t first_row = 0;
  for (std::size_t i = 1; i <= log.samples.size(); ++i) {
    const bool is_short =
        i < log.samples.size() && static_cast<double>(log.samples[i].t_ns - log.samples[i - 1].t_ns) < 0.25 * step_ns;
    if (!is_short && run >= kShortestRun) {
      first_row = runs++ == 0 ? log.samples[i - run - 1].row : first_row;
      rows += run;
    }
    run = is_short ? run + 1 : 0;
  }
  if (runs == 0 || (runs == 1 && rows * 200 < log.samples.size()) ||
      (are_packets && (runs < 10 || rows > kLongestPacket * runs))) {  // else they are parts between pauses
    return;
  }
  const double seconds = static_cast<double>(report.span_ns) * 1e-9;
  add_finding(
      report, FindingKind::suspicion, "bursts",
      fmt::format(
          "the times of {} rows, in {} burst{} from line {} on, tell when a row was written, and not when the eye "
          "was measured",
          rows, runs, runs == 1 ? "" : "s", first_row),
      fmt::format("{} rows in {:.3f} s are {:.1f} Hz, by the median step {:.1f} Hz; name a column of the tracker's "
                  "own time by `time-column` NAME if the file has one, or export it again with that time",
                  log.samples.size(), seconds, static_cast<double>(log.samples.size() - 1) / std::max(seconds, 1e-9),
                  report.timing.median_rate_hz));
}

// The unit of stamps whose exponent differs by `shift` powers of ten, as an option; empty where there is none.
std::string time_unit_setting(const GazeLog& log, int shift) {
  const int now = log.conventions.time_exponent.value;
  const auto is_named = [](int exponent) { return exponent >= 0 && exponent <= 9 && exponent % 3 == 0; };
  return is_named(now) && is_named(now + shift) ? fmt::format("`time-unit` {}", time_unit_text(now + shift)) : "";
}

void time_unit(const GazeLog& log, bool can_be_said, GazeInspection& report) {
  const double rate = report.timing.median_rate_hz;
  if (log.samples.size() < 10 || !(rate > 0) || has_finding(report, {"bursts"})) {
    return;
  }
  const double nominal = log.nominal_rate_hz;
  // Powers of ten between the unit that was read and the unit that is meant.
  for (const int shift : {3, 6, 9, -3, -6, -9}) {
    const double meant = rate * std::pow(10.0, -shift);
    const std::string setting = can_be_said ? time_unit_setting(log, shift) : "";
    if (setting.empty()) {
      continue;
    }
    if (nominal > 0) {
      if (meant / nominal > 0.5 && meant / nominal < 2) {
        add_finding(report, FindingKind::fault, "time-unit",
                    fmt::format("the stamps are not in {}: the log states {:.6g} Hz, and its stamps give {:.4g} Hz",
                                time_unit_text(log.conventions.time_exponent.value), nominal, rate),
                    fmt::format("the stated rate against the median step; the two differ by 10^{}", shift), setting);
        return;
      }
    } else if ((rate > kPlausibleHighHz || rate < kPlausibleLowHz) && meant >= 20 && meant <= 2100) {
      add_finding(report, FindingKind::suspicion, "time-unit",
                  fmt::format("the stamps can hardly be in {}: they give {:.4g} Hz, {:.4g} Hz in the other unit",
                              time_unit_text(log.conventions.time_exponent.value), rate, meant),
                  "statistics: the median step against the rates that eye trackers have", setting);
      return;
    }
  }
  if (nominal > 0 && (rate / nominal > 1.2 || rate / nominal < 0.83)) {
    add_finding(report, FindingKind::note, "rate",
                fmt::format("the log states {:.6g} Hz, its stamps give {:.6g} Hz", nominal, rate),
                "the stated rate against the median step");
  }
}

}  // namespace

void find_faults_of_time(const GazeLog& log, const GazeUnderInspection* whole, GazeInspection& inspection) {
  // Of stamps that have a fault of their own, the order says nothing new.
  if (whole != nullptr && !whole->is_sorted_by_option &&
      !has_finding(inspection, {"pairs", "counter-overflow", "rounded-stamps"})) {
    order(log, inspection);
  }
  bursts(log, inspection);
  time_unit(log, whole != nullptr, inspection);
}

}  // namespace gazetrace
