// SPDX-License-Identifier: Apache-2.0
// Maps as pictures, and where gaze and regions are drawn over them.
#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/compare.hpp"

namespace gazetrace::error_map_test {
namespace {

std::array<int, 3> pixel(const DisplayImage& picture, int x, int y) {
  const auto at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) + static_cast<std::size_t>(x));
  return {picture.bytes[at], picture.bytes[at + 1], picture.bytes[at + 2]};
}

using Rgb = std::array<int, 3>;

TEST(ErrorMap, MagmaByMetric) {
  EXPECT_EQ(pixel(error_map_picture("flip", ImageGray(1, 1, 0)), 0, 0), (Rgb{0, 0, 4}));
  EXPECT_EQ(pixel(error_map_picture("flip", ImageGray(1, 1, 1)), 0, 0), (Rgb{252, 253, 191}));
  const auto half = magma(0.5);
  const Rgb middle{half[0], half[1], half[2]};
  EXPECT_EQ(pixel(error_map_picture("mse", ImageGray(1, 1, 0.25F)), 0, 0), middle);
  EXPECT_EQ(pixel(error_map_picture("smape", ImageGray(1, 1, 1)), 0, 0), middle);
  EXPECT_EQ(pixel(error_map_picture("temporal_bias", ImageGray(1, 1, 0.5F)), 0, 0), middle);
}

// The border that SSIM does not score is not shown as an error.
TEST(ErrorMap, UnscoredBorderIsDark) {
  const DisplayImage picture = error_map_picture("ssim", ImageGray(30, 20, 0));
  EXPECT_EQ(pixel(picture, 4, 10), (Rgb{0, 0, 4}));
  EXPECT_EQ(pixel(picture, 5, 10), (Rgb{252, 253, 191}));
  EXPECT_EQ(pixel(picture, 24, 14), (Rgb{252, 253, 191}));
  EXPECT_EQ(pixel(picture, 25, 14), (Rgb{0, 0, 4}));
  EXPECT_EQ(pixel(picture, 24, 15), (Rgb{0, 0, 4}));
}

TEST(ErrorMap, HeatLiesOverTheReferenceInGrey) {
  const ImageRgb grey(1, 1, {0.6F, 0.6F, 0.6F});
  EXPECT_EQ(pixel(error_map_picture("fovvideovdp", ImageGray(1, 1, 0), grey), 0, 0), (Rgb{153, 153, 153}));
  const Rgb red = pixel(error_map_picture("fovvideovdp", ImageGray(1, 1, 3), grey), 0, 0);
  EXPECT_GT(red[0], 5 * red[1]);
  EXPECT_EQ(pixel(error_map_picture("fovvideovdp", ImageGray(1, 1, 9), grey), 0, 0), red);
  EXPECT_EQ(pixel(error_map_picture("flicker", ImageGray(1, 1, 100), grey), 0, 0), red);
  // Squares: a quarter of ten thresholds is the same color as a quarter of 3 JOD.
  EXPECT_EQ(pixel(error_map_picture("flicker", ImageGray(1, 1, 6.25F), grey), 0, 0),
            pixel(error_map_picture("fovvideovdp", ImageGray(1, 1, 0.75F), grey), 0, 0));
  const Rgb in_the_dark = pixel(error_map_picture("fovvideovdp", ImageGray(1, 1, 3), ImageRgb(1, 1)), 0, 0);
  EXPECT_GT(in_the_dark[0], 100);
}

TEST(GazeOverlay, RingsLieAtTheirAnglesAndTheCrossAtTheGaze) {
  constexpr int kSide = 201;
  const double step = std::tan(0.1 / kDegPerRad);
  const PlanarView view{-step * kSide / 2, step * kSide / 2, step, step, kSide, kSide};
  const Vec2d gaze_px{60.5, 100.5};
  DisplayImage picture{kSide, kSide, 8, std::vector<std::uint8_t>(3UL * kSide * kSide, 128)};
  const RetinalRegions regions{{2.6, 8.5}};
  draw_gaze(picture, view, gaze_px, regions);
  const Vec3d gaze = view.direction(gaze_px.x, gaze_px.y);
  int white = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double deg = eccentricity_deg(view, gaze, x + 0.5, y + 0.5);
      const double from_ring = std::min(std::fabs(deg - 2.6), std::fabs(deg - 8.5));
      const bool in_cross = std::max(std::abs(x - 60), std::abs(y - 100)) <= 7;
      const Rgb color = pixel(picture, x, y);
      if (color == Rgb{255, 255, 255}) {
        ++white;
        EXPECT_TRUE(in_cross || from_ring < 0.1) << x << "," << y;
      } else if (!in_cross && from_ring > 0.2) {
        EXPECT_EQ(color, (Rgb{128, 128, 128})) << x << "," << y;
      }
      if (from_ring < 0.05) {
        EXPECT_EQ(color, (Rgb{255, 255, 255})) << x << "," << y;
      }
    }
  }
  EXPECT_GT(white, 400);
  EXPECT_EQ(pixel(picture, 60, 100), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(picture, 63, 100), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(picture, 62, 102), (Rgb{128, 128, 128}));
}

TEST(GazeOverlay, GazeMayLieOffThePicture) {
  const double step = std::tan(0.1 / kDegPerRad);
  const PlanarView view{-step * 50, step * 50, step, step, 100, 100};
  DisplayImage picture{100, 100, 8, std::vector<std::uint8_t>(30000, 7)};
  draw_gaze(picture, view, {-40, 50}, {{2, 6}});
  EXPECT_EQ(pixel(picture, 99, 50), (Rgb{7, 7, 7}));
  const double ring = std::atan(90 * step) * kDegPerRad - 6;  // left of the middle, in degrees
  const int column = static_cast<int>(50 - std::tan(ring / kDegPerRad) / step);
  EXPECT_EQ(pixel(picture, column, 50), (Rgb{255, 255, 255}));
}

}  // namespace
}  // namespace gazetrace::error_map_test
