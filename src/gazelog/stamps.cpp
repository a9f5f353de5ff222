// SPDX-License-Identifier: Apache-2.0
#include "gazelog/stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

// A step back in time: the index of the row behind it.
struct BackwardStep {
  std::size_t row;
  std::int64_t before_ns, after_ns;
};

struct Stamps {
  double step_ns = 0;  // median of those that grow
  std::vector<BackwardStep> backward;
  std::size_t pairs = 0;    // rows that repeat the time of the row before, of the same eye, at another place
  std::size_t triples = 0;  // those of them whose row before does so, too
};

Stamps look_at(const RawRows& rows) {
  constexpr std::size_t kMostSteps = 5000;
  Stamps stamps;
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::int64_t before_ns = rows.t_ns(i - 1);
    const std::int64_t t_ns = rows.t_ns(i);
    if (t_ns < before_ns) {
      stamps.backward.push_back({i, before_ns, t_ns});
    } else if (t_ns == before_ns) {
      const bool repeats = rows.eye(i) == rows.eye(i - 1) && !is_same_place(rows.at(i), rows.at(i - 1));
      stamps.pairs += repeats ? 1 : 0;
      stamps.triples += repeats && i > 1 && rows.t_ns(i - 2) == t_ns ? 1 : 0;
    } else if (steps.size() < kMostSteps) {
      steps.push_back(static_cast<double>(t_ns) - static_cast<double>(before_ns));
    }
  }
  stamps.step_ns = steps.empty() ? 0 : lower_quantile(steps, 0.5);
  return stamps;
}

// 2^16 or 2^32 of the unit in which the file counts, where a step back is that; else 0.
std::int64_t overflow_ns(const RawGaze& raw, const Stamps& stamps, const BackwardStep& step) {
  std::int64_t unit_ns = 1;
  for (int i = 0; i < raw.declared.time_exponent.value; ++i) {
    unit_ns *= 10;
  }
  for (const int bits : {16, 32}) {
    const double whole_ns = std::ldexp(static_cast<double>(unit_ns), bits);
    const double on_ns = whole_ns - (static_cast<double>(step.before_ns) - static_cast<double>(step.after_ns));
    if (whole_ns > 100 * stamps.step_ns && on_ns >= 0 && on_ns <= 10 * stamps.step_ns) {
      return static_cast<std::int64_t>(whole_ns);
    }
  }
  return 0;
}

void add_fault(RawGaze& raw, const std::string& code, std::size_t row, const std::string& problem,
               const std::string& setting) {
  raw.faults.push_back({code, fmt::format("{}:{}", raw.source, raw.rows[row].row), problem, "give " + setting, setting,
                        fmt::format("line {}: {}", raw.rows[row].row, problem)});
}

// Whether rows from `step` on continue elsewhere in time, or were written twice: then they are out of order, and the
// clock did not start anew.
bool belongs_elsewhere(const RawRows& rows, const std::vector<BackwardStep>& steps, std::size_t step) {
  constexpr std::int64_t kNearNs = 1'000'000'000;
  const auto end_of = [&](std::size_t s) { return s + 1 < steps.size() ? steps[s + 1].row : rows.size(); };
  const std::int64_t first_ns = steps[step].after_ns;
  const std::int64_t last_ns = rows.t_ns(end_of(step) - 1);
  std::size_t begin = 0;
  for (std::size_t part = 0; part <= step; ++part) {
    const std::size_t end = steps[part].row;
    const std::int64_t part_first_ns = rows.t_ns(begin);
    const std::int64_t part_last_ns = rows.t_ns(end - 1);
    const bool overlaps = first_ns <= part_last_ns && last_ns >= part_first_ns;
    if (!overlaps && (std::abs(part_first_ns - last_ns) < kNearNs || std::abs(first_ns - part_last_ns) < kNearNs)) {
      return true;
    }
    for (std::size_t i = begin; overlaps && i < end; ++i) {
      if (rows.t_ns(i) == first_ns && is_same_place(rows.at(i), rows.at(steps[step].row))) {
        return true;
      }
    }
    begin = end;
  }
  return false;
}

