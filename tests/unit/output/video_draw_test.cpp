// SPDX-License-Identifier: Apache-2.0
// Marks on frames, and what a video says of its colors. The file itself: tests/cli/video_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "gazetrace/video.hpp"

namespace gazetrace::video_draw_test {
namespace {

using testing::HasSubstr;

DisplayImage gray(int width_px, int height_px, std::uint8_t value = 128) {
  return {width_px, height_px, 8, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width_px * height_px), value)};
}

Rgb8Color at(const DisplayImage& image, int x, int y) {
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width_px) + static_cast<std::size_t>(x));
  return {image.bytes[i], image.bytes[i + 1], image.bytes[i + 2]};
}

constexpr Rgb8Color kGray{128, 128, 128};
constexpr Rgb8Color kBlack{0, 0, 0};
constexpr Rgb8Color kWhite{255, 255, 255};

TEST(VideoDraw, RingLiesAboutTheGaze) {
  DisplayImage image = gray(64, 48);
  draw_gaze_ring(image, {20.5, 30.5}, 6, 2);
  EXPECT_EQ(at(image, 20 + 6, 30), kGazeColor);
  EXPECT_EQ(at(image, 20, 30 - 6), kGazeColor);
  // What the eye looks at is seen, as is everything beyond the rim, which ends 2 px from the line's middle.
  for (const int apart : {0, 1, 2, 9}) {
    EXPECT_EQ(at(image, 20 + apart, 30), kGray) << apart;
    EXPECT_EQ(at(image, 20, 30 - apart), kGray) << apart;
  }
  DisplayImage mirrored = gray(64, 48);
  draw_gaze_ring(mirrored, {64 - 20.5, 30.5}, 6, 2);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(at(image, x, y), at(mirrored, 63 - x, y));
    }
  }
}

TEST(VideoDraw, MarksBeyondThePictureAreCutOff) {
  for (const Vec2d& gaze : {Vec2d{-3, 10}, Vec2d{63.9, 47.9}, Vec2d{1e9, -1e9}, Vec2d{std::nan(""), 3}}) {
    DisplayImage image = gray(64, 48);
    const PlanarView view = view_of_perspective(0.8, 64, 48);
    draw_gaze_ring(image, gaze, 5, 1);
    draw_fixation_mark(image, gaze, 20);
    draw_eccentricity_ring(image, view, gaze, 5, 1);
    EXPECT_EQ(image.bytes.size(), gray(64, 48).bytes.size());
  }
}

// Whatever the ring paints white has the eccentricity, by the function that measures it.
TEST(VideoDraw, RingLiesAtItsEccentricity) {
  const PlanarView view = view_of_perspective(1.2, 400, 300);
  const Vec2d gaze{90, 200};
  const Vec3d direction = view.direction(gaze.x, gaze.y);
  for (const double eccentricity : {3.0, 12.0, 25.0}) {
    DisplayImage image = gray(400, 300);
    draw_eccentricity_ring(image, view, gaze, eccentricity, 1);
    const double pixel_deg = view.step_x * kDegPerRad;
    int painted = 0;
    std::set<int> quadrants;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        if (at(image, x, y) == kGray) {
          continue;
        }
        ++painted;
        EXPECT_NEAR(eccentricity_deg(view, direction, x, y), eccentricity, 2.2 * pixel_deg) << x << " " << y;
        quadrants.insert((x > gaze.x ? 1 : 0) + (y > gaze.y ? 2 : 0));
      }
    }
    EXPECT_GT(painted, 100);
    EXPECT_EQ(quadrants.size(), eccentricity < 20 ? 4U : 3U);  // the widest leaves the picture
  }
}

TEST(VideoDraw, FixationMarkHasTheSizesOfThePaper) {
  DisplayImage image = gray(200, 200);
  draw_fixation_mark(image, {100, 100}, 100);  // 60 and 20 pixels across
  EXPECT_EQ(at(image, 100, 100), kBlack);      // the middle
  EXPECT_EQ(at(image, 100 + 8, 100), kBlack);
  EXPECT_EQ(at(image, 100 + 20, 100), kWhite);  // the cross
  EXPECT_EQ(at(image, 100, 100 - 20), kWhite);
  EXPECT_EQ(at(image, 100 + 18, 100 + 18), kBlack);  // the disc
  EXPECT_EQ(at(image, 100 + 32, 100), kGray);
}

TEST(VideoDraw, SideBySide) {
  const DisplayImage both = side_by_side(gray(3, 2, 10), gray(5, 2, 20));
  EXPECT_EQ(both.width_px, 8);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(at(both, x, y)[0], x < 3 ? 10 : 20);
    }
  }
  EXPECT_THROW(side_by_side(gray(3, 2), gray(3, 3)), Error);
}

TEST(VideoColor, FollowsFromTheDisplay) {
  EXPECT_EQ(video_color_of_view("built-in: display sRGB, view ACES SDR").name, "srgb");
  EXPECT_EQ(video_color_of_view("").name, "srgb");
  EXPECT_EQ(video_color_of_view("/a/config.ocio: display Rec.1886 Rec.709 - Display, view ACES 1.0").transfer, "bt709");
  EXPECT_EQ(video_color_of_view("c: display Display P3 - Display, view x").primaries, "smpte432");
  EXPECT_EQ(video_color_of_view("built-in: display sRGB, view Raw").name, "linear");
  EXPECT_THROW(video_color_of_view("c: display Rec.2100-PQ - Display, view x"), Error);
  try {
    video_color_of_view("c: display My Projector, view x");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("`color`"));
  }
  EXPECT_THROW(video_color_by_name("rgb"), Error);
}

TEST(VideoSettings, WhatFilesHold) {
  VideoSettings settings;
  EXPECT_NO_THROW(check_video_settings("a.mp4", settings));
  EXPECT_THROW(check_video_settings("a.avi", settings), Error);
  settings.codec = VideoCodec::ffv1;
  EXPECT_THROW(check_video_settings("a.mp4", settings), Error);
  EXPECT_NO_THROW(check_video_settings("a.mkv", settings));
  settings.crf = 52;
  EXPECT_THROW(check_video_settings("a.mkv", settings), Error);
}

}  // namespace
}  // namespace gazetrace::video_draw_test
