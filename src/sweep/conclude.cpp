// SPDX-License-Identifier: Apache-2.0
#include "sweep/conclude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "gazetrace/output.hpp"
#include "results/lookup.hpp"
#include "sweep/model_gain_of_test.hpp"
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

std::vector<double> times_of(const MeasuredRow& row) {
  std::vector<double> times;
  for (const SweepRun& run : row.runs) {
    times.push_back(run.time_s);
  }
  return times;
}

// The times of all repeats, each with the time that writing the pictures took in the first one.
std::optional<std::vector<double>> times_with_output(const MeasuredRow& row) {
  if (row.runs.empty() || !row.runs.front().output_s) {
    return std::nullopt;
  }
  std::vector<double> times = times_of(row);
  for (double& time_s : times) {
    time_s += *row.runs.front().output_s;
  }
  return times;
}

const MeasuredRow* row_by_id(const std::vector<MeasuredRow>& rows, const std::string& id) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const MeasuredRow& row) { return row.id == id; });
  return found == rows.end() ? nullptr : &*found;
}

const MeasuredRow* reference_rate_of(const MeasuredRow& row, const std::vector<MeasuredRow>& rows) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const MeasuredRow& other) {
    return other.role == RowRole::uniform_reference_rate && other.scene == row.scene && other.gaze == row.gaze &&
           other.curve == row.curve && other.reference == row.reference;
  });
  return found == rows.end() ? nullptr : &*found;
}

void add_ratios(std::vector<MeasuredRow>& rows) {
  for (MeasuredRow& row : rows) {
    if (const MeasuredRow* uniform = reference_rate_of(row, rows)) {
      const Interval speed_up = ratio_interval(times_of(*uniform), times_of(row));
      if (speed_up.mean > 0) {
        row.speed_up = speed_up;
      }
      const auto whole_uniform = times_with_output(*uniform);
      const auto whole = times_with_output(row);
      if (whole_uniform && whole) {
        row.end_to_end = ratio_interval(*whole_uniform, *whole).mean;
      }
    }
    if (row.role == RowRole::equal_time) {
      if (const MeasuredRow* test = row_by_id(rows, row.of)) {
        row.reached = ratio_interval(times_of(row), times_of(*test));
      }
    }
  }
}

std::vector<double> parts_by_run(const MeasuredRow& row, const std::string& metric, const std::string& part) {
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
ResultControl control_of(const MeasuredRow& right, const MeasuredRow& wrong, const std::string& metric,
                         const std::string& part) {
  const std::vector<double> a = parts_by_run(right, metric, part);
  const std::vector<double> b = parts_by_run(wrong, metric, part);
  ResultControl control;
  control.scene = right.scene;
  control.gaze = right.gaze;
  control.metric = part == "whole" ? metric : metric + " " + part;
  control.wrong = wrong.wrong;
  control.of = right.id;
  control.right_score = mean_interval(a).mean;
  control.wrong_score = mean_interval(b).mean;
  const double sign = direction_of(metric) == MetricDirection::lower ? 1 : -1;
  std::vector<double> losses;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    losses.push_back(sign * (b[i] - a[i]));
  }
  const Interval loss = mean_interval(losses);
  if (!loss.low) {
    control.why = "one repeat tells nothing of its spread";
  } else if (*loss.low > 0) {
    control.is_sensitive = true;
  } else {
    control.why = "the wrong gaze does not score worse: no claim from this metric here";
  }
  return control;
}

std::vector<ResultControl> controls_of(const std::vector<std::string>& metrics, const std::vector<MeasuredRow>& rows) {
  std::vector<ResultControl> controls;
  for (const MeasuredRow& wrong : rows) {
    const MeasuredRow* right = wrong.role == RowRole::wrong_gaze ? row_by_id(rows, wrong.of) : nullptr;
    if (right == nullptr) {
      continue;
    }
    // Metrics that do not take the gaze depend on it only through the weighting of their map.
    for (const std::string& metric : metrics) {
      const std::string part = needs_gaze(metric) ? "whole" : "weighted";
      if (!parts_by_run(*right, metric, part).empty()) {
        controls.push_back(control_of(*right, wrong, metric, part));
      }
    }
  }
  return controls;
}

