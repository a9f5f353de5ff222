// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_measure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "core/nan.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_event_durations.hpp"
#include "gazetrace/gaze_trials.hpp"
#include "measure/measurements_json.hpp"

namespace gazetrace {
namespace {

EyeEvents events_by(const GazeLog& log, const GazeMeasureSettings& settings) {
  if (settings.method == "log") {
    return events_of_log(log);
  }
  const EventPreset& preset =
      settings.method == "auto" ? default_event_preset(log, settings.device) : event_preset(settings.method);
  return detect_events(log, preset, settings.device);
}

// Of one eye, or of the gaze: its place in the unit of the plane, and its pupil. NaN: not known.
struct Traces {
  std::string name;  // "", "left_", "right_"
  std::vector<double> x, y, pupil;
};

std::vector<Traces> traces_of(const GazeLog& log, const GazePlane& plane) {
  const auto add = [&](Traces& traces, bool is_known, const Vec2d& at, float pupil) {
    traces.x.push_back(is_known ? at.x : kNan);
    traces.y.push_back(is_known ? at.y : kNan);
    traces.pupil.push_back(pupil > 0 ? static_cast<double>(pupil) : kNan);
  };
  if (!has_both_eyes(log)) {
    Traces gaze;
    for (const GazeSample& sample : log.samples) {
      add(gaze, is_usable(sample.validity), plane.of(sample), sample.pupil);
    }
    return {std::move(gaze)};
  }
  std::vector<Traces> eyes{{"left_", {}, {}, {}}, {"right_", {}, {}, {}}};
  for (const BothEyes& pair : log.eyes) {
    add(eyes[0], is_usable(pair.left.validity), plane.at(pair.left.at), pair.left.pupil);
    add(eyes[1], is_usable(pair.right.validity), plane.at(pair.right.at), pair.right.pupil);
  }
  return eyes;
}

std::string cell(double value) {
  return std::isnan(value) ? "n/a" : fmt::format("{:.5g}", value);
}

std::string samples_table(const GazeLog& log, const std::vector<Traces>& traces) {
  std::string table = "t_ns";
  for (const Traces& eye : traces) {
    fmt::format_to(std::back_inserter(table), "\t{0}x\t{0}y\t{0}pupil", eye.name);
  }
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    fmt::format_to(std::back_inserter(table), "\n{}", log.samples[i].t_ns);
    for (const Traces& eye : traces) {
      fmt::format_to(std::back_inserter(table), "\t{}\t{}\t{}", cell(eye.x[i]), cell(eye.y[i]), cell(eye.pupil[i]));
    }
  }
  return table + "\n";
}

std::string vergence_table(const GazeLog& log, const GazePlane& plane, const std::vector<Traces>& eyes,
                           const VergenceOverTime& vergence) {
  const bool is_angle = plane.unit() == "deg";
  std::string table =
      fmt::format("t_ns\thorizontal_{0}\tvertical_{0}\tvergence_deg\tdistance_mm\n", is_angle ? "deg" : "share_or_px");
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const Vergence at = vergence.samples.empty() ? Vergence{kNan, kNan, kNan} : vergence.samples[i];
    fmt::format_to(std::back_inserter(table), "{}\t{}\t{}\t{}\t{}\n", log.samples[i].t_ns,
                   cell(eyes[0].x[i] - eyes[1].x[i]), cell(eyes[0].y[i] - eyes[1].y[i]), cell(at.horizontal_deg),
                   cell(at.distance_mm));
  }
  return table;
}

// None where the log does not divide.
std::vector<GazeTrial> trials_of(const GazeLog& log) {
  if (log.trial) {
    return {};
  }
  try {
    return find_trials(log);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

std::vector<double> durations_ms(const GazeLog& log, const EyeEvents& events, EyeMovement movement) {
  const std::int64_t step_ns = event_step_ns(log);
  std::vector<double> values;
  for (const EyeEvent& event : events.events) {
    if (event.movement == movement) {
      values.push_back(static_cast<double>(event_duration_ns(event, step_ns)) * 1e-6);
    }
  }
  return values;
}

std::vector<double> amplitudes_deg(const EyeEvents& events, EyeMovement movement) {
  std::vector<double> values;
  for (const EyeEvent& event : events.events) {
    if (event.movement == movement && std::isfinite(event.amplitude_deg)) {
      values.push_back(event.amplitude_deg);
    }
  }
  return values;
}

GazeMeasurements measure_gaze(const GazeLog& recorded, const GazeMeasureSettings& settings) {
  if (recorded.samples.empty()) {
    throw Error(ErrorKind::input, recorded.source, "has no samples to report on");
  }
  GazeMeasurements measured;
  measured.warnings = recorded.warnings;
  std::optional<ProcessedGaze> processed;
  if (!settings.steps.empty()) {
    processed = process_gaze(recorded, settings.steps);
    measured.warnings.insert(measured.warnings.end(), processed->reports.begin(), processed->reports.end());
  }
  const GazeLog& log = processed ? processed->log : recorded;
  measured.vergence = measure_vergence(log, {settings.pupil_distance_mm});
  if (has_both_eyes(recorded) && !has_both_eyes(log)) {
    measured.vergence.missing = "processing makes one gaze of both eyes: leave it out for the vergence";
  }
  measured.events = events_by(log, settings);
  if (settings.method != "log") {
    for (std::string& doubt : doubts_in_words(doubt_events(log, measured.events), measured.events, log)) {
      measured.warnings.push_back(std::move(doubt));
    }
  }
  measured.main_sequence = fit_main_sequence(measured.events.events);
  measured.trials = trials_of(log);
  for (GazeTrial& trial : measured.trials) {
    trial.name = settings.keep_ids ? trial.name : "";
  }
  measured.quality.push_back(measure_quality(recorded));
  const GazePlane plane(log, std::nullopt);
  const std::vector<Traces> traces = traces_of(log, plane);
  measured.tables.push_back({"events.tsv", events_as_tsv(measured.events, log)});
  measured.tables.push_back({"samples.tsv", samples_table(log, traces)});
  if (has_both_eyes(log)) {
    for (const Eye eye : {Eye::left, Eye::right}) {
      measured.quality.push_back(measure_quality(recorded, eye));
      const GazeLog alone = one_eye(log, eye);
      measured.tables.push_back({eye == Eye::left ? "events_left.tsv" : "events_right.tsv",
                                 events_as_tsv(events_by(alone, settings), alone)});
    }
    measured.tables.push_back({"vergence.tsv", vergence_table(log, plane, traces, measured.vergence)});
  }
  measured.json = measurements_json(log, measured);
  return measured;
}

}  // namespace gazetrace