// Whether the rows above a step back fill the time that the rows below it go through again: a clock that was set back.
bool overlaps_without_a_gap(const RawRows& rows, const BackwardStep& step, double step_ns) {
  constexpr double kFewestSteps = 8;
  const double steps = static_cast<double>(step.before_ns - step.after_ns) / std::max(step_ns, 1.0);
  std::size_t first = step.row;
  while (first > 0 && rows.t_ns(first - 1) > step.after_ns) {
    --first;
  }
  std::size_t end = step.row;
  while (end < rows.size() && rows.t_ns(end) < step.before_ns) {
    ++end;
  }
  const auto is_full = [&](std::size_t count) { return static_cast<double>(count) > 0.8 * steps; };
  return steps >= kFewestSteps && is_full(step.row - first) && is_full(end - step.row);
}

void divide_at_restarts(RawGaze& raw, const Stamps& stamps) {
  constexpr std::int64_t kLeastBackNs = 1'000'000'000;  // or less, where the rows before it leave no room
  constexpr std::size_t kRowsOfPart = 100;
  const std::vector<BackwardStep>& steps = stamps.backward;
  if (steps.empty() || steps.size() > std::max<std::size_t>(1, raw.rows.size() / kRowsOfPart) ||
      !raw.recordings.empty()) {
    return;
  }
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const bool is_far = steps[s].before_ns - steps[s].after_ns >= kLeastBackNs ||
                        overlaps_without_a_gap(raw.rows, steps[s], stamps.step_ns);
    if (!is_far || belongs_elsewhere(raw.rows, steps, s)) {
      return;
    }
  }
  raw.clock_restarts_row = raw.rows[steps.front().row].row;
  begin_recording(raw, "1", raw.rows[0].row);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    begin_recording(raw, std::to_string(s + 2), raw.rows[steps[s].row].row);
  }
}

// A difference of integers: nanoseconds from 1970 do not fit into a double. A log is shorter than int64 counts.
std::int64_t step_ns(const GazeLog& log, std::size_t sample) {
  return log.samples[sample].t_ns - log.samples[sample - 1].t_ns;
}

}  // namespace

bool is_same_place(const Vec3d& a, const Vec3d& b) {
  return same_or_unknown(a.x, b.x) && same_or_unknown(a.y, b.y) && same_or_unknown(a.z, b.z);
}

std::string unordered_problem(const GazeOrder& order) {
  return fmt::format("time {} ns is before that of line {} ({} ns)", order.first_backward_ns, order.row_before,
                     order.before_ns);
}

std::string duplicate_problem(const GazeOrder& order) {
  return fmt::format("time {} ns repeats that of line {}", order.first_duplicate_ns, order.row_repeated);
}

bool loses_much(const GazeOrder& order) {
  constexpr double kFewPerCent = 0.03;
  const std::size_t lost = order.duplicates - order.identical_duplicates;
  return static_cast<double>(lost) > kFewPerCent * static_cast<double>(order.rows);
}

