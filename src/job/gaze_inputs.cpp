// SPDX-License-Identifier: Apache-2.0
// How gaze enters a run: its clock and its processing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_process.hpp"
#include "gazetrace/job_schema.hpp"
#include "job/gaze_inputs.hpp"
#include "job/screen.hpp"

namespace gazetrace {
namespace {

// Gaze that never moves is a log of one sample that never becomes too old.
GazeLog fixed_gaze(const Vec2d& at) {
  GazeLog log;
  log.source = "`gaze-at`";
  log.format = "fixed";
  GazeSample sample;
  sample.u = at.x;
  sample.v = at.y;
  log.samples.push_back(sample);
  return log;
}

// Whether a message names a setting that only the importer has.
bool names_reading(const std::string& message) {
  const OptionSchema<GazeFileSettings> taken = gaze_choice_schema();
  const OptionSchema<GazeFileSettings> all = gaze_import_schema();
  for (std::size_t open = message.find('`'); open != std::string::npos; open = message.find('`', open + 1)) {
    const std::size_t close = message.find('`', open + 1);
    const std::string name = close == std::string::npos ? "" : message.substr(open + 1, close - open - 1);
    if (all.find(name) != nullptr && taken.find(name) == nullptr) {
      return true;
    }
  }
  return false;
}

// Where a file is read without being imported, settings of the importer are no way out by themselves.
GazeLog load_with_a_way_out(const std::string& path, const GazeReadOptions& options) {
  try {
    return load_gaze_log(path, options);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (options.accepts_inferred || message.find("gaze import ") != std::string::npos || !names_reading(message)) {
      throw;
    }
    throw Error(error.kind(), "", message, fmt::format("which gazetrace gaze import {} -o gaze.csv takes", path));
  }
}

// `screen` is the screen on which the pictures are viewed; it describes the recording only where nothing else does.
GazeLog read_job_gaze(const JobSettings& job) {
  GazeReadOptions options = read_options(job.gaze, {});
  options.fallback_display = screen_geometry(job.screen);
  if (job.max_memory.bytes > 0) {
    options.most_unpacked_bytes = job.max_memory.bytes / 2;  // its rows take as much again
  }
  options.allow_outside = job.allow_outside;
  if (!job.recording_screen.empty()) {
    options.display = known_screen(job.recording_screen, "`recording-screen`");
  }
  return chosen_trial(load_with_a_way_out(job.gaze.path, options), job.gaze.trial);
}

// Size and distance that are given for a log of pixels alone are those of the recording, and of the pictures as well:
// who states them states the own laboratory.
void take_own_laboratory(GazeLog& log, const ScreenSettings& screen) {
  const std::optional<DisplayGeometry> given = screen_geometry(screen);
  auto& stated = log.recording_geometry;
  if (log.kind != GazeKind::screen || !given || !screen.name.empty() || !stated || stated->width_px <= 0 ||
      stated->width_cm > 0 || stated->distance_cm > 0) {
    return;
  }
  const bool has_its_pixels =
      given->width_px <= 0 || (given->width_px == stated->width_px && given->height_px == stated->height_px);
  if (has_its_pixels && given->width_cm > 0 && given->height_cm > 0 && given->distance_cm > 0) {
    stated = completed_geometry(*stated, *given);
  }
}

constexpr const char* kAnchor = "`gaze-anchor`";

ClockAnchor parse_anchor(const std::string& text, const GazeLog& log, std::int64_t taken_off_ns) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) {
    throw Error(ErrorKind::usage, kAnchor, fmt::format("'{}' has no video time", text),
                "write LOG=VIDEO, such as 12.5s=0s or 'TRIAL 1=2s'");
  }
  DurationNs video;
  parse_value(text.substr(equals + 1), kAnchor, video);
  const std::string place = text.substr(0, equals);
  DurationNs time;
  try {
    parse_value(place, kAnchor, time);
  } catch (const Error&) {
    return {time_of_message(log, place), video.ns};  // it is not a time but a message
  }
  if (__builtin_sub_overflow(time.ns, taken_off_ns, &time.ns)) {
    throw Error(ErrorKind::usage, kAnchor, fmt::format("{} lies ages away from the log", place),
                "give a time of the log's own clock");
  }
  return {time.ns, video.ns};
}

