// SPDX-License-Identifier: Apache-2.0
#include "job/plan_settings.hpp"

#include <fmt/format.h>

#include <string>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Where the log states no size, the size follows from its pixels per degree, as only the ratio to the distance matters.
DisplayGeometry recording_display(const GazeLog& log, Decisions& decisions) {
  const DisplayGeometry& stated = *log.recording_geometry;
  const bool no_angles = !(stated.width_cm > 0) || !(stated.height_cm > 0) || !(stated.distance_cm > 0);
  const auto& ppd = log.pixels_per_degree;
  if (no_angles && stated.width_px > 0 && stated.height_px > 0 && ppd && ppd->x > 0 && ppd->y > 0) {
    decisions.emplace_back(
        "screen", fmt::format("that of the recording, by the log's {:.4g} x {:.4g} pixels a degree", ppd->x, ppd->y));
    return display_of_pixels_per_degree(stated.width_px, stated.height_px, *ppd);
  }
  decisions.emplace_back("screen", "that of the recording, as the gaze log states it");
  return stated;
}

}  // namespace

PlanSettings plan_settings(const JobSettings& job, const std::vector<std::int32_t>& frames, const GazeLog* log,
                           std::int64_t taken_off_ns, Decisions& decisions) {
  PlanSettings settings;
  settings.frames = frames;
  settings.fps = job.fps;
  settings.first_frame = job.first_frame;
  settings.start_ns = job.start.ns;
  settings.shutter = job.shutter;
  settings.camera_extrapolation = job.camera_extrapolation;
  std::string clock;
  settings.gaze = gaze_mapping(job, log, taken_off_ns, &clock);
  if (!clock.empty()) {
    decisions.emplace_back("gaze clock", clock);
  }
  settings.gaze_latency_ns = job.gaze_at ? 0 : job.gaze_latency.ns;
  settings.most_frames_without_gaze = job.gaze_max_missing_frames;
  settings.width_px = job.size.width;
  settings.height_px = job.size.height;
  settings.display = screen_geometry(job.screen);
  const bool has_pixels = log != nullptr && log->kind == GazeKind::screen && log->recording_geometry;
  if (settings.display && settings.display->width_px <= 0 && has_pixels) {
    settings.display->width_px = log->recording_geometry->width_px;
    settings.display->height_px = log->recording_geometry->height_px;
  }
  if (settings.display) {
    decisions.emplace_back("screen", job.screen.name.empty() ? "as given" : job.screen.name);
  } else if (log != nullptr && log->recording_geometry && log->kind == GazeKind::screen) {
    settings.display = recording_display(*log, decisions);
  }
  settings.transfer = job.gaze_transfer;
  if (job.frame_rect) {
    settings.frame_rect = *job.frame_rect;
  }
  return settings;
}

void check_screen(const PlanSettings& settings, const GazeLog* log) {
  if (log != nullptr && log->kind == GazeKind::screen && !settings.display) {
    throw Error(ErrorKind::input, log->source, "gaze on a screen needs the screen's size and distance",
                "give `screen` NAME, or `screen-px`, `screen-cm` and `screen-distance-cm`");
  }
  if (settings.display) {
    check_display(*settings.display);
  }
}

}  // namespace gazetrace
