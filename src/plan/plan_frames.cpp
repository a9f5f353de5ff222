// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gazetrace/plan.hpp"
#include "plan/gaze_geometry.hpp"
#include "plan/gaze_motion.hpp"

namespace gazetrace {
namespace {

std::string seconds(std::int64_t t_ns) {
  return fmt::format("{:.3f} s", static_cast<double>(t_ns) * 1e-9);
}

std::optional<std::int64_t> time_if_any_ns(const PlanSettings& settings, std::int64_t frame) {
  return mid_frame_ns(frame - settings.first_frame + 1, settings.fps, settings.start_ns);
}

std::int64_t frame_time_ns(const PlanSettings& settings, std::int32_t frame) {
  const auto t_ns = time_if_any_ns(settings, frame);
  if (!t_ns) {
    throw Error(ErrorKind::usage, "", fmt::format("frame {} lies beyond int64 nanoseconds", frame),
                "check `frames`, `fps` and `start`");
  }
  return *t_ns;
}

void check_settings(const PlanSettings& settings) {
  if (settings.frames.empty()) {
    throw Error(ErrorKind::usage, "", "there is no frame to render", "give `frames`");
  }
  if (settings.fps.numerator <= 0 || settings.fps.denominator <= 0) {
    throw Error(ErrorKind::usage, "", fmt::format("a frame rate of {} is not positive", to_string(settings.fps)));
  }
  const std::int32_t least = *std::min_element(settings.frames.begin(), settings.frames.end());
  if (least < settings.first_frame) {
    throw Error(ErrorKind::usage, "`frames`",
                fmt::format("frame {} does not exist: frames are numbered from {}", least, settings.first_frame),
                "name others, or change `first-frame`");
  }
  if (settings.gaze_latency_ns < 0) {
    throw Error(ErrorKind::usage, "", "a negative gaze latency would look ahead", "give `gaze-latency` of 0 or more");
  }
}

// start + (frame - first + part) / fps, for times inside a frame, where half a nanosecond does not matter.
std::int64_t time_in_frame_ns(const PlanSettings& settings, std::int32_t frame, double part) {
  const double period_ns =
      1e9 * static_cast<double>(settings.fps.denominator) / static_cast<double>(settings.fps.numerator);
  return frame_time_ns(settings, frame) + std::llround((part - 0.5) * period_ns);
}

CameraPose pose_at(const CameraPath& camera, std::int64_t t_ns) {
  return camera.pose_at(camera.is_static ? t_ns : std::clamp(t_ns, camera.begin_ns, camera.end_ns));
}

NeighborView view_at(const CameraPath& camera, std::int64_t t_ns) {
  return {pose_at(camera, t_ns), t_ns};
}

// A camera need not move evenly while the shutter is open, so its path is sampled at this many steps.
constexpr int kShutterSteps = 16;

// Empty where the camera stands still.
std::vector<CameraPose> shutter_poses(const CameraPath& camera, std::int64_t open_ns, std::int64_t close_ns) {
  std::vector<CameraPose> poses;
  if (camera.is_static || close_ns <= open_ns) {
    return poses;
  }
  for (int i = 0; i <= kShutterSteps; ++i) {
    poses.push_back(pose_at(camera, open_ns + (close_ns - open_ns) * i / kShutterSteps));
  }
  const bool still =
      std::all_of(poses.begin(), poses.end(), [&](const CameraPose& pose) { return pose == poses.front(); });
  return still ? std::vector<CameraPose>() : poses;
}

bool covers(const CameraPath& camera, std::int64_t t_ns) {
  return camera.is_static || (t_ns >= camera.begin_ns && t_ns <= camera.end_ns);
}

void check_coverage(const CameraPath& camera, const PlanSettings& settings, Warnings& warnings) {
  std::size_t outside = 0;
  std::int32_t first = 0;
  for (const std::int32_t frame : settings.frames) {
    if (!covers(camera, frame_time_ns(settings, frame))) {
      first = outside == 0 ? frame : first;
      ++outside;
    }
  }
  if (outside == 0) {
    return;
  }
  const std::string what =
      fmt::format("the camera path runs from {} to {}, and frame {} is at {}{}", seconds(camera.begin_ns),
                  seconds(camera.end_ns), first, seconds(frame_time_ns(settings, first)),
                  outside > 1 ? fmt::format(" ({} of {} frames are outside)", outside, settings.frames.size()) : "");
  if (settings.camera_extrapolation == CameraExtrapolation::error) {
    throw Error(ErrorKind::input, camera.source, what, "render other frames, or use `camera-extrapolation` hold");
  }
  warnings.push_back(fmt::format("{}: {}; its first or last pose is held", camera.source, what));
}

std::int64_t earlier(std::int64_t t_ns, std::int64_t by_ns) {
  std::int64_t result = 0;
  return __builtin_sub_overflow(t_ns, by_ns, &result) ? std::numeric_limits<std::int64_t>::min() : result;
}

// The frame before this one. For the first of the list it is guessed: frames before it are taken to be as far apart as
// those after it, and where that would be before the video's first, it is the frame itself.
std::int32_t likely_predecessor(const std::vector<std::int32_t>& frames, std::size_t index, std::int32_t first) {
  const std::int32_t frame = frames[index];
  const std::size_t next = std::max<std::size_t>(index, 1);
  const std::int32_t step = next < frames.size() ? frames[next] - frames[next - 1] : 1;
  return frame - step >= first ? frame - step : frame;
}

void say_what_the_eye_did(FrameRequest& request, std::int32_t frame_before, const GazeMotion& motion,
                          const GazeLog& log, const PlanSettings& settings) {
  const std::int64_t steered_ns = earlier(frame_time_ns(settings, frame_before), settings.gaze_latency_ns);
  const std::int64_t since_ns = log_time_ns(log, settings.gaze, steered_ns);
  request.saccade_since_last_frame = motion.did(EyeMovement::saccade, since_ns, request.gaze_render.t_log_ns);
  request.blink_since_last_frame = motion.did(EyeMovement::blink, since_ns, request.gaze_render.t_log_ns);
}

// Frames without gaze that follow each other. A plan is refused as soon as there are too many of them, before it grows
// to the millions of frames that lie between two recordings.
class FramesWithoutGaze {
 public:
  FramesWithoutGaze(const GazeLog* log, const PlanSettings& settings) : log_(log), settings_(settings) {}

