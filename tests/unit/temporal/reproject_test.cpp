// SPDX-License-Identifier: Apache-2.0
// Reprojected accumulation by hand: what is carried, what is refused, and what it weighs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "gazetrace/temporal.hpp"
#include "support/reconstruct.hpp"
#include "support/reproject_wall.hpp"

namespace gazetrace {
namespace {

using namespace test;

TEST(Reproject, TheFirstFramePassesThroughToTheBit) {
  TemporalHistory history;
  Frame frame = frame_of([](int x, int y) { return 0.1 * x + 0.7 * y; }, 3, 2);
  const Frame out = pass(frame, wall(), all_kept(), history);
  EXPECT_EQ(out.radiance, frame.radiance);
  EXPECT_EQ(out.sample_count, frame.sample_count);
  EXPECT_EQ(out.variance, frame.variance);
}

TEST(Reproject, WhatStandsStillIsTheRunningMean) {
  TemporalHistory history;
  TemporalHistory running;
  for (int k = 1; k <= 50; ++k) {
    const auto radiance = [k](int x, int y) { return std::fabs(std::sin(12.9898 * x + 78.233 * y + 37.719 * k)); };
    const auto count = static_cast<float>(1 + k % 5);
    const Frame out = pass(frame_of(radiance, count, 0.5F), wall(), all_kept(), history, k);
    const Frame expected =
        accumulate(frame_of(radiance, count, 0.5F), request_of(k), {AccumulateMode::running}, running, 1);
    for (std::size_t i = 0; i < out.radiance.pixels.size(); ++i) {
      ASSERT_NEAR(out.radiance.pixels[i].y, expected.radiance.pixels[i].y, 1e-6);
      ASSERT_FLOAT_EQ(out.sample_count.pixels[i], expected.sample_count.pixels[i]);
      ASSERT_NEAR(out.variance.pixels[i], expected.variance.pixels[i], 1e-6);
    }
  }
}

TEST(Reproject, HistoryLandsWhereItsSurfaceIs) {
  TemporalHistory history;
  (void)pass(frame_of([](int x, int y) { return 10 + x + 0.25 * y; }, 3), wall(), all_kept(), history);
  // It was three pixels to the right and one and a half below.
  const Frame out = pass(even_frame(0, 1), wall({3, 1.5}), all_kept(), history, 2);
  for (int y = 0; y < kHeight - 2; ++y) {
    for (int x = 0; x < kWidth - 3; ++x) {
      EXPECT_NEAR(value(out, x, y), 0.75 * (10 + (x + 3) + 0.25 * (y + 1.5)), 1e-5);
      EXPECT_FLOAT_EQ(out.sample_count(x, y), 4);
    }
  }
  EXPECT_EQ(value(out, kWidth - 1, 3), 0.0) << "came in at the side";
  EXPECT_EQ(out.sample_count(kWidth - 1, 3), 1.0F);
}

TEST(Reproject, WhatWasHiddenOrIsAnotherThingBeginsAnew) {
  struct Refusal {
    const char* name;
    std::function<void(SurfaceMotion&)> change;
  };
  const Refusal refusals[] = {
      {"another object", [](SurfaceMotion& m) { m.object(4, 4) = 2; }},
      {"a miss", [](SurfaceMotion& m) { m.object(4, 4) = 0; }},
      {"nearer", [](SurfaceMotion& m) { m.other_depth_m(4, 4) = 1.9F; }},
      {"farther", [](SurfaceMotion& m) { m.other_depth_m(4, 4) = 2.1F; }},
      {"turned",
       [](SurfaceMotion& m) {
         m.other_normal(4, 4) = {std::sqrt(0.5F), 0, std::sqrt(0.5F)};
       }},
      {"behind the camera", [](SurfaceMotion& m) { m.other_px(4, 4).x = std::numeric_limits<double>::quiet_NaN(); }},
      {"beside the frame", [](SurfaceMotion& m) { m.other_px(4, 4).y = -3; }},
  };
  for (const Refusal& refusal : refusals) {
    TemporalHistory history;
    (void)pass(even_frame(5, 8), wall(), all_kept(), history);
    SurfaceMotion motion = wall();
    refusal.change(motion);
    const Frame out = pass(even_frame(1, 1), motion, all_kept(), history, 2);
    EXPECT_EQ(value(out, 4, 4), 1.0) << refusal.name;
    EXPECT_EQ(out.sample_count(4, 4), 1.0F) << refusal.name;
    EXPECT_EQ(out.sample_count(5, 4), 9.0F) << refusal.name;
  }
}

TEST(Reproject, APlaneSeenAtASlantIsStillThatPlane) {
  // Depths of neighbors differ by more than the tolerance; what counts is the distance to the plane.
  SurfaceMotion motion = wall({0.5, 0});
  const PixelProjection view(Camera{}, kWidth, kHeight);
  const Vec3d normal = normalize(Vec3d{-0.97, 0, 0.24});
  const Vec2d center{kWidth / 2.0, kHeight / 2.0};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      motion.depth_m(x, y) = static_cast<float>(view.depth_on_plane(center, 2, normal, {x + 0.5, y + 0.5}));
      motion.other_depth_m(x, y) = static_cast<float>(view.depth_on_plane(center, 2, normal, motion.other_px(x, y)));
      motion.normal(x, y) = motion.other_normal(x, y) = to_float(normal);
    }
  }
  ASSERT_GT(std::fabs(motion.depth_m(9, 4) / motion.depth_m(8, 4) - 1), 0.05F);
  TemporalHistory history;
  (void)pass(even_frame(5, 8), motion, all_kept(), history);
  EXPECT_FLOAT_EQ(pass(even_frame(1, 1), motion, all_kept(), history, 2).sample_count(8, 4), 9.0F);
}

