// SPDX-License-Identifier: Apache-2.0
#include "sweep/tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sweep/quality_over_time.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFovVideoVdp = "fovvideovdp";

bool needs_gaze(const std::string& metric) {
  const std::vector<MetricInfo> known = comparison_metrics();
  return std::any_of(known.begin(), known.end(),
                     [&](const MetricInfo& info) { return info.name == metric && info.needs_gaze; });
}

std::vector<double> times_of(const SweepRow& row) {
  std::vector<double> times;
  for (const SweepRun& run : row.runs) {
    times.push_back(run.time_s);
  }
  return times;
}

// With what the first repeat's pictures took.
std::optional<std::vector<double>> times_with_output(const SweepRow& row) {
  if (row.runs.empty() || !row.runs.front().output_s) {
    return std::nullopt;
  }
  std::vector<double> times = times_of(row);
  for (double& time_s : times) {
    time_s += *row.runs.front().output_s;
  }
  return times;
}

const SweepRow* row_by_id(const std::vector<SweepRow>& rows, const std::string& id) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const SweepRow& row) { return row.id == id; });
  return found == rows.end() ? nullptr : &*found;
}

std::string reference_rate_of(const SweepRow& row, const std::vector<SweepRow>& rows) {
  for (const SweepRow& other : rows) {
    if (other.role == SweepRole::uniform_reference_rate && other.scene == row.scene && other.gaze == row.gaze &&
        other.curve == row.curve && other.reference == row.reference) {
      return other.id;
    }
  }
  return {};
}

void add_ratios(std::vector<SweepRow>& rows) {
  for (SweepRow& row : rows) {
    if (const SweepRow* uniform = row_by_id(rows, reference_rate_of(row, rows))) {
      row.speed_up = ratio_interval(times_of(*uniform), times_of(row));
      const auto whole_uniform = times_with_output(*uniform);
      const auto whole = times_with_output(row);
      if (whole_uniform && whole) {
        row.end_to_end = ratio_interval(*whole_uniform, *whole).mean;
      }
    }
    if (row.role == SweepRole::equal_time) {
      if (const SweepRow* test = row_by_id(rows, row.of)) {
        row.reached = ratio_interval(times_of(row), times_of(*test));
      }
    }
  }
}

std::vector<double> parts_by_run(const SweepRow& row, const std::string& metric, const std::string& part) {
  std::vector<double> values;
  for (const SweepRun& run : row.runs) {
    const auto parts = run.scores.find(metric);
    if (parts != run.scores.end() && parts->second.contains(part)) {
      values.push_back(parts->second.at(part));
    }
  }
  return values;
}

// Repeats of the right and the wrong gaze share their seeds, so the differences are taken pair by pair.
SweepControl control_of(const SweepRow& right, const SweepRow& wrong, const std::string& metric,
                        const std::string& part) {
  const std::vector<double> a = parts_by_run(right, metric, part);
  const std::vector<double> b = parts_by_run(wrong, metric, part);
  SweepControl control;
  control.scene = right.scene;
  control.gaze = right.gaze;
  control.metric = part == "whole" ? metric : metric + " " + part;
  control.wrong = wrong.wrong;
  control.of = right.id;
  control.right = mean_interval(a);
  control.wrong_score = mean_interval(b);
  const double sign = direction_of(metric) == MetricDirection::lower ? 1 : -1;
  std::vector<double> losses;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    losses.push_back(sign * (b[i] - a[i]));
  }
  const Interval loss = mean_interval(losses);
  if (!loss.low) {
    control.why = "one repeat tells nothing of its spread";
  } else if (*loss.low > 0) {
    control.sensitive = true;
  } else {
    control.why = "the wrong gaze does not score worse: no claim from this metric here";
  }
  return control;
}

void add_controls(const std::vector<std::string>& metrics, SweepResults& results) {
  for (const SweepRow& wrong : results.rows) {
    const SweepRow* right = wrong.role == SweepRole::wrong_gaze ? row_by_id(results.rows, wrong.of) : nullptr;
    if (right == nullptr) {
      continue;
    }
    // Others know nothing of the gaze but by their weighting.
    for (const std::string& metric : metrics) {
      const std::string part = needs_gaze(metric) ? "whole" : "weighted";
      if (!parts_by_run(*right, metric, part).empty()) {
        results.controls.push_back(control_of(*right, wrong, metric, part));
      }
    }
  }
}