  void count(const FrameRequest& request) {
    in_a_row_ = log_ != nullptr && request.gaze_true.no_gaze ? in_a_row_ + 1 : 0;
    first_ = in_a_row_ == 1 ? request.frame : first_;
    if (settings_.most_frames_without_gaze > 0 && in_a_row_ > settings_.most_frames_without_gaze) {
      throw Error(ErrorKind::input, log_->source,
                  fmt::format("has no usable gaze for more than {} frames in a row, from frame {} on: {}",
                              settings_.most_frames_without_gaze, first_, request.gaze_true.reason),
                  log_->recordings.size() > 1 && log_->recording == 0
                      ? "take one block with `gaze-recording`, give `frames`, or allow it with "
                        "`gaze-max-missing-frames` 0"
                      : "give `frames`, or allow it with `gaze-max-missing-frames` 0");
    }
  }

 private:
  const GazeLog* log_;
  const PlanSettings& settings_;
  std::uint64_t in_a_row_ = 0;
  std::int32_t first_ = 0;
};

// Before a frame is rendered: where the eye is only said to be.
void warn_of_held_gaze(const std::vector<FrameRequest>& frames, const GazeLog& log, Warnings& warnings) {
  std::size_t held = 0;
  std::size_t after_end = 0;
  std::int32_t first_after = 0;
  std::size_t before = 0;
  for (const FrameRequest& request : frames) {
    const GazeAtTime& gaze = request.gaze_render;
    before += gaze.no_gaze && !log.samples.empty() && gaze.t_log_ns < log.samples.front().t_ns ? 1 : 0;
    if (gaze.state != GazeState::held) {
      continue;
    }
    if (!log.samples.empty() && gaze.t_log_ns > log.samples.back().t_ns) {  // a row young enough to hold, too
      first_after = after_end == 0 ? request.frame : first_after;
      ++after_end;
    } else if (gaze.no_gaze) {
      ++held;
    }
  }
  if (2 * before > frames.size()) {  // a latency leaves the first few frames without gaze
    warnings.push_back(fmt::format(
        "{} of {} frames lie before the first row of the gaze log: check `gaze-latency`, or begin `frames` later",
        before, frames.size()));
  }
  if (after_end > 0) {
    warnings.push_back(
        fmt::format("{} of {} frames, from frame {} on, lie after the end of the gaze log and hold its last gaze: end "
                    "`frames` before, or give `gaze-missing`",
                    after_end, frames.size(), first_after));
  }
  if (held > 0) {
    warnings.push_back(
        fmt::format("{} of {} frames have no gaze of their own and hold the nearest one in the past, or the first",
                    held, frames.size()));
  }
}

// Fixes the beginning of the clock to the log's first sample, since processing may remove that sample.
PlanSettings with_clock(const GazeLog* log, PlanSettings settings) {
  if (log != nullptr && !settings.gaze.event_ns && !log->samples.empty()) {
    settings.gaze.event_ns = log->samples.front().t_ns;
  }
  return settings;
}

}  // namespace

FramePlan plan_frames(const CameraPath& camera, const GazeLog* log, const PlanSettings& given,
                      const ProcessedGaze* steering) {
  check_settings(given);
  const PlanSettings settings = with_clock(log, given);
  const GazeLog* const steering_log = steering != nullptr ? &steering->log : log;
  const GazeMotion motion(log, settings);
  const GazeMotion steering_motion = steering_log == log ? motion : GazeMotion(steering_log, settings);
  FramePlan plan;
  plan.gaze_latency_ns = settings.gaze_latency_ns;
  if (steering != nullptr) {
    plan.gaze_processing = steering->reports;
  }
  check_coverage(camera, settings, plan.warnings);
  const GazeGeometry geometry(camera, log, settings, plan.warnings);
  FramesWithoutGaze without_gaze(log, settings);
  plan.frames.reserve(settings.frames.size());
  for (const std::int32_t frame : settings.frames) {
    FrameRequest request;
    request.frame = frame;
    request.t_video_ns = frame_time_ns(settings, frame);
    request.width_px = settings.width_px;
    request.height_px = settings.height_px;
    request.view = geometry.view();
    request.shutter_open_ns = request.shutter_close_ns = request.t_video_ns;
    if (settings.shutter.blurs()) {
      request.shutter_open_ns = time_in_frame_ns(settings, frame, settings.shutter.open);
      request.shutter_close_ns = time_in_frame_ns(settings, frame, settings.shutter.close);
    }
    request.camera.pose = pose_at(camera, request.t_video_ns);
    request.before = view_at(camera, time_in_frame_ns(settings, frame, -0.5));
    request.after = view_at(camera, time_in_frame_ns(settings, frame, 1.5));
    request.camera.projection = camera.projection;
    const double step_m = pixel_step_m(camera.projection, settings.height_px);
    request.camera.middle_px = {camera.projection.middle_m.x / step_m, -camera.projection.middle_m.y / step_m};
    request.camera.lens = camera.lens;
    request.camera.shutter_poses = shutter_poses(camera, request.shutter_open_ns, request.shutter_close_ns);
    if (log != nullptr) {
      request.gaze_true = gaze_at(*log, settings.gaze, request.t_video_ns, motion.movements());
      without_gaze.count(request);
      request.gaze_render =
          settings.gaze_latency_ns == 0 && steering_log == log
              ? request.gaze_true
              : gaze_at(*steering_log, settings.gaze, earlier(request.t_video_ns, settings.gaze_latency_ns),
                        steering_motion.movements());
      const auto age_ns = effective_age_ns(request);
      if (age_ns && request.gaze_render.age_is_known && !request.gaze_render.no_gaze) {
        request.gaze_effective_age_ns = std::llround(static_cast<double>(*age_ns) * settings.gaze.scale);
      }
      request.eye_in_saccade = motion.in_saccade(request.gaze_render.t_log_ns);
      say_what_the_eye_did(request, likely_predecessor(settings.frames, plan.frames.size(), settings.first_frame),
                           motion, *log, settings);
      geometry.settle(request.gaze_render);
      geometry.settle(request.gaze_true);
      request.gaze_direction_render = geometry.direction(request.gaze_render);
      request.gaze_direction_true = geometry.direction(request.gaze_true);
    } else {
      request.gaze_render.reason = "no gaze log";
      request.gaze_true.reason = "no gaze log";
    }
    plan.frames.push_back(std::move(request));
  }
  if (log != nullptr) {
    warn_of_held_gaze(plan.frames, *steering_log, plan.warnings);
  }
  plan.ages = gaze_ages(plan, settings);
  warn_about_latency(settings, plan.warnings);
  return plan;
}

bool has_frame(const CameraPath& camera, const PlanSettings& settings, std::int64_t frame) {
  if (frame < settings.first_frame || frame > std::numeric_limits<std::int32_t>::max()) {
    return false;
  }
  const auto t_ns = time_if_any_ns(settings, frame);
  return t_ns && covers(camera, *t_ns);
}

}  // namespace gazetrace