TEST(Reproject, WhatWasFovealKeepsItsWorth) {
  AccumulateSettings settings = all_kept();
  settings.frames = 16;
  TemporalHistory history;
  (void)pass(even_frame(4, 32, 1), wall(), settings, history);
  const Frame out = pass(even_frame(1, 0.5F, 9), wall(), settings, history, 2, 4);
  EXPECT_FLOAT_EQ(out.sample_count(7, 7), 30.5F);
  EXPECT_NEAR(value(out, 7, 7), (30 * 4 + 0.5 * 1) / 30.5, 1e-6);
  EXPECT_NEAR(out.variance(7, 7), (30 * 30 * 1 + 0.25 * 9) / (30.5 * 30.5), 1e-6);
}

TEST(Reproject, CoarseHistoryHardlyCountsForAFinePixel) {
  TemporalHistory history;
  (void)pass(even_frame(4, 8), wall(), all_kept(), history, 1, 4);
  const Frame out = pass(even_frame(1, 8), wall(), all_kept(), history, 2, 1);
  EXPECT_FLOAT_EQ(out.sample_count(7, 7), 8.5F);  // 8 / 4^2 of the past
  // What is left of it in the sums is remembered as coarse.
  EXPECT_NEAR(history.surfaces.footprint_px(7, 7), (8 * 1 + 0.5 * 4) / 8.5, 1e-6);
}

TEST(Reproject, NoPixelIsWorthLessThanItsOwnFrame) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  TemporalHistory history;
  for (int k = 1; k <= 8; ++k) {
    const auto count = static_cast<float>(k % 3);
    const Frame out = pass(frame_of([k](int x, int y) { return (x * y * k) % 7; }, count, 1), wall({0.3 * k, -0.2}),
                           settings, history, k, k % 2 == 0 ? 4 : 1);
    for (const float worth : out.sample_count.pixels) {
      EXPECT_GE(worth, count);
    }
  }
}

TEST(Reproject, ThePastFadesAsStated) {
  AccumulateSettings settings = all_kept();
  settings.frames = 10;
  TemporalHistory history;
  int k = 0;
  for (; k < 200; ++k) {
    (void)pass(even_frame(1, 2), wall(), settings, history, k + 1);
  }
  EXPECT_NEAR(history.count_sum(3, 3), 20, 1e-6);  // memory times a frame's samples
  // The light goes out: of the old picture 0.9^n is left after n frames.
  for (int n = 1; n <= 30; ++n) {
    EXPECT_NEAR(value(pass(even_frame(0, 2), wall(), settings, history, k + n), 5, 5), std::pow(0.9, n), 1e-6);
  }
}

// Even in -1..1, of a place and a frame.
double hash_noise(int x, int y, int k, double salt) {
  const double value = std::sin(12.9898 * x + 78.233 * y + 37.719 * k + salt) * 43758.5453;
  return 2 * (value - std::floor(value)) - 1;
}