std::vector<std::size_t> rows_by_time(const RawRows& rows, UnorderedPolicy policy, GazeLog& log) {
  GazeOrder& order = log.order;
  order.rows = rows.size();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::int64_t before_ns = rows.t_ns(i - 1);
    const std::int64_t t_ns = rows.t_ns(i);
    if (t_ns >= before_ns) {
      continue;
    }
    if (order.backward_steps++ == 0) {
      order.first_backward_row = rows[i].row;
      order.first_backward_ns = t_ns;
      order.row_before = rows[i - 1].row;
      order.before_ns = before_ns;
    }
    std::int64_t back_ns = 0;
    if (__builtin_sub_overflow(before_ns, t_ns, &back_ns)) {
      back_ns = std::numeric_limits<std::int64_t>::max();
    }
    order.longest_backward_ns = std::max(order.longest_backward_ns, back_ns);
  }
  std::vector<std::size_t> by_time;
  if (order.backward_steps > 0) {
    if (policy == UnorderedPolicy::error) {
      throw Error(ErrorKind::input, fmt::format("{}:{}", log.source, order.first_backward_row),
                  unordered_problem(order), "sort the log, or use `order` sort");
    }
    by_time.resize(rows.size());
    std::iota(by_time.begin(), by_time.end(), std::size_t{0});
    std::stable_sort(by_time.begin(), by_time.end(),
                     [&](std::size_t a, std::size_t b) { return rows.t_ns(a) < rows.t_ns(b); });
    log.warnings.push_back(fmt::format("{}: sorted by time; {} {} backwards", log.source, order.backward_steps,
                                       order.backward_steps == 1 ? "step went" : "steps went"));
  }
  return by_time;
}

void refuse_duplicates(UnorderedPolicy policy, GazeLog& log) {
  const GazeOrder& order = log.order;
  if (order.duplicates == 0) {
    return;
  }
  if (policy == UnorderedPolicy::error) {
    const std::size_t kept = order.rows - order.duplicates;
    throw Error(ErrorKind::input, fmt::format("{}:{}", log.source, order.first_duplicate_row), duplicate_problem(order),
                loses_much(order) ? fmt::format("dropping repeats would keep only {} of {} rows: export again with "
                                                "stamps that differ, or look at it with 'gazetrace gaze inspect'",
                                                kept, order.rows)
                                  : fmt::format("remove one of them, or use `order` sort, which keeps the last "
                                                "of equal stamps, {} of {} rows",
                                                kept, order.rows));
  }
  log.warnings.push_back(fmt::format("{}: {} {} dropped: the last row of equal times is kept", log.source,
                                     order.duplicates, order.duplicates == 1 ? "duplicate was" : "duplicates were"));
}

std::string words_of_restart(const RawGaze& raw) {
  return raw.clock_restarts_row == 0
             ? ""
             : fmt::format("the clock starts again in line {}, or was set back: ", raw.clock_restarts_row);
}

void mend_stamps(RawGaze& raw, UnorderedPolicy policy) {
  if (raw.rows.size() < 2) {
    return;
  }
  const Stamps stamps = look_at(raw.rows);
  if (stamps.triples * 5 > raw.rows.size()) {
    const std::string problem = fmt::format(
        "{} of {} rows repeat the time of the row before at another place: the stamps were rounded, as a "
        "spreadsheet shows long numbers (1.70112E+12)",
        stamps.pairs, raw.rows.size());
    raw.faults.push_back({"rounded-stamps", fmt::format("{}:{}", raw.source, raw.rows[1].row), problem,
                          "take the stamps from the original file, with all their digits", "", problem});
    return;
  }
  if (stamps.pairs * 20 > raw.rows.size() * 9) {
    if (policy != UnorderedPolicy::pairs) {
      add_fault(raw, "pairs", 1, "every time stands twice, at different places: the stamps are too coarse for the rate",
                "`order` pairs");
    } else {
      const auto half_ns = static_cast<std::int64_t>(stamps.step_ns / 2);
      bool is_second = false;
      raw.rows.change_each([&](std::size_t i, RawSample row) {
        is_second = i > 0 && !is_second && row.t_ns == raw.rows.t_ns(i - 1);
        row.t_ns += is_second ? half_ns : 0;
        return row;
      });
    }
    return;
  }
  if (!stamps.backward.empty() && overflow_ns(raw, stamps, stamps.backward.front()) > 0) {
    if (policy != UnorderedPolicy::unwrap) {
      add_fault(raw, "counter-overflow", stamps.backward.front().row,
                fmt::format("the counter of the clock overflowed: {} ns is followed by {} ns",
                            stamps.backward.front().before_ns, stamps.backward.front().after_ns),
                "`order` unwrap");
    } else {
      auto step = stamps.backward.begin();
      std::int64_t added_ns = 0;
      raw.rows.change_each([&](std::size_t i, RawSample row) {
        if (step != stamps.backward.end() && step->row == i) {
          added_ns += overflow_ns(raw, stamps, *step);
          ++step;
        }
        row.t_ns += added_ns;
        return row;
      });
    }
    return;
  }
  if (policy != UnorderedPolicy::sort) {
    divide_at_restarts(raw, stamps);
  }
}