// The notes of the measurements and what a reader of the tables must know, each of them once.
std::vector<std::string> notes_of(const SweepPlan& plan, const Measurements& measured) {
  std::vector<std::string> notes;
  const auto add = [&](const std::string& note) {
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) {
      notes.push_back(note);
    }
  };
  for (const std::string& note : measured.notes) {
    add(note);
  }
  for (const ResultReference& reference : measured.references) {
    for (const ResultFloor& floor : reference.floors) {
      if (!floor.event_shares.contains("fixation") && !floor.event_shares.empty()) {
        add(fmt::format("gaze {}: no frame is known to be of a fixation; all that have gaze are scored", floor.gaze));
      }
    }
  }
  double lost = 0;
  for (const MeasuredRow& row : measured.rows) {
    for (const SweepRun& run : row.runs) {
      lost += run.lost_samples;
    }
  }
  if (lost > 0) {
    add(fmt::format("{:.0f} samples were rejected or not finite; they count as black", lost));
  }
  if (measured.machines.size() > 1) {
    add(
        fmt::format("times were taken in {} tasks, which each row names: ratios of times of different tasks compare "
                    "their machines, too",
                    measured.machines.size()));
  }
  if (plan.measure.repeats == 1) {
    add("one repeat: there are no confidence intervals");
  }
  const auto& metrics = plan.measure.comparison.metrics;
  if (std::find(metrics.begin(), metrics.end(), kFovVideoVdp) != metrics.end()) {
    add("FovVideoVDP does not see uniform differences; its scores at different gaze positions do not compare");
  }
  for (const std::string& range : flicker_ranges(plan)) {
    add(range + "; blind to bias, which temporal_bias tells");
  }
  if (plan.measure.leave_out_s > 0) {
    add(fmt::format("the first {:g} s of each clip are seen by the metrics, but not scored", plan.measure.leave_out_s));
  }
  return notes;
}

double mean_of_runs(const MeasuredRow& row, double SweepRun::*member) {
  double sum = 0;
  for (const SweepRun& run : row.runs) {
    sum += run.*member / static_cast<double>(row.runs.size());
  }
  return sum;
}

// The time of a frame is the mean over the repeats; its scores and pictures are those of the first repeat. The map of
// FLIP lies in the same folder as the picture.
void complete_frame(const MeasuredRow& row, std::size_t index, ResultFrame& frame) {
  double time_s = 0;
  for (const SweepRun& run : row.runs) {
    time_s += run.frames.at(index).time_s / static_cast<double>(row.runs.size());
  }
  frame.time_s = time_s;
  const SweepRun& first = row.runs.front();
  for (const auto& [metric, parts] : first.frames.at(index).scores) {
    if (parts.contains("whole")) {
      frame.scores[metric] = parts.at("whole");
    }
  }
  if (!row.png.empty()) {
    frame.png = frame_file_name(row.png, frame.index);
  }
  const std::size_t folder = row.png.rfind('/');
  if (first.scores.contains("flip") && folder != std::string::npos) {
    frame.flip_png = frame_file_name(row.png.substr(0, folder) + "/flip.####.png", frame.index);
  }
}