GazeMapping mapping_from_anchors(const JobSettings& job, const GazeLog& log, std::int64_t taken_off_ns,
                                 std::string* decision) {
  if (job.gaze_start || job.gaze_offset.ns != 0 || job.gaze_scale != 1.0) {
    throw Error(ErrorKind::usage, kAnchor, "anchors already say start, offset and scale",
                "leave `gaze-start`, `gaze-offset` and `gaze-scale` out");
  }
  std::vector<ClockAnchor> anchors;
  for (const std::string& text : job.gaze_anchors) {
    anchors.push_back(parse_anchor(text, log, taken_off_ns));
  }
  const ClockFit fit = fit_clock(anchors);
  if (decision != nullptr) {
    *decision =
        fmt::format("log time {} ns is video time {:.6f} s", fit.event_ns, static_cast<double>(fit.offset_ns) * 1e-9);
    if (anchors.size() > 1) {
      *decision += fmt::format(", scale {:.9f} ({:+.1f} ppm), by {} anchors; residual {:.3f} ms rms, {:.3f} ms at most",
                               fit.scale, (fit.scale - 1) * 1e6, anchors.size(), fit.rms_residual_ns * 1e-6,
                               fit.max_residual_ns * 1e-6);
    }
  }
  GazeMapping mapping;
  mapping.scale = fit.scale;
  mapping.offset_ns = fit.offset_ns;
  mapping.event_ns = fit.event_ns;
  return mapping;
}

}  // namespace

GazeMapping gaze_mapping(const JobSettings& job, const GazeLog* log, std::int64_t taken_off_ns, std::string* decision) {
  GazeMapping mapping;
  if (job.gaze_at) {
    mapping.max_age_ns = std::numeric_limits<std::int64_t>::max();
    mapping.offset_ns = job.start.ns;
    return mapping;
  }
  if (!job.gaze_anchors.empty() && log != nullptr) {
    mapping = mapping_from_anchors(job, *log, taken_off_ns, decision);
  } else {
    mapping.scale = job.gaze_scale;
    mapping.offset_ns = job.gaze_offset.ns;
    if (job.gaze_start) {
      std::int64_t event_ns = 0;
      if (__builtin_sub_overflow(job.gaze_start->ns, taken_off_ns, &event_ns)) {
        throw Error(ErrorKind::usage, "`gaze-start`", "lies ages away from the log");
      }
      mapping.event_ns = event_ns;
    } else if (log != nullptr && log->trial) {
      mapping.event_ns = log->trial->begin_ns;
    }
  }
  mapping.interpolation = job.gaze_mode;
  mapping.no_gaze = job.gaze_missing;
  mapping.max_age_ns = job.gaze_max_age.ns;
  mapping.max_interpolation_gap_ns = job.gaze_max_gap.ns;
  return mapping;
}

GazeColumns merged_columns(const GazeFileSettings& gaze) {
  return gaze.columns_file.empty() ? gaze.read.columns
                                   : merge_gaze_columns(load_gaze_columns(gaze.columns_file), gaze.read.columns);
}

GazeReadOptions read_options(const GazeFileSettings& gaze, const ScreenSettings& screen) {
  GazeReadOptions options = gaze.read;
  options.columns = merged_columns(gaze);
  options.min_confidence = gaze.min_confidence.value_or(options.min_confidence);
  options.display = screen_geometry(screen);
  options.eye_cm = screen.eye_cm;
  options.most_unpacked_bytes = most_memory_bytes() / 2;
  return options;
}

GazeLog read_gaze_file(const GazeFileSettings& gaze, const ScreenSettings& screen) {
  GazeLog log = load_with_a_way_out(gaze.path, read_options(gaze, screen));
  name_trials(log, gaze.trial_rules);
  return chosen_trial(std::move(log), gaze.trial);
}

std::optional<GazeLog> gaze_of_job(const JobSettings& job, std::int64_t& taken_off_ns) {
  taken_off_ns = 0;
  if (job.gaze_at) {
    if (!job.gaze.path.empty()) {
      throw Error(ErrorKind::usage, "`gaze-at`", "a fixed gaze and a gaze log exclude each other",
                  "give one of `gaze` and `gaze-at`");
    }
    return fixed_gaze(*job.gaze_at);
  }
  if (job.gaze.path.empty()) {
    return std::nullopt;
  }
  GazeLog log = read_job_gaze(job);
  if (!job.keep_ids) {
    LogWithoutTimesOfDay hidden = without_times_of_day(std::move(log));
    log = std::move(hidden.log);
    taken_off_ns = hidden.taken_off_ns.value_or(0);
  }
  if (!job.gaze_transfer && job.recording_screen.empty()) {
    take_own_laboratory(log, job.screen);
  }
  complete_recording_geometry(log, job.screen);
  return log;
}

void complete_recording_geometry(GazeLog& log, const ScreenSettings& screen) {
  const std::optional<DisplayGeometry> given = screen_geometry(screen);
  if (!given || log.kind != GazeKind::screen || knows_angles(log)) {
    return;
  }
  log.recording_geometry = completed_geometry(log.recording_geometry.value_or(*given), *given);
}

std::vector<GazeStep> gaze_steps_of(const std::vector<std::string>& texts) {
  std::vector<GazeStep> steps;
  for (const std::string& text : texts) {
    steps.push_back(parse_gaze_step(text));
  }
  return steps;
}

}  // namespace gazetrace