// Squared errors in the middle of frames 8 to 24, without accumulation and with it: a picture that glides by a part of
// a pixel each frame, under noise.
struct Errors {
  double alone = 0, accumulated = 0;
};
Errors gliding_errors(const std::function<double(double u, double v)>& picture, double noise, const Vec2d& shift) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  TemporalHistory history;
  Errors errors;
  for (int k = 1; k <= 24; ++k) {
    const auto truth = [&](int x, int y) { return picture(x + k * shift.x, y + k * shift.y); };
    const Frame frame = frame_of([&](int x, int y) { return truth(x, y) + noise * hash_noise(x, y, k, 0.5); }, 32,
                                 static_cast<float>(noise * noise / 3 * 0.5883 * 0.5883));
    const Frame out = pass(frame, wall(shift), settings, history, k);
    if (k >= 8) {
      for (int y = 3; y < kHeight - 3; ++y) {
        for (int x = 3; x < kWidth - 4; ++x) {
          errors.alone += std::pow(value(frame, x, y) - truth(x, y), 2);
          errors.accumulated += std::pow(value(out, x, y) - truth(x, y), 2);
        }
      }
    }
  }
  return errors;
}

TEST(Reproject, TextureThatGlidesIsNotBlurredBeyondTheNoise) {
  const auto waves = [](double contrast, double period_px) {
    return [=](double u, double v) {
      return 1 + contrast * std::sin(2 * kPi * u / period_px) * std::cos(2 * kPi * v / (1.3 * period_px));
    };
  };
  for (const double noise : {0.01, 0.03, 0.1}) {
    for (const double contrast : {0.05, 0.2, 0.8}) {
      for (const double period_px : {2.5, 4.0, 8.0, 20.0}) {
        for (const Vec2d shift : {Vec2d{0.37, -0.21}, Vec2d{0.5, 0.5}, Vec2d{0.08, 0.03}}) {
          const Errors errors = gliding_errors(waves(contrast, period_px), noise, shift);
          EXPECT_LE(errors.accumulated, 1.001 * errors.alone)
              << "noise " << noise << ", contrast " << contrast << ", period " << period_px << " px, " << shift.x
              << " px a frame";
        }
      }
    }
  }
  // What has no texture loses noise all the same.
  const Errors flat = gliding_errors([](double, double) { return 1.0; }, 0.1, {0.37, -0.21});
  EXPECT_LT(flat.accumulated, 0.3 * flat.alone);
}

// A body of twice the wall's light covers the columns up to the fourth, and a third of the fifth.
Frame body_before_wall(int covered, double part_of_next) {
  return frame_of([=](int x, int) { return x <= covered       ? 2.0
                                           : x == covered + 1 ? 1 + part_of_next
                                                              : 1.0; }, 32,
                  1e-4F);
}

SurfaceMotion with_body(SurfaceMotion motion, int covered, double moved_px) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x <= covered; ++x) {
      motion.object(x, y) = 2;
      motion.other_px(x, y).x += moved_px;
    }
  }
  return motion;
}

TEST(Reproject, ABodyThatMovesOnLeavesNoTrailOfItsEdge) {
  TemporalHistory history;
  (void)pass(body_before_wall(4, 1 / 3.0), with_body(wall(), 4, 0), all_kept(), history);
  // The wall's pixel beside the body had a third of the body's light, and now it has none, or a tenth.
  TemporalHistory as_it_was = history;
  const Frame gone = pass(body_before_wall(2, 0.1), with_body(wall(), 2, 2), all_kept(), history, 2);
  EXPECT_NEAR(value(gone, 5, 5), 1, 0.01) << "one standard deviation of the frame";
  EXPECT_GE(gone.sample_count(8, 5), 63) << "the wall beyond keeps its past";
  const Frame slid = pass(body_before_wall(4, 0.1), with_body(wall(), 4, 0.23), all_kept(), as_it_was, 2);
  EXPECT_NEAR(value(slid, 5, 5), 1.1, 0.01);
}

TEST(Reproject, TheEdgeOfABodyAtRestKeepsItsPast) {
  TemporalHistory history;
  (void)pass(body_before_wall(4, 1 / 3.0), with_body(wall(), 4, 0), all_kept(), history);
  const Frame rests = pass(body_before_wall(4, 0.1), with_body(wall(), 4, 0), all_kept(), history, 2);
  EXPECT_NEAR(value(rests, 5, 5), 1 + 0.5 * (1 / 3.0 + 0.1), 1e-5) << "the mean of both, as they were sampled";
  EXPECT_FLOAT_EQ(rests.sample_count(5, 5), 64);
}

