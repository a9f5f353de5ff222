// SPDX-License-Identifier: Apache-2.0
// Chooses the frames where the job does not state them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_events.hpp"
#include "job/choose_frames.hpp"

namespace gazetrace {
namespace {

// How many frames have their middle before a time, or at it. Middles are rounded to nanoseconds, as the times of a path
// that was made for them are, so the number that floating point gives is corrected by comparing integers.
std::int64_t frames_until(std::int64_t end_ns, const JobSettings& job) {
  const double span_s = (static_cast<double>(end_ns) - static_cast<double>(job.start.ns)) * 1e-9;
  const double frames = span_s * static_cast<double>(job.fps.numerator) / static_cast<double>(job.fps.denominator);
  if (!(frames < static_cast<double>(kMostPlannedFrames))) {
    throw Error(ErrorKind::usage, "`frames`", fmt::format("camera path or gaze log stand for {:.3g} frames", frames),
                "name the frames to render, or check `gaze-scale`, `gaze-offset` and `fps`");
  }
  const auto is_before_end = [&](std::int64_t count) {
    const auto middle_ns = mid_frame_ns(count, job.fps, job.start.ns);
    return middle_ns && *middle_ns <= end_ns;
  };
  auto count = static_cast<std::int64_t>(std::max(std::floor(frames + 0.5), 0.0));
  count += is_before_end(count + 1) ? 1 : 0;
  count -= count > 0 && !is_before_end(count) ? 1 : 0;
  return count;
}

std::int64_t nanoseconds(double t_ns) {
  constexpr double kMost = 9e18;  // frames_until() refuses what is beyond
  return static_cast<std::int64_t>(std::llround(std::clamp(t_ns, -kMost, kMost)));
}

std::int64_t last_motion_ns(const Scene* scene) {
  std::int64_t last = 0;
  if (scene != nullptr) {
    for (const Motion& motion : scene->motions) {
      last = std::max(last, motion.end_ns);
    }
    for (const Deformation& deformation : scene->deformations) {
      last = std::max(last, deformation.end_ns);
    }
  }
  return last;
}

bool lasts(const GazeLog* log) {
  return log != nullptr && log->samples.size() > 1;
}

// The log's own events where it states fixations, else those of the method for its kind of recording.
EyeEvents events_for_frames(const GazeLog& log, std::string& whose) {
  EyeEvents events = events_of_log(log);
  const auto is_fixation = [](const EyeEvent& event) { return event.movement == EyeMovement::fixation; };
  whose = "the log's own";
  if (std::none_of(events.events.begin(), events.events.end(), is_fixation)) {
    const EventPreset& preset = default_event_preset(log);
    events = detect_events(log, preset);
    whose = "by " + preset.name;
  }
  std::erase_if(events.events, [&](const EyeEvent& event) { return !is_fixation(event); });
  return events;
}

// The frame whose middle is nearest to that of each fixation, where it lies within it.
std::vector<std::int32_t> fixation_frames(const JobSettings& job, const ViewInputs& inputs, std::string& decision) {
  if (!lasts(inputs.log)) {
    throw Error(ErrorKind::usage, "`frames`", "there is no gaze log whose fixations could be counted",
                "give `gaze`, or name frames such as 1-100");
  }
  const GazeMapping mapping = gaze_mapping(job, inputs.log, inputs.taken_off_ns);
  const std::int64_t begin_ns = mapping.event_ns.value_or(inputs.log->samples.front().t_ns);
  const double fps = static_cast<double>(job.fps.numerator) / static_cast<double>(job.fps.denominator);
  // Whole frames since the video's start: frame n is at n - 1/2.
  const auto place_of = [&](std::int64_t t_ns) {
    const double since_ns = static_cast<double>(t_ns) - static_cast<double>(begin_ns);
    return (since_ns * mapping.scale + static_cast<double>(mapping.offset_ns - job.start.ns)) * 1e-9 * fps;
  };
  const std::int64_t last = inputs.camera.is_static ? kMostPlannedFrames : frames_until(inputs.camera.end_ns, job);
  std::string whose;
  const EyeEvents events = events_for_frames(*inputs.log, whose);
  std::vector<std::int32_t> frames;
  std::size_t between = 0;
  std::size_t outside = 0;
  for (const EyeEvent& event : events.events) {
    const double begin = place_of(event.begin_ns);
    const double end = place_of(event.end_ns);
    const double frame = std::floor((begin + end) / 2) + 1;
    if (frame < 1 || frame > static_cast<double>(last)) {
      ++outside;
    } else if (frame - 0.5 < begin || frame - 0.5 > end) {
      ++between;
    } else if (const auto number = static_cast<std::int32_t>(frame) + job.first_frame - 1;
               frames.empty() || frames.back() != number) {
      frames.push_back(number);
    }
  }
  const std::string counts = fmt::format("of {} fixations ({}), {} lie between frames and {} outside of the video",
                                         events.events.size(), whose, between, outside);
  if (frames.empty()) {
    throw Error(ErrorKind::input, inputs.log->source, "no fixation has a frame: " + counts,
                "look at 'gazetrace gaze events', and check `fps`, `start` and `gaze-offset`");
  }
  decision = fmt::format("{} ({} frames, one for each fixation; {})", format_frame_list(frames), frames.size(), counts);
  return frames;
}

}  // namespace

bool may_follow_scene(const JobSettings& job, const CameraPath& camera, const GazeLog* log, bool is_whole) {
  return (is_whole || !job.frames) && camera.is_static && !lasts(log);
}

// As long as the camera's path or, without one, the gaze log or, without one, the motion of the scene.
std::vector<std::int32_t> choose_frames(const JobSettings& job, const ViewInputs& inputs, std::string& decision) {
  if (job.frames && job.frames->frames.empty()) {
    return fixation_frames(job, inputs, decision);
  }
  if (job.frames) {
    decision = format_frame_list(job.frames->frames);
    return job.frames->frames;
  }
  std::int64_t before = 0;
  std::int64_t count = 1;
  std::string reason = "nothing moves";
  if (!inputs.camera.is_static) {
    count = frames_until(inputs.camera.end_ns, job);
    if (job.camera_extrapolation == CameraExtrapolation::error && inputs.camera.begin_ns > 0) {
      before = std::min(frames_until(inputs.camera.begin_ns - 1, job), std::max<std::int64_t>(count - 1, 0));
    }
    reason = "as long as the camera's path";
  } else if (lasts(inputs.log)) {
    const GazeMapping mapping = gaze_mapping(job, inputs.log, inputs.taken_off_ns);
    const std::int64_t begin_ns = mapping.event_ns.value_or(inputs.log->samples.front().t_ns);
    const std::int64_t end_ns = inputs.log->trial ? inputs.log->trial->end_ns : inputs.log->samples.back().t_ns;
    const double span_ns = static_cast<double>(end_ns) - static_cast<double>(begin_ns);
    count = frames_until(nanoseconds(span_ns * mapping.scale + static_cast<double>(mapping.offset_ns)), job);
    reason =
        inputs.log->trial ? fmt::format("as long as trial {}", inputs.log->trial->number) : "as long as the gaze log";
  } else if (const std::int64_t end_ns = last_motion_ns(inputs.scene); end_ns > 0) {
    count = frames_until(end_ns, job);
    reason = "as long as the scene's animation";
  }
  std::vector<std::int32_t> frames(static_cast<std::size_t>(std::max<std::int64_t>(count - before, 1)));
  std::iota(frames.begin(), frames.end(), job.first_frame + static_cast<std::int32_t>(before));
  decision = fmt::format("{} ({}; `frames` changes it)", format_frame_list(frames), reason);
  return frames;
}

std::vector<std::int32_t> frames_of_sequence(JobSettings job, const ViewInputs& inputs) {
  job.frames.reset();
  std::string unused;
  return choose_frames(job, inputs, unused);
}

}  // namespace gazetrace
