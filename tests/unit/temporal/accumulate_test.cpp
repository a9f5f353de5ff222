// SPDX-License-Identifier: Apache-2.0
// Running means by hand, and when they start again.
#include <gtest/gtest.h>

#include <optional>

#include "gazetrace/temporal.hpp"

namespace gazetrace {
namespace {

Frame frame_of(int width, int height, float radiance, float count, float variance = 0) {
  Frame frame;
  frame.radiance = ImageRgb(width, height, Vec3f{radiance, radiance / 3, 0});
  frame.sample_count = ImageGray(width, height, count);
  frame.variance = ImageGray(width, height, variance);
  frame.albedo = ImageRgb(width, height, Vec3f{radiance, 0, 0});
  frame.normal = ImageRgb(width, height);
  frame.depth_m = ImageGray(width, height, radiance);
  return frame;
}

constexpr AccumulateSettings kRunning{AccumulateMode::running};

TEST(Accumulate, WeighsFramesByTheirSamples) {
  TemporalHistory history;
  const FrameRequest request;
  Frame frame = frame_of(3, 2, 0.1F, 4, 6);
  frame.radiance(1, 1) = {1e-30F, 7, 3e38F};
  const Frame first = accumulate(frame, request, kRunning, history, 1);
  EXPECT_EQ(first.radiance, frame.radiance);  // to the bit
  EXPECT_EQ(first.sample_count, frame.sample_count);
  EXPECT_EQ(first.variance, frame.variance);

  const Frame second = accumulate(frame_of(3, 2, 0.9F, 12, 2), request, kRunning, history, 1);
  EXPECT_FLOAT_EQ(second.radiance(0, 0).x, 0.7F);  // (4 * 0.1 + 12 * 0.9) / 16
  EXPECT_EQ(second.sample_count(0, 0), 16.0F);
  EXPECT_FLOAT_EQ(second.variance(0, 0), 384.0F / 256);  // (16 * 6 + 144 * 2) / 16^2
  EXPECT_EQ(second.albedo(0, 0).x, 0.9F);                // guides are the current frame's
  EXPECT_EQ(second.depth_m(0, 0), 0.9F);

  const Frame third = accumulate(frame_of(3, 2, 0.0F, 16, 0), request, kRunning, history, 2);
  EXPECT_FLOAT_EQ(third.radiance(0, 0).x, 0.35F);
  EXPECT_EQ(history.frames, 3);
}

TEST(Accumulate, TheSameFrameAgainChangesNothingButItsCount) {
  TemporalHistory history;
  const Frame frame = frame_of(5, 1, 0.3F, 7);
  Frame out;
  for (int i = 0; i < 4; ++i) {
    out = accumulate(frame, {}, kRunning, history, 1);
  }
  EXPECT_EQ(out.radiance, frame.radiance);
  EXPECT_EQ(out.sample_count(2, 0), 28.0F);
}

TEST(Accumulate, UnsampledPixelsKeepTheCurrentFrameUntilTheyAreSampled) {
  TemporalHistory history;
  EXPECT_EQ(accumulate(frame_of(1, 1, 5, 0), {}, kRunning, history, 1).radiance(0, 0).x, 5.0F);
  EXPECT_EQ(accumulate(frame_of(1, 1, 6, 0), {}, kRunning, history, 1).radiance(0, 0).x, 6.0F);
  EXPECT_EQ(accumulate(frame_of(1, 1, 8, 2), {}, kRunning, history, 1).radiance(0, 0).x, 8.0F);
  EXPECT_EQ(accumulate(frame_of(1, 1, 99, 0), {}, kRunning, history, 1).radiance(0, 0).x, 8.0F);
}

TEST(Accumulate, AnyChangeOfCameraOrSizeStartsAgain) {
  const FrameRequest still;
  FrameRequest moved = still;
  moved.camera.pose.position_m.x = 1e-12;
  FrameRequest turned = still;
  turned.camera.pose.orientation = {0, 1, 0, 0};
  FrameRequest zoomed = still;
  zoomed.camera.projection.yfov_rad *= 1.0001;
  FrameRequest clipped = still;
  clipped.camera.projection.near_m = 0.1;
  for (const FrameRequest& changed : {moved, turned, zoomed, clipped}) {
    TemporalHistory history;
    history.smoothed_ev = 2.5;
    (void)accumulate(frame_of(2, 2, 1, 1), still, kRunning, history, 1);
    EXPECT_EQ(accumulate(frame_of(2, 2, 3, 1), changed, kRunning, history, 1).radiance(0, 0).x, 3.0F);
    EXPECT_EQ(history.frames, 1);
    EXPECT_EQ(accumulate(frame_of(2, 2, 5, 1), changed, kRunning, history, 1).radiance(0, 0).x, 4.0F);
    EXPECT_EQ(history.smoothed_ev, std::optional<double>(2.5));
  }
  TemporalHistory history;
  (void)accumulate(frame_of(2, 3, 1, 1), still, kRunning, history, 1);
  const Frame resized = accumulate(frame_of(3, 2, 3, 1), still, kRunning, history, 1);
  EXPECT_EQ(resized.radiance, frame_of(3, 2, 3, 1).radiance);
  EXPECT_EQ(history.radiance_sum.width_px, 3);
  EXPECT_EQ(history.frames, 1);
}

TEST(Accumulate, GazeAndTimeMayChange) {
  TemporalHistory history;
  FrameRequest request;
  (void)accumulate(frame_of(1, 1, 1, 1), request, kRunning, history, 1);
  request.frame = 2;
  request.t_video_ns = 40'000'000;
  request.gaze_direction_render = Vec3d{0.1, 0, -1};
  EXPECT_EQ(accumulate(frame_of(1, 1, 3, 1), request, kRunning, history, 1).radiance(0, 0).x, 2.0F);
}

TEST(Accumulate, OffLeavesFrameAndHistoryAlone) {
  TemporalHistory history;
  for (const float value : {1.0F, 3.0F}) {
    EXPECT_EQ(accumulate(frame_of(1, 1, value, 1), {}, {}, history, 1).radiance(0, 0).x, value);
  }
  EXPECT_EQ(history.frames, 0);
  EXPECT_TRUE(history.radiance_sum.empty());
}

}  // namespace
}  // namespace gazetrace