TEST(Reproject, AHistoryThatGetsBetterIsNotDropped) {
  // 0, then 1 and 1: off by 1, then by half of it, under a noise far above. What two frames differ by is noise as well.
  AccumulateSettings settings = all_kept();
  TemporalHistory history;
  Frame out;
  for (int k = 1; k <= 3; ++k) {
    out = pass(even_frame(k == 1 ? 0 : 1, 8, 1), wall({0.5, 0.25}), settings, history, k);
  }
  EXPECT_GT(out.sample_count(7, 5), 8.2F);
  EXPECT_LT(out.sample_count(7, 5), 24.0F);
}

TEST(Reproject, ALightThatGoesOutIsForgottenWithinThreeFrames) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  TemporalHistory history;
  const auto noisy = [](int k, double level) {
    return frame_of(
        [=](int x, int y) {
          const double noise = std::sin(12.9898 * x + 78.233 * y + 37.719 * k) * 43758.5453;
          return level * (0.5 + noise - std::floor(noise));
        },
        4, static_cast<float>(level * level / 48));
  };
  for (int k = 1; k <= 60; ++k) {
    (void)pass(noisy(k, 10), wall(), settings, history, k);
  }
  double mean = 0;
  for (int k = 61; k <= 63; ++k) {
    const Frame out = pass(noisy(k, 1), wall(), settings, history, k);
    mean = 0;
    for (const Vec3f& pixel : out.radiance.pixels) {
      mean += static_cast<double>(pixel.x) / (kWidth * kHeight);
    }
  }
  EXPECT_NEAR(mean, 1, 0.05);
  settings.clip_sigmas = 0;
  TemporalHistory unclipped;
  for (int k = 1; k <= 63; ++k) {
    mean = value(pass(even_frame(k <= 60 ? 10 : 1, 4), wall(), settings, unclipped, k), 5, 5);
  }
  EXPECT_GT(mean, 7) << "clipping had nothing to do";
}

TEST(Reproject, AFixedBlendIsTheExponentialAverage) {
  AccumulateSettings settings = all_kept();
  settings.blend = 0.1;
  TemporalHistory history;
  double expected = 3;
  (void)pass(even_frame(3, 2), wall(), settings, history);
  for (int k = 2; k < 40; ++k) {
    expected += 0.1 * (k % 4 - expected);
    EXPECT_NEAR(value(pass(even_frame(k % 4, 7), wall(), settings, history, k), 2, 2), expected, 1e-5);
  }
}

TEST(Reproject, AThousandFramesDoNotDrift) {
  AccumulateSettings settings = all_kept();
  settings.frames = 16;
  settings.clip_sigmas = 3;
  TemporalHistory history;
  for (int k = 1; k <= 1000; ++k) {
    const Frame out = pass(even_frame(0.1, 2, 0.25F), wall({0.37, -0.21}), settings, history, k);
    ASSERT_NEAR(value(out, 5, 5), 0.1F, 2e-8) << k;
  }
  // In the middle the sums are those of the geometric series.
  EXPECT_LE(history.count_sum(2, 9), 32 + 1e-9);
  EXPECT_GT(history.count_sum(2, 9), 20);
}

void expect_finite(const Frame& frame, const TemporalHistory& history, int number) {
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    const Vec3f& pixel = frame.radiance.pixels[i];
    ASSERT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z)) << number;
    ASSERT_TRUE(std::isfinite(frame.variance.pixels[i]) && std::isfinite(history.radiance_sum.pixels[i].x)) << number;
  }
}

// In the dark what is left of the past halves from frame to frame, until its square is none: after 600 of them.
TEST(Reproject, ThousandsOfBlackFramesStayFinite) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  settings.frames = 2;
  TemporalHistory history;
  for (int k = 1; k <= 4000; ++k) {
    const Frame out = pass(k <= 3 ? even_frame(1, 4, 0.5F) : even_frame(0, 4), wall(), settings, history, k);
    expect_finite(out, history, k);
  }
}

// A neighborhood that is black but for the least light there is leaves next to nothing of a bright past.
TEST(Reproject, APastThatIsContradictedBeyondNumbersStaysFinite) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  for (const double blend : {0.0, 0.1}) {
    settings.blend = blend;
    TemporalHistory history;
    const auto spark = [](int x, int y) { return x == 8 && y == 6 ? 1e-38 : 0.0; };
    int k = 0;
    for (int round = 0; round < 4; ++round) {
      for (const Frame& frame : {even_frame(1, 0.0625F), even_frame(1, 0.0625F), frame_of(spark, 0.0625F),
                                 even_frame(0, 0.0625F), frame_of(spark, 0.0625F), frame_of(spark, 0)}) {
        const Frame out = pass(frame, wall(), settings, history, ++k);
        expect_finite(out, history, k);
      }
    }
  }
}

