// SPDX-License-Identifier: Apache-2.0
#include "gaze/inspect/inspect.hpp"

#include <algorithm>
#include <limits>

#include "core/enum_name.hpp"
#include "gazelog/log_file.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/stamps.hpp"

namespace gazetrace {
namespace {

void measure_ranges(const GazeLog& log, GazeInspection& report) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  report.range_x = report.range_y = {kFar, -kFar};
  for (const GazeSample& sample : log.samples) {
    if (!is_usable(sample.validity)) {
      continue;
    }
    const bool direction = log.kind == GazeKind::direction;
    const double x = direction ? sample.direction.x : sample.u;
    const double y = direction ? sample.direction.y : sample.v;
    report.range_x = {std::min(report.range_x[0], x), std::max(report.range_x[1], x)};
    report.range_y = {std::min(report.range_y[0], y), std::max(report.range_y[1], y)};
  }
}

GazeInspection inspect(const GazeLog& log, const GazeUnderInspection* whole, const GazeInspectOptions& options) {
  GazeInspection report;
  const auto shown = [&](const std::string& text) { return options.keep_ids ? text : without_dates(text); };
  report.source = log.source;
  report.format = log.format;
  report.clock = shown(log.clock);
  report.pupil_unit = log.pupil_unit;
  report.format_confidence = log.format_confidence;
  report.kind = log.kind;
  for (const GazeFact& fact : log.facts) {
    report.facts.push_back({fact.what, shown(fact.value), fact.evidence, shown(fact.detail)});
  }
  for (const std::string& warning : log.warnings) {
    report.warnings.push_back(shown(warning));
  }
  report.geometry = log.recording_geometry;
  report.calibrations = log.calibrations;
  report.recordings = log.recordings;
  report.recording = log.recording;
  for (GazeRecording& recording : report.recordings) {
    recording.name = options.keep_ids ? recording.name : "";
  }
  for (const GazeEvent& event : log.events) {
    ++report.events[static_cast<std::size_t>(event.type)];
  }
  report.head_poses = log.head.size();
  report.both_eyes = !log.eyes.empty();
  report.order = log.order;
  report.timing = measure_timing(log);
  report.span_ns = report.timing.last_ns - report.timing.first_ns;
  const double step_ns = report.timing.median_rate_hz > 0 ? 1e9 / report.timing.median_rate_hz : 0;
  report.loss = measure_loss(log, step_ns);
  report.frozen = measure_frozen(log);
  const GazePlane plane(log, options.display);
  report.unit = plane.unit();
  report.precision = measure_precision(log, plane, step_ns);
  report.disparity = measure_disparity(log, plane);
  measure_ranges(log, report);
  report.vor = test_vor(log);
  report.is_wall_clock = is_wall_clock(log);
  find_what_is_wrong(log, whole, options, report);
  if (report.is_wall_clock && !options.keep_ids) {
    report.timing.first_ns = report.timing.last_ns = 0;
    report.order.first_backward_ns = report.order.before_ns = report.order.first_duplicate_ns = 0;
    for (GazeFinding& finding : report.findings) {
      finding.what = without_stamps(finding.what);
    }
    for (GazeCalibration& calibration : report.calibrations) {
      calibration.t_ns = 0;
    }
    for (GazeRecording& recording : report.recordings) {
      recording.last_ns = duration_ns(recording);
      recording.first_ns = 0;
    }
  }
  return report;
}

}  // namespace

std::string_view to_string(AxisVerdict verdict) {
  return name_of(verdict, {"confirmed", "flipped", "undecided"});
}

std::string_view to_string(FindingKind kind) {
  return name_of(kind, {"fault", "suspicion", "note"});
}

void add_finding(GazeInspection& inspection, FindingKind kind, std::string code, std::string what, std::string evidence,
                 std::string setting) {
  inspection.findings.push_back({kind, std::move(code), std::move(what), std::move(evidence), std::move(setting)});
}

bool has_finding(const GazeInspection& inspection, std::initializer_list<std::string_view> codes) {
  return std::any_of(inspection.findings.begin(), inspection.findings.end(), [&](const GazeFinding& finding) {
    return std::find(codes.begin(), codes.end(), finding.code) != codes.end();
  });
}

GazeUnderInspection load_for_inspection(const std::string& path, GazeReadOptions read) {
  read.guess_display = true;
  read.frame = read.frame == GazeFrame::automatic ? GazeFrame::scene_camera : read.frame;
  GazeUnderInspection gaze;
  gaze.raw = read_raw_gaze(path, read);
  if (needs_a_choice(gaze.raw)) {
    gaze.is_first_of_several = true;
    choose_recording(gaze.raw, "1");
  }
  gaze.conventions = conclude_conventions(gaze.raw, read);
  gaze.is_sorted_by_option = gaze.conventions.unordered == UnorderedPolicy::sort;
  gaze.conventions.unordered = UnorderedPolicy::sort;
  gaze.log = interpret(gaze.raw, gaze.conventions);
  if (!gaze.is_sorted_by_option) {  // what was done for the look alone: the findings say what is wrong with the order
    std::erase_if(gaze.log.warnings, [](const std::string& warning) {
      return warning.find(": sorted by time") != std::string::npos ||
             warning.find("the last row of equal times is kept") != std::string::npos;
    });
  }
  return gaze;
}

GazeInspection inspect_gaze(const GazeLog& log, const GazeInspectOptions& options) {
  return inspect(log, nullptr, options);
}

GazeInspection inspect_gaze(const GazeUnderInspection& gaze, const GazeInspectOptions& options) {
  return inspect(gaze.log, &gaze, options);
}

}  // namespace gazetrace