void align_origins(GazeLog& log) {
  if (log.origins.empty()) {
    return;
  }
  constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
  std::vector<EyeOrigins> by_time = std::move(log.origins);
  std::stable_sort(by_time.begin(), by_time.end(),
                   [](const EyeOrigins& a, const EyeOrigins& b) { return a.t_ns < b.t_ns; });
  log.origins.clear();
  log.origins.reserve(log.samples.size());
  auto at = by_time.begin();
  for (const GazeSample& sample : log.samples) {
    EyeOrigins joined{{kNanF, kNanF, kNanF}, {kNanF, kNanF, kNanF}, sample.t_ns};
    for (; at != by_time.end() && at->t_ns <= sample.t_ns; ++at) {
      if (at->t_ns == sample.t_ns) {
        joined.left_mm = std::isnan(at->left_mm.x) ? joined.left_mm : at->left_mm;
        joined.right_mm = std::isnan(at->right_mm.x) ? joined.right_mm : at->right_mm;
      }
    }
    log.origins.push_back(joined);
  }
}

std::vector<std::size_t> section_starts(const GazeLog& log) {
  std::vector<std::size_t> starts{0};
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::segment) {
      continue;
    }
    const auto first = std::lower_bound(log.samples.begin(), log.samples.end(), event.begin_ns,
                                        [](const GazeSample& sample, std::int64_t t) { return sample.t_ns < t; });
    if (first != log.samples.end()) {
      starts.push_back(static_cast<std::size_t>(first - log.samples.begin()));
    }
  }
  std::sort(starts.begin(), starts.end());
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  return starts;
}

GazeTiming measure_timing(const GazeLog& log) {
  GazeTiming timing;
  timing.first_ns = log.samples.front().t_ns;
  timing.last_ns = log.samples.back().t_ns;
  timing.nominal_rate_hz = log.nominal_rate_hz;
  std::vector<double> steps;
  steps.reserve(log.samples.size());
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    steps.push_back(static_cast<double>(step_ns(log, i)));
  }
  if (steps.empty()) {
    return timing;
  }
  const double median = lower_quantile(steps, 0.5);
  timing.step_q1_ns = lower_quantile(steps, 0.25);
  timing.step_q3_ns = lower_quantile(steps, 0.75);
  timing.median_rate_hz = median > 0 ? 1e9 / median : 0;
  RunningSpread between_gaps;
  for (const double step : steps) {
    if (!(step > kGapInSteps * median)) {
      between_gaps.add(step);
    }
  }
  const std::vector<std::size_t> starts = section_starts(log);
  auto start = starts.begin();
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    while (start != starts.end() && *start < i) {
      ++start;
    }
    const std::int64_t step = step_ns(log, i);
    if (!(static_cast<double>(step) > kGapInSteps * median)) {
      continue;
    }
    const bool is_pause = start != starts.end() && *start == i;
    ++(is_pause ? timing.pauses : timing.gaps);
    std::int64_t& total_ns = is_pause ? timing.pauses_total_ns : timing.gaps_total_ns;
    total_ns += step;
    timing.longest_gap_ns = is_pause ? timing.longest_gap_ns : std::max(timing.longest_gap_ns, step);
  }
  timing.mean_rate_hz = between_gaps.mean() > 0 ? 1e9 / between_gaps.mean() : 0;
  timing.jitter_ns = between_gaps.deviation();
  return timing;
}

}  // namespace gazetrace
