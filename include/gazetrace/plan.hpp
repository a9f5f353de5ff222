// SPDX-License-Identifier: Apache-2.0
// What will be rendered, decided before the first ray: one request a frame, printable and testable.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_process.hpp"

namespace gazetrace {

FrameRate parse_frame_rate(std::string_view text);  // "24", "23.976" (as 2997/125), "24000/1001"
std::string to_string(const FrameRate& rate);

// "1-100", "1-100x2", "1,5,9-12". Frames are numbered from 1. Sorted, without duplicates.
std::vector<std::int32_t> parse_frame_list(std::string_view text);
std::string format_frame_list(const std::vector<std::int32_t>& frames);

// When the shutter opens and closes, in fractions of the frame's time; equal: an instant, nothing blurs.
struct Shutter {
  double open = 0.5, close = 0.5;
  [[nodiscard]] bool blurs() const { return close > open; }
  friend bool operator==(const Shutter&, const Shutter&) = default;
};
// "0.5": half of the frame's time, about its middle; "180deg": the same as an angle of a turning shutter; "0.25,0.75":
// open and close; "0": off.
Shutter parse_shutter(std::string_view text);
std::string to_string(const Shutter& shutter);

// Of the tracker, in degrees: systematic error and scatter.
struct GazeUncertainty {
  double accuracy_deg = 0, precision_deg = 0;
};
// What the log tells of it: the mean error of its validations, and the root mean square of the scatter in fixations.
// NaN where it tells nothing.
GazeUncertainty uncertainty_of(const GazeLog& log);

// How gaze on one screen is carried over to another. Velocities, events and precision belong to the recording.
//   fraction  places stay: what was at a quarter of the screen's width is so again; angles change
//   angle     angles from the eye stay; places change, and may fall beside the screen
enum class GazeTransfer : std::uint8_t { fraction, angle };

struct PlanSettings {
  std::vector<std::int32_t> frames;
  Shutter shutter;
  FrameRate fps;
  std::int64_t start_ns = 0;  // video time at which frame 1 begins
  CameraExtrapolation camera_extrapolation = CameraExtrapolation::error;
  GazeMapping gaze;
  std::int64_t gaze_latency_ns = 0;  // gaze_render is the gaze this long ago; gaze_true stays
  bool find_events = true;           // say what the eye does, by default_event_preset() in the recording's geometry
  // The uncertainty of the gaze widens the fovea: accuracy + precision + age x speed, degrees.
  std::optional<GazeUncertainty> uncertainty;
  bool find_speed = false;  // say how fast the eye turns
  int width_px = 1280, height_px = 720;
  std::optional<DisplayGeometry> display;  // where the frame is watched; required for a screen log
  // Needed where the log states a recording screen whose size in degrees differs by more than 2 %.
  std::optional<GazeTransfer> transfer;
  FrameRect frame_rect;  // default: the whole display
};

// Complete: a frame can be rendered from it and the scene alone, history apart.
struct FrameRequest {
  std::int32_t frame = 1;
  std::int64_t t_video_ns = 0;  // mid-exposure: start + (frame - 1/2) / fps, rounded down to a nanosecond
  std::int64_t shutter_open_ns = 0, shutter_close_ns = 0;  // video time; equal: no motion blur
  int width_px = 0, height_px = 0;
  Camera camera;
  PlanarView view;         // of the eye: display or, for gaze directions, the camera's own frustum
  GazeAtTime gaze_render;  // steers the sampling
  GazeAtTime gaze_true;    // the clean log at that time; metrics use this one
  // See GazeAges, video time; empty without gaze and where the log does not tell.
  std::optional<std::int64_t> gaze_effective_age_ns;
  // The angle by which the gaze that steers may be off (PlanSettings::uncertainty); 0: not asked for.
  double gaze_uncertainty_deg = 0;
  // Of the eye by the clean log, at the time whose gaze steers: known without foresight. Speed only if asked for.
  double eye_speed_deg_s = 0;
  bool eye_in_saccade = false;
  // By the clean log as well: whether the eye was in a saccade, or closed, at any time since the gaze that steered the
  // frame before. Both are shorter than most frames last.
  bool saccade_since_last_frame = false, blink_since_last_frame = false;
  // In the eye's frame; empty: no gaze, render uniformly.
  std::optional<Vec3d> gaze_direction_render, gaze_direction_true;
};

// How old the gaze that steers a frame is in the middle of the time for which the frame is shown: latency, the wait of
// a sample for the next frame and half of the frame's own time are in it. While a frame is shown its age grows from
// half_frame_ns less to half_frame_ns more.
struct GazeAges {
  std::size_t frames = 0, unknown = 0;  // with a known age; with gaze of unknown age
  std::size_t without = 0;              // without gaze, whatever steers them instead; no part of the ages
  double min_ns = 0, median_ns = 0, mean_ns = 0, p95_ns = 0, max_ns = 0;
  double half_frame_ns = 0;
};

struct FramePlan {
  std::vector<FrameRequest> frames;
  std::optional<GazeAges> ages;              // empty: no frame has gaze from a log
  std::int64_t gaze_latency_ns = 0;          // as asked for
  std::vector<std::string> gaze_processing;  // what was done to the log that steers, line by line
  Warnings warnings;
};

// Without a log (nullptr) every frame is rendered without gaze. Error(input) when the camera path does not cover a
// frame, when a screen log has no display, or was recorded on another one and there is no
// transfer, when NoGazePolicy::error meets a gap.
// `steering`: the log after processing, which gaze_render comes from; by default the log itself. Both share the clock
// of the first.
FramePlan plan_frames(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings,
                      const ProcessedGaze* steering = nullptr);

// For a plan that goes on where another run ended: enters what the eye has done since `frame_before`, the last frame of
// that run. By itself plan_frames() assumes that the frame before its first one is as far away as the next one. `log`
// and `settings` are those that the plan was made of.
void join_plan(FramePlan& plan, std::int32_t frame_before, const GazeLog& log, const PlanSettings& settings);

// "50.0 ms in the median, mean 50.1, ...": one line.
std::string gaze_ages_text(const GazeAges& ages);
std::string plan_as_table(const FramePlan& plan);
std::string plan_as_json(const FramePlan& plan);

}  // namespace gazetrace
