// SPDX-License-Identifier: Apache-2.0
// Where the viewer of two sequences looked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/compare_inputs.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

bool has_gaze_on_screen(const FrameFacts& facts) {
  return facts.gaze_true && !facts.gaze_is_direction && gaze_class_of(*facts.gaze_true) != GazeClass::no_gaze;
}

std::int64_t video_time_ns(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                           const FrameFacts& test, std::int32_t frame) {
  if (reference.t_video_ns || test.t_video_ns) {
    return reference.t_video_ns ? *reference.t_video_ns : *test.t_video_ns;
  }
  if (!has_frame_number(job.reference) && !has_frame_number(job.test)) {
    throw Error(ErrorKind::usage, "`gaze`", "a single picture that does not say its video time has no place in a log",
                "give `gaze-at`, or name it as a frame of a sequence: name.####.png, `frames` and `fps`");
  }
  if (!inputs.stated_fps) {
    throw Error(ErrorKind::usage, "`gaze`", "the pictures say neither their video time nor their frame rate",
                "give `fps`");
  }
  constexpr double kNsPerSecond = 1e9;
  return static_cast<std::int64_t>(std::floor((frame - 0.5) / *inputs.stated_fps * kNsPerSecond));
}

}  // namespace

GazeSource compared_gaze_source(const CompareJob& job, const CompareInputs& inputs) {
  if (!job.gaze_in_frame.empty()) {
    return {"given in fractions of the frame"};
  }
  if (job.shared.gaze_at) {
    return {fmt::format("at rest at {:g},{:g} of the screen", job.shared.gaze_at->x, job.shared.gaze_at->y)};
  }
  if (inputs.gaze_log) {
    return {job.shared.gaze.path};
  }
  const auto any_of = [&](const std::string& pattern) {
    return std::any_of(inputs.frames.begin(), inputs.frames.end(), [&](std::int32_t frame) {
      return has_gaze_on_screen(read_frame_facts(picture_path(pattern, frame)));
    });
  };
  if (any_of(job.reference)) {
    return {"of the reference's pictures"};
  }
  return any_of(job.test) ? GazeSource{"of the test's pictures; the reference has none", true} : GazeSource{};
}

void check_same_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                     const FrameFacts& test, const std::string& test_path) {
  if (job.anyway || !job.gaze_in_frame.empty() || job.shared.gaze_at || inputs.gaze_log ||
      !has_gaze_on_screen(reference) || !has_gaze_on_screen(test)) {
    return;
  }
  const GazeAtTime& a = *reference.gaze_true;
  const GazeAtTime& b = *test.gaze_true;
  constexpr double kSamePlace = 1e-6;
  if (!(std::fabs(b.u - a.u) <= kSamePlace && std::fabs(b.v - a.v) <= kSamePlace)) {
    throw Error(
        ErrorKind::input, test_path,
        fmt::format("was looked at in {:.4f},{:.4f} of the screen, the reference in {:.4f},{:.4f}", b.u, b.v, a.u, a.v),
        "say with `gaze` or `gaze-at` where the viewer looked, or `anyway` for the reference's gaze");
  }
}

ComparedGaze compared_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                           const FrameFacts& test, std::int32_t frame, int width_px, int height_px) {
  if (!job.gaze_in_frame.empty()) {
    const auto index = std::find(inputs.frames.begin(), inputs.frames.end(), frame) - inputs.frames.begin();
    const auto& at = job.gaze_in_frame[job.gaze_in_frame.size() == 1 ? 0 : static_cast<std::size_t>(index)];
    return at ? ComparedGaze{Vec2d{at->x * width_px, at->y * height_px}, GazeClass::fixation} : ComparedGaze{};
  }
  std::optional<GazeAtTime> gaze = inputs.gaze.is_of_test ? test.gaze_true : reference.gaze_true;
  const std::optional<RecordedRun>& run = inputs.gaze.is_of_test ? inputs.test_run : inputs.reference_run;
  if (job.shared.gaze_at) {
    // An eye that rests there.
    gaze.emplace();
    gaze->state = GazeState::measured;
    gaze->u = job.shared.gaze_at->x;
    gaze->v = job.shared.gaze_at->y;
    gaze->movement = EyeMovement::fixation;
  } else if (inputs.gaze_log) {
    gaze = gaze_at(*inputs.gaze_log->gaze, inputs.gaze_log->plan_settings.gaze,
                   video_time_ns(job, inputs, reference, test, frame),
                   inputs.movements.empty() ? nullptr : &inputs.movements);
  }
  if (!gaze) {
    return {};
  }
  if (!inputs.gaze_log && !gaze->movement && run && run->settings().gaze_at) {
    gaze->movement = EyeMovement::fixation;
  }
  const GazeClass gaze_class = gaze_class_of(*gaze);
  if (gaze_class == GazeClass::no_gaze || gaze->kind == GazeKind::direction) {
    return {std::nullopt, gaze_class};
  }
  // Of the screen to those of the frame, which may fill a part of it.
  const FrameRect& rect = inputs.frame_rect;
  const bool whole = !inputs.screen || rect.width_px == 0;
  const double screen_x = whole ? 0 : gaze->u * inputs.screen->width_px;
  const double screen_y = whole ? 0 : gaze->v * inputs.screen->height_px;
  const Vec2d px = whole ? Vec2d{gaze->u * width_px, gaze->v * height_px}
                         : Vec2d{(screen_x - rect.x_px) / rect.width_px * width_px,
                                 (screen_y - rect.y_px) / rect.height_px * height_px};
  return {px, gaze_class};
}

}  // namespace gazetrace
