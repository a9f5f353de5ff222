// SPDX-License-Identifier: Apache-2.0
// Which windows of a frame are judged, and for how much of it they stand.
#include "pipeline/quality/judged_windows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "gazetrace/foveation.hpp"

namespace gazetrace::judged_windows_test {
namespace {

// With so many pixels a degree on the axis.
PlanarView view_of(int width_px, int height_px, double pixels_per_degree) {
  PlanarView view;
  view.width_px = width_px;
  view.height_px = height_px;
  view.step_x = view.step_y = kRadPerDeg / pixels_per_degree;
  view.left = -0.5 * width_px * view.step_x;
  view.top = 0.5 * height_px * view.step_y;
  return view;
}

const PlanarView kHeadset = view_of(1131, 1209, 13);

TEST(JudgedWindows, StandForTheWholeFrame) {
  for (const PlanarView& view : {kHeadset, view_of(1708, 961, 28), view_of(3840, 2160, 60)}) {
    for (const bool moves : {false, true}) {
      const JudgedWindows chosen = judged_windows(view, {{400.5, 300.5}}, moves);
      ASSERT_FALSE(chosen.is_whole_frame());
      const double area = static_cast<double>(view.width_px) * view.height_px;
      const double sum = std::accumulate(chosen.weights.pixels.begin(), chosen.weights.pixels.end(), 0.0);
      EXPECT_NEAR(sum / area, 1, 1e-4);
      EXPECT_GE(chosen.windows.size(), 8U);
      EXPECT_LT(chosen.share_of(view), moves ? 0.4 : 0.15);
    }
  }
}

TEST(JudgedWindows, TheFoveaStandsForItself) {
  const Vec2d gaze{900.25, 200.75};
  const JudgedWindows chosen = judged_windows(kHeadset, {gaze, {901, 202}});
  EXPECT_EQ(chosen.weights(900, 200), 1.0F);
  int foveae = 0;
  for (const JudgedWindow& window : chosen.windows) {
    foveae += chosen.weights(window.counted.x_px, window.counted.y_px) == 1.0F ? 1 : 0;
  }
  EXPECT_EQ(foveae, 1) << "gazes a pixel apart share a window";
  EXPECT_EQ(judged_windows(kHeadset, {{-5, 10}}).weights.pixels.size(), kHeadset.width_px * std::size_t{1209})
      << "a gaze beside the frame has no window";
}

TEST(JudgedWindows, LieInTheFrameApartAndOnTheGridOfBlocks) {
  const JudgedWindows chosen = judged_windows(kHeadset, {{3, 3}, {1130.5, 1208.5}});
  for (std::size_t k = 0; k < chosen.windows.size(); ++k) {
    const JudgedWindow& window = chosen.windows[k];
    EXPECT_EQ(window.traced.x_px % kDefaultMaxBlockPx, 0);
    EXPECT_EQ(window.traced.y_px % kDefaultMaxBlockPx, 0);
    EXPECT_GE(window.traced.x_px, 0);
    EXPECT_GE(window.traced.y_px, 0);
    EXPECT_LE(window.traced.right_px(), kHeadset.width_px);
    EXPECT_LE(window.traced.bottom_px(), kHeadset.height_px);
    // A margin on every side but at the frame's border.
    EXPECT_EQ(window.traced.x_px == window.counted.x_px, window.traced.x_px == 0);
    EXPECT_EQ(window.traced.bottom_px() == window.counted.bottom_px(), window.traced.bottom_px() == kHeadset.height_px);
    for (std::size_t other = 0; other < k; ++other) {
      EXPECT_FALSE(window.traced.overlaps(chosen.windows[other].traced));
    }
  }
}

TEST(JudgedWindows, AGazeAtTheBorderHasOneWindowThatCounts) {
  for (const Vec2d& gaze : {Vec2d{0.5, 0.5}, Vec2d{1130.5, 1208.5}, Vec2d{1.5, 600}, Vec2d{600, 1207}}) {
    const JudgedWindows chosen = judged_windows(kHeadset, {gaze, gaze, gaze});
    EXPECT_EQ(chosen.weights(static_cast<int>(gaze.x), static_cast<int>(gaze.y)), 1.0F);
    EXPECT_TRUE(chosen.windows[1].counted.x_px != chosen.windows[0].counted.x_px ||
                chosen.windows[1].counted.y_px != chosen.windows[0].counted.y_px);
  }
}

TEST(JudgedWindows, SmallFramesAreJudgedWhole) {
  const JudgedWindows chosen = judged_windows(view_of(160, 90, 12), {{80, 45}});
  EXPECT_TRUE(chosen.is_whole_frame());
  ASSERT_EQ(chosen.windows.size(), 1U);
  EXPECT_EQ(chosen.windows[0].counted.width_px, 160);
  EXPECT_EQ(chosen.share_of(view_of(160, 90, 12)), 1);
}

TEST(JudgedWindows, HaveTheirLargestSideWhateverAScreenIsSaidToBe) {
  const JudgedWindows fine = judged_windows(view_of(3840, 2160, 1e3), {{400, 300}});
  for (const double pixels_per_degree : {1e9, 1e18, 1e300}) {
    const JudgedWindows chosen = judged_windows(view_of(3840, 2160, pixels_per_degree), {{400, 300}});
    ASSERT_EQ(chosen.windows.size(), fine.windows.size()) << pixels_per_degree;
    for (std::size_t k = 0; k < fine.windows.size(); ++k) {
      EXPECT_EQ(chosen.windows[k].traced.width_px, fine.windows[k].traced.width_px) << pixels_per_degree;
    }
  }
}

}  // namespace
}  // namespace gazetrace::judged_windows_test
