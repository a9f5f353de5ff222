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

namespace gazetrace {

// Frames per second as a fraction, so that frame times are exact integers' quotients: 24000/1001.
struct FrameRate {
  std::int64_t numerator = 24;
  std::int64_t denominator = 1;
  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};
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

struct PlanSettings {
  std::vector<std::int32_t> frames;
  Shutter shutter;
  FrameRate fps;
  std::int64_t start_ns = 0;  // video time at which frame 1 begins
  CameraExtrapolation camera_extrapolation = CameraExtrapolation::error;
  GazeMapping gaze;
  std::int64_t gaze_latency_ns = 0;  // gaze_render is the gaze this long ago; gaze_true stays
  int width_px = 1280, height_px = 720;
  std::optional<DisplayGeometry> display;  // required for a screen log
  FrameRect frame_rect;                    // default: the whole display
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
  // In the eye's frame; empty: no gaze, render uniformly.
  std::optional<Vec3d> gaze_direction_render, gaze_direction_true;
};

struct FramePlan {
  std::vector<FrameRequest> frames;
  Warnings warnings;
};

// Without a log (nullptr) every frame is rendered without gaze. Error(input) when the camera path does not cover a
// frame, when a screen log has no display, when NoGazePolicy::error meets a gap.
FramePlan plan_frames(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings);

std::string plan_as_table(const FramePlan& plan);
std::string plan_as_json(const FramePlan& plan);

}  // namespace gazetrace