// Fills in what follows from the runs of a row alone.
void complete_row(const std::vector<ResultReference>& references, MeasuredRow& row) {
  row.times_s = times_of(row);
  row.time_s = geometric_interval(row.times_s);
  for (const ResultReference& reference : references) {
    for (const ResultFloor& floor : reference.floors) {
      if (reference.key == row.reference && floor.gaze == row.gaze) {
        row.scores = row_scores(row.runs, floor.scores);
      }
    }
  }
  const double samples = mean_of_runs(row, &SweepRun::samples);
  row.samples = samples;
  row.spp_mean = samples / row.compared_pixels;
  row.rays = mean_of_runs(row, &SweepRun::rays);
  row.peak_mib = mean_of_runs(row, &SweepRun::peak_mib);
  if (row.runs.empty()) {
    row.frames.clear();
    return;
  }
  row.output_s = row.runs.front().output_s;
  for (std::size_t f = 0; f < row.frames.size(); ++f) {
    complete_frame(row, f, row.frames[f]);
  }
}

// What the references state about each gaze, where they agree, because clips of another length or size show other
// things.
template <class T>
std::map<std::string, T> agreed(const std::vector<ResultReference>& references, T ResultFloor::*member) {
  std::map<std::string, T> values;
  std::set<std::string> doubtful;
  for (const ResultReference& reference : references) {
    for (const ResultFloor& floor : reference.floors) {
      const auto [found, is_new] = values.emplace(floor.gaze, floor.*member);
      if (floor.*member != found->second || (floor.*member).empty()) {
        doubtful.insert(floor.gaze);
      }
    }
  }
  std::erase_if(values, [&](const auto& value) { return doubtful.contains(value.first); });
  return values;
}

}  // namespace

std::map<std::string, std::map<std::string, ResultScore>> row_scores(const std::vector<SweepRun>& runs,
                                                                     const ScoreTable& floor) {
  std::map<std::string, std::map<std::string, std::vector<double>>> values;
  for (const SweepRun& run : runs) {
    for (const auto& [metric, parts] : run.scores) {
      for (const auto& [part, value] : parts) {
        values[metric][part].push_back(value);
      }
    }
  }
  std::map<std::string, std::map<std::string, ResultScore>> scores;
  for (const auto& [metric, parts] : values) {
    for (const auto& [part, raw] : parts) {
      ResultScore& score = scores[metric][part];
      const auto interval = direction_of(metric) == MetricDirection::lower ? error_interval : mean_interval;
      const auto of_metric = floor.find(metric);
      if (of_metric == floor.end() || !of_metric->second.contains(part)) {
        score.value = interval(raw);
        score.is_resolved = false;
        continue;
      }
      const double least = of_metric->second.at(part);
      std::vector<double> corrected;
      for (const double value : raw) {
        corrected.push_back(without_reference_variance(metric, value, least));
      }
      score.value = interval(corrected);
      score.is_resolved = !is_better(metric, mean_interval(raw).mean, least);
    }
  }
  return scores;
}

ResultMachine machine_of_tasks(const std::map<std::string, std::string>& machines) {
  std::set<std::string> different;
  for (const auto& [task, machine] : machines) {
    different.insert(machine);
  }
  return {fmt::format("{}", fmt::join(different, "; ")), std::nullopt};
}

Results conclude(Results facts, const SweepPlan& plan, const Measurements& measured) {
  const std::vector<std::string>& metrics = plan.measure.comparison.metrics;
  std::vector<MeasuredRow> rows = measured.rows;
  for (MeasuredRow& row : rows) {
    complete_row(measured.references, row);
  }
  add_ratios(rows);
  Results results = std::move(facts);
  results.references = measured.references;
  results.band_pixel_share = agreed(measured.references, &ResultFloor::band_pixel_share);
  results.event_shares = agreed(measured.references, &ResultFloor::event_shares);
  results.pareto = pareto_fronts(metrics, rows);
  results.fixed_quality = speed_ups_at_quality(plan.measure, measured.references, rows);
  add_model_gains(plan, results.fixed_quality);
  results.controls = controls_of(metrics, rows);
  results.notes = notes_of(plan, measured);
  results.rows.assign(rows.begin(), rows.end());  // the runs themselves are left behind
  return results;
}

}  // namespace gazetrace
