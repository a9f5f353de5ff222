// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/nan.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_event_durations.hpp"
#include "study/report/drawing.hpp"
#include "study/report/page.hpp"

namespace gazetrace {
namespace {

EyeEvents events_by(const GazeLog& log, const GazeReportSettings& settings) {
  if (settings.method == "log") {
    return events_of_log(log);
  }
  const EventPreset& preset =
      settings.method == "auto" ? default_event_preset(log, settings.device) : event_preset(settings.method);
  return detect_events(log, preset, settings.device);
}

// Places in the unit of the plane, and pupils, of the gaze and of each eye.
struct Traces {
  std::vector<double> seconds;
  std::vector<GazeTrace> x, y, pupil, disparity, vergence;
};

Traces traces_of(const GazeLog& log, const GazePlane& plane, const VergenceOverTime& vergence) {
  Traces traces;
  const bool both = has_both_eyes(log);
  const std::size_t count = log.samples.size();
  const auto list = [&](std::vector<GazeTrace>& to, const std::string& name, const char* color) {
    to.push_back({name, color, std::vector<double>(count, kNan)});
  };
  for (std::vector<GazeTrace>* const to : {&traces.x, &traces.y, &traces.pupil}) {
    if (both) {
      list(*to, "left eye", kLeftColor);
      list(*to, "right eye", kRightColor);
    } else {
      list(*to, "gaze", kTraceColor);
    }
  }
  list(traces.disparity, "horizontal", kTraceColor);
  list(traces.disparity, "vertical", "#009e73");
  list(traces.vergence, "vergence", kTraceColor);
  for (std::size_t i = 0; i < vergence.samples.size(); ++i) {
    traces.vergence[0].values[i] = vergence.samples[i].horizontal_deg;
  }
  const auto pupil = [](float size) { return size > 0 ? static_cast<double>(size) : kNan; };
  for (std::size_t i = 0; i < count; ++i) {
    const GazeSample& sample = log.samples[i];
    traces.seconds.push_back(static_cast<double>(sample.t_ns - log.samples.front().t_ns) * 1e-9);
    if (!both) {
      const Vec2d at = is_usable(sample.validity) ? plane.of(sample) : Vec2d{kNan, kNan};
      traces.x[0].values[i] = at.x;
      traces.y[0].values[i] = at.y;
      traces.pupil[0].values[i] = pupil(sample.pupil);
      continue;
    }
    const EyeGaze* const eyes[] = {&log.eyes[i].left, &log.eyes[i].right};
    for (std::size_t e = 0; e < 2; ++e) {
      const Vec2d at = is_usable(eyes[e]->validity) ? plane.at(eyes[e]->at) : Vec2d{kNan, kNan};
      traces.x[e].values[i] = at.x;
      traces.y[e].values[i] = at.y;
      traces.pupil[e].values[i] = pupil(eyes[e]->pupil);
    }
    traces.disparity[0].values[i] = traces.x[0].values[i] - traces.x[1].values[i];
    traces.disparity[1].values[i] = traces.y[0].values[i] - traces.y[1].values[i];
  }
  return traces;
}

std::string cell(double value) {
  return std::isnan(value) ? "n/a" : fmt::format("{:.5g}", value);
}

std::string vergence_table(const GazeLog& log, const GazePlane& plane, const Traces& traces,
                           const VergenceOverTime& vergence) {
  const bool is_angle = plane.unit() == "deg";
  std::string table =
      fmt::format("t_ns\thorizontal_{0}\tvertical_{0}\tvergence_deg\tdistance_mm\n", is_angle ? "deg" : "share_or_px");
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const Vergence at = vergence.samples.empty() ? Vergence{kNan, kNan, kNan} : vergence.samples[i];
    fmt::format_to(std::back_inserter(table), "{}\t{}\t{}\t{}\t{}\n", log.samples[i].t_ns,
                   cell(traces.disparity[0].values[i]), cell(traces.disparity[1].values[i]), cell(at.horizontal_deg),
                   cell(at.distance_mm));
  }
  return table;
}

std::string how_vergence(const VergenceOverTime& vergence) {
  return vergence.pupil_distance_mm == 0 ? "of the directions of the eyes"
                                         : fmt::format("pupils {:.1f} mm apart, {}", vergence.pupil_distance_mm,
                                                       vergence.is_distance_stated ? "as stated" : "by the log");
}

void add_time_plots(const GazeLog& log, const GazePlane& plane, GazeReport& report) {
  const Traces traces = traces_of(log, plane, report.vergence);
  const auto add = [&](const char* name, const std::string& title, const std::string& label,
                       const std::vector<GazeTrace>& lines) {
    if (auto plot = trace_plot(name, title, label, traces.seconds, lines)) {
      report.plots.push_back(std::move(*plot));
    }
  };
  add("x_over_time", "Horizontal position", fmt::format("x [{}], right", plane.unit()), traces.x);
  add("y_over_time", "Vertical position", fmt::format("y [{}], up", plane.unit()), traces.y);
  if (has_both_eyes(log)) {
    add("disparity_over_time", "Disparity: place of the left eye less that of the right",
        fmt::format("disparity [{}]", plane.unit()), traces.disparity);
    if (!report.vergence.missing.empty() && report.plots.back().name == "disparity_over_time") {
      std::string& note = report.plots.back().note = "No vergence: " + report.vergence.missing;
      std::erase(note, '`');
    }
    add("vergence_over_time", "Vergence: angle between the lines of sight", "vergence [deg]", traces.vergence);
    if (!report.vergence.samples.empty() && report.plots.back().name == "vergence_over_time") {
      report.plots.back().note = how_vergence(report.vergence);
    }
  }
  const std::string unit = log.pupil_unit.empty() ? "unit not stated" : log.pupil_unit;
  add("pupil_over_time", fmt::format("Pupil size [{}]", unit), fmt::format("pupil [{}]", unit), traces.pupil);
  if (has_both_eyes(log)) {
    report.tables.push_back({"vergence.tsv", vergence_table(log, plane, traces, report.vergence)});
  }
}

}  // namespace