void add_notes(const SweepPlan& plan, SweepResults& results) {
  double lost = 0;
  for (const SweepRow& row : results.rows) {
    for (const SweepRun& run : row.runs) {
      lost += run.lost_samples;
    }
  }
  if (lost > 0) {
    results.notes.push_back(fmt::format("{:.0f} samples were rejected or not finite; they count as black", lost));
  }
  if (plan.measure.repeats == 1) {
    results.notes.emplace_back("one repeat: there are no confidence intervals");
  }
  const auto& metrics = plan.measure.comparison.metrics;
  if (std::find(metrics.begin(), metrics.end(), kFovVideoVdp) != metrics.end()) {
    results.notes.emplace_back(
        "FovVideoVDP does not see uniform differences; its scores at different gaze positions do not compare");
  }
  for (const std::string& range : flicker_ranges(plan)) {
    results.notes.push_back(range + "; blind to bias, which temporal_bias tells");
  }
  if (plan.measure.leave_out_s > 0) {
    results.notes.push_back(
        fmt::format("the first {:g} s of each clip are seen by the metrics, but not scored", plan.measure.leave_out_s));
  }
}

}  // namespace

double mean_of_runs(const SweepRow& row, double SweepRun::*member) {
  double sum = 0;
  for (const SweepRun& run : row.runs) {
    sum += run.*member / static_cast<double>(row.runs.size());
  }
  return sum;
}

std::map<std::string, std::map<std::string, SweepScore>> row_scores(const std::vector<SweepRun>& runs,
                                                                    const ScoreTable& floor) {
  std::map<std::string, std::map<std::string, std::vector<double>>> values;
  for (const SweepRun& run : runs) {
    for (const auto& [metric, parts] : run.scores) {
      for (const auto& [part, value] : parts) {
        values[metric][part].push_back(value);
      }
    }
  }
  std::map<std::string, std::map<std::string, SweepScore>> scores;
  for (const auto& [metric, parts] : values) {
    for (const auto& [part, raw] : parts) {
      SweepScore& score = scores[metric][part];
      const auto of_metric = floor.find(metric);
      if (of_metric == floor.end() || !of_metric->second.contains(part)) {
        score.value = mean_interval(raw);
        score.resolved = false;
        continue;
      }
      const double least = of_metric->second.at(part);
      std::vector<double> corrected;
      for (const double value : raw) {
        corrected.push_back(without_reference_variance(metric, value, least));
      }
      score.value = mean_interval(corrected);
      score.resolved = !is_better(metric, mean_interval(raw).mean, least);
    }
  }
  return scores;
}

void complete_tables(const SweepPlan& plan, SweepResults& results) {
  for (SweepRow& row : results.rows) {
    row.time_s = geometric_interval(times_of(row));
    for (const SweepReferenceResult& reference : results.references) {
      for (const SweepFloor& floor : reference.floors) {
        if (reference.key == row.reference && floor.gaze == row.gaze) {
          row.scores = row_scores(row.runs, floor.scores);
        }
      }
    }
  }
  for (const SweepReferenceResult& reference : results.references) {
    for (const SweepFloor& floor : reference.floors) {
      if (!floor.event_shares.contains("fixation") && !floor.event_shares.empty()) {
        results.notes.push_back(
            fmt::format("gaze {}: no frame is known to be of a fixation; all that have gaze are scored", floor.gaze));
      }
    }
  }
  add_ratios(results.rows);
  results.pareto = pareto_fronts(plan.measure.comparison.metrics, results.rows);
  results.fixed_quality = speed_ups_at_quality(plan.measure, results);
  add_controls(plan.measure.comparison.metrics, results);
  add_notes(plan, results);
  std::vector<std::string> notes;
  for (const std::string& note : results.notes) {
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) {
      notes.push_back(note);
    }
  }
  results.notes = std::move(notes);
}

}  // namespace gazetrace