// One sample of one pixel does not tell how far the next one may be off: the past is kept.
TEST(Reproject, APixelAloneIsNotHeldAgainstItself) {
  AccumulateSettings settings = all_kept();
  settings.clip_sigmas = 3;
  TemporalHistory history;
  SurfaceMotion motion = wall();
  motion.object(8, 6) = 2;
  Frame out;
  for (int k = 1; k <= 16; ++k) {
    out = pass(frame_of([k](int x, int y) { return x == 8 && y == 6 ? k % 2 : 0.5; }, 1), motion, settings, history, k);
  }
  EXPECT_FLOAT_EQ(out.sample_count(8, 6), 16);
  EXPECT_NEAR(value(out, 8, 6), 0.5, 1e-6);
}

TEST(Reproject, ACutForgetsEverything) {
  const auto after = [](const std::function<void(FrameRequest&)>& change) {
    TemporalHistory history;
    (void)pass(even_frame(5, 8), wall(), all_kept(), history);
    FrameRequest request = request_of(2);
    change(request);
    const Frame out = reproject(even_frame(1, 1), map_of(), wall(), request, all_kept(), history, 1);
    EXPECT_EQ(history.frames, out.sample_count(3, 3) == 1.0F ? 1 : 2);
    return out.sample_count(3, 3);
  };
  const auto turn = [](double degrees) {
    return [degrees](FrameRequest& r) {
      const double half = degrees * kRadPerDeg / 2;
      r.camera.pose.orientation = {0, std::sin(half), 0, std::cos(half)};
    };
  };
  EXPECT_EQ(after([](FrameRequest&) {}), 9.0F);
  EXPECT_EQ(after(turn(19)), 9.0F);
  EXPECT_EQ(after(turn(21)), 1.0F);
  EXPECT_EQ(after([](FrameRequest& r) { r.camera.pose.position_m = {0.9, 0, 0}; }), 9.0F);
  EXPECT_EQ(after([](FrameRequest& r) { r.camera.pose.position_m = {1.1, 0, 0}; }), 1.0F);
  EXPECT_EQ(after([](FrameRequest& r) { r.camera.projection.yfov_rad *= 1.01; }), 1.0F);
}

TEST(Reproject, SaccadesAndBlinksForgetWhereAsked) {
  for (const EyeMovement movement : {EyeMovement::fixation, EyeMovement::saccade, EyeMovement::blink}) {
    for (const bool asked : {false, true}) {
      AccumulateSettings settings = all_kept();
      settings.reset_at_saccades = settings.reset_at_blinks = asked;
      TemporalHistory history;
      (void)pass(even_frame(5, 8), wall(), settings, history);
      FrameRequest request = request_of(2);
      request.saccade_since_last_frame = movement == EyeMovement::saccade;
      request.blink_since_last_frame = movement == EyeMovement::blink;
      const Frame out = reproject(even_frame(1, 1), map_of(), wall(), request, settings, history, 1);
      EXPECT_EQ(out.sample_count(3, 3), asked && movement != EyeMovement::fixation ? 1.0F : 9.0F);
    }
  }
}

TEST(Reproject, SitesOfAFrameAreTheSitesItWasMadeOf) {
  const SamplingMap map = map_of(4);
  SparseFrame sparse;
  sparse.width_px = kWidth;
  sparse.height_px = kHeight;
  for (std::size_t s = 0; s < map.sites.size(); ++s) {
    const auto n = static_cast<float>(map.sites[s].samples);
    const auto mean = static_cast<float>(1 + s % 7);
    sparse.sum.push_back(Vec3f{mean, mean / 2, mean / 4} * n);
    const float luminance = 0.2126F * mean + 0.7152F * mean / 2 + 0.0722F * mean / 4;
    sparse.sum_square_luminance.push_back(n * (luminance * luminance + 0.5F));
    sparse.count.push_back(map.sites[s].samples);
  }
  const SparseFrame again = sites_of_frame(reconstruct(sparse, map, "none", 1), sparse, map);
  EXPECT_EQ(again.count, sparse.count);
  const Frame expected = reconstruct(sparse, map, "linear", 1);
  const Frame out = reconstruct(again, map, "linear", 1);
  for (std::size_t i = 0; i < out.radiance.pixels.size(); ++i) {
    EXPECT_NEAR(out.radiance.pixels[i].x, expected.radiance.pixels[i].x, 1e-5);
    EXPECT_NEAR(out.variance.pixels[i], expected.variance.pixels[i], 1e-5);
  }
}

}  // namespace
}  // namespace gazetrace