std::size_t count_of(const EyeEvents& events, EyeMovement movement) {
  return static_cast<std::size_t>(std::count_if(events.events.begin(), events.events.end(),
                                                [&](const EyeEvent& e) { return e.movement == movement; }));
}

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

GazeReport gaze_report(const GazeLog& recorded, const GazeReportSettings& settings) {
  if (!(settings.heat_sigma_deg > 0) || settings.heat_sigma_deg > 45) {
    throw Error(ErrorKind::usage, "`heat-sigma`", "must be above 0 and at most 45 degrees");
  }
  if (recorded.samples.empty()) {
    throw Error(ErrorKind::input, recorded.source, "has no samples to report on");
  }
  const std::string picture = picture_uri(settings.picture);
  GazeReport report;
  report.warnings = recorded.warnings;
  std::optional<ProcessedGaze> processed;
  if (!settings.steps.empty()) {
    processed = process_gaze(recorded, settings.steps);
    report.warnings.insert(report.warnings.end(), processed->reports.begin(), processed->reports.end());
  }
  const GazeLog& log = processed ? processed->log : recorded;
  report.vergence = measure_vergence(log, {settings.pupil_distance_mm});
  if (has_both_eyes(recorded) && !has_both_eyes(log)) {
    report.vergence.missing = "processing makes one gaze of both eyes: leave it out for the vergence";
  }
  report.events = events_by(log, settings);
  if (settings.method != "log") {
    for (std::string& doubt : doubts_in_words(doubt_events(log, report.events), report.events, log)) {
      report.warnings.push_back(std::move(doubt));
    }
  }
  report.main_sequence = fit_main_sequence(report.events.events);
  report.quality.push_back(measure_quality(recorded));
  if (has_both_eyes(log)) {
    for (const Eye eye : {Eye::left, Eye::right}) {
      report.quality.push_back(measure_quality(recorded, eye));
      const GazeLog alone = one_eye(log, eye);
      report.tables.push_back({eye == Eye::left ? "events_left.tsv" : "events_right.tsv",
                               events_as_tsv(events_by(alone, settings), alone)});
    }
  }
  report.tables.push_back({"events.tsv", events_as_tsv(report.events, log)});
  const std::vector<EyeEvent>& events = report.events.events;
  report.plots.push_back(main_sequence_plot(events, report.main_sequence));
  report.plots.push_back(histogram_plot("fixation_durations", "Durations of fixations", "duration [ms]",
                                        durations_ms(log, report.events, EyeMovement::fixation), "#009e73"));
  report.plots.push_back(histogram_plot("saccade_amplitudes", "Amplitudes of saccades", "amplitude [deg]",
                                        amplitudes_deg(report.events, EyeMovement::saccade), kLeftColor));
  if (auto heat = heat_map_plot(log, events, picture, settings.heat_sigma_deg)) {
    report.plots.push_back(std::move(*heat));
  }
  report.plots.push_back(scanpath_plot(log, events, picture));
  add_time_plots(log, GazePlane(log, std::nullopt), report);
  report.json = gaze_report_json(log, report);
  report.html = gaze_page(log, report);
  return report;
}

}  // namespace gazetrace
