// SPDX-License-Identifier: Apache-2.0
// A wall that fills the view and moves sideways, for tests of reprojected accumulation.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "gazetrace/temporal.hpp"

namespace gazetrace::test {

inline constexpr int kWidth = 16, kHeight = 12;

// A wall at 2 m that fills the view, and that was `shift` pixels farther to the right before.
inline SurfaceMotion wall(const Vec2d& shift = {0, 0}) {
  SurfaceMotion motion;
  motion.depth_m = ImageGray(kWidth, kHeight, 2.0F);
  motion.normal = ImageRgb(kWidth, kHeight, {0, 0, 1});
  motion.object = Image<std::uint32_t>(kWidth, kHeight, 1);
  motion.other_px = Image<Vec2d>(kWidth, kHeight);
  motion.other_depth_m = motion.depth_m;
  motion.other_normal = motion.normal;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      motion.other_px(x, y) = {x + 0.5 + shift.x, y + 0.5 + shift.y};
    }
  }
  return motion;
}

inline Frame frame_of(const std::function<double(int x, int y)>& radiance, float count, float variance = 0) {
  Frame frame;
  frame.radiance = ImageRgb(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto value = static_cast<float>(radiance(x, y));
      frame.radiance(x, y) = {value, value / 2, value / 4};
    }
  }
  frame.sample_count = ImageGray(kWidth, kHeight, count);
  frame.variance = ImageGray(kWidth, kHeight, variance);
  return frame;
}
inline Frame even_frame(double radiance, float count, float variance = 0) {
  return frame_of([=](int, int) { return radiance; }, count, variance);
}

// A map with one site per pixel, or per block.
inline SamplingMap map_of(int block_px = 1) {
  FoveationSettings settings;
  settings.sampling = RegionSampling{};
  std::get<RegionSampling>(settings.sampling).blocks_px = {block_px, block_px};
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = {0.0005, 0.001};
  const PlanarView view = view_of_perspective(50 * kRadPerDeg, kWidth, kHeight);
  // The gaze is far aside, so that everything is periphery.
  return block_px == 1 ? make_sampling_map(FoveationSettings{}, view, {})
                       : make_sampling_map(settings, view, view.direction(-1e4, -1e4));
}

inline AccumulateSettings all_kept() {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  settings.frames = 0;
  settings.clip_sigmas = 0;
  return settings;
}

inline FrameRequest request_of(std::int32_t frame) {
  FrameRequest request;
  request.frame = frame;
  request.t_video_ns = std::int64_t{frame} * 41'666'666;
  request.width_px = kWidth;
  request.height_px = kHeight;
  return request;
}

inline Frame pass(Frame frame, const SurfaceMotion& motion, const AccumulateSettings& settings,
                  TemporalHistory& history, std::int32_t number = 1, int block_px = 1) {
  return reproject(std::move(frame), map_of(block_px), motion, request_of(number), settings, history, 2);
}

inline double value(const Frame& frame, int x, int y) {
  return static_cast<double>(frame.radiance(x, y).x);
}

}  // namespace gazetrace::test
