// SPDX-License-Identifier: Apache-2.0
// Accumulation from both sides by hand: what is taken from the frames around a frame, and what is refused.
#include "temporal/two_sided.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/reconstruct.hpp"
#include "support/reproject_wall.hpp"

namespace gazetrace {
namespace {

using namespace test;

AccumulateSettings two_sided() {
  AccumulateSettings settings = all_kept();
  settings.mode = AccumulateMode::two_sided;
  return settings;
}

struct Other {
  Frame frame;
  Vec2d shift;  // where the wall is in that frame
  int later = 1;
};

Frame joined(const Frame& own, const std::vector<Other>& others, const AccumulateSettings& settings, int block_px = 1) {
  const SamplingMap map = map_of(block_px);
  NeighbourSums sums(own, map, settings, 2);
  for (const Other& other : others) {
    sums.add(history_of_frame(other.frame, map_of(), wall(), request_of(1), 1), wall(other.shift), other.later);
  }
  return sums.joined(wall());
}

TEST(TwoSided, AFrameAloneKeepsItsBits) {
  const Frame own = frame_of([](int x, int y) { return 0.1 * x + 0.7 * y; }, 3, 2);
  const Frame out = joined(own, {}, two_sided());
  EXPECT_EQ(out.radiance, own.radiance);
  EXPECT_EQ(out.sample_count, own.sample_count);
  EXPECT_EQ(out.variance, own.variance);
}

TEST(TwoSided, WhatStandsStillIsTheMeanOfAllSamplesOnBothSides) {
  const Frame out =
      joined(even_frame(1, 2, 0.5F), {{even_frame(4, 1, 2), {}, -1}, {even_frame(2, 5, 0.25F), {}}}, two_sided());
  for (std::size_t i = 0; i < out.radiance.pixels.size(); ++i) {
    EXPECT_FLOAT_EQ(out.radiance.pixels[i].x, (2 * 1 + 1 * 4 + 5 * 2) / 8.0F);
    EXPECT_FLOAT_EQ(out.sample_count.pixels[i], 8);
    EXPECT_FLOAT_EQ(out.variance.pixels[i], (4 * 0.5F + 1 * 2 + 25 * 0.25F) / 64);
  }
}

TEST(TwoSided, NeighboursLandWhereTheirSurfacesAre) {
  const auto texture = [](int x, int y) { return 10 + x + 0.25 * y; };
  // In the one it is three pixels to the right and one and a half below, in the other two pixels to the left.
  const Frame out =
      joined(even_frame(0, 1), {{frame_of(texture, 3), {3, 1.5}, -1}, {frame_of(texture, 4), {-2, 0}}}, two_sided());
  for (int y = 0; y < kHeight - 2; ++y) {
    for (int x = 2; x < kWidth - 3; ++x) {
      const double right = 10 + (x + 3) + 0.25 * (y + 1.5);
      const double left = 10 + (x - 2) + 0.25 * y;
      EXPECT_NEAR(value(out, x, y), (3 * right + 4 * left) / 8, 1e-5);
      EXPECT_FLOAT_EQ(out.sample_count(x, y), 8);
    }
    EXPECT_FLOAT_EQ(out.sample_count(0, y), 4) << "is outside on the left later";
    EXPECT_FLOAT_EQ(out.sample_count(kWidth - 1, y), 5) << "was outside on the right before";
  }
}

TEST(TwoSided, AnotherObjectGivesNothing) {
  const Frame own = even_frame(1, 2);
  const SamplingMap map = map_of();
  NeighbourSums sums(own, map, two_sided(), 1);
  SurfaceMotion motion = wall();
  motion.object(4, 4) = 2;
  sums.add(history_of_frame(even_frame(3, 2), map, wall(), request_of(2), 1), motion, 1);
  const Frame out = sums.joined(motion);
  EXPECT_EQ(value(out, 4, 4), 1);
  EXPECT_FLOAT_EQ(out.sample_count(4, 4), 2);
  EXPECT_EQ(value(out, 5, 4), 2);
}

TEST(TwoSided, FramesFadeWithTheirDistance) {
  AccumulateSettings settings = two_sided();
  settings.frames = 4;
  const Frame out = joined(even_frame(0, 1), {{even_frame(1, 1), {}, -1}, {even_frame(1, 1), {}, 3}}, settings);
  const double others = 0.75 + 0.75 * 0.75 * 0.75;
  EXPECT_NEAR(value(out, 3, 3), others / (1 + others), 1e-6);
  EXPECT_NEAR(static_cast<double>(out.sample_count(3, 3)), 1 + others, 1e-6);
}

TEST(TwoSided, AFixedShareIsThatOfTheFrameItself) {
  AccumulateSettings settings = two_sided();
  settings.blend = 0.25;
  const Frame out = joined(even_frame(0, 2), {{even_frame(1, 1), {}, -1}, {even_frame(1, 7), {}}}, settings);
  EXPECT_NEAR(value(out, 3, 3), 0.75, 1e-6);
}

// A light is switched on: the frame before takes of the bright ones around it no more than a frame behind such a change
// takes of its past from one side.
TEST(TwoSided, ALightThatComesOnLeaksNoMoreThanFromOneSide) {
  AccumulateSettings settings = two_sided();
  settings.frames = 16;
  settings.clip_sigmas = 3;
  const auto noisy = [](double level) {
    return frame_of([level](int x, int y) { return level * (1 + 0.2 * std::sin(12.9898 * x + 78.233 * y)); }, 4,
                    static_cast<float>(0.01 * level * level));
  };
  AccumulateSettings one_sided = settings;
  one_sided.mode = AccumulateMode::reproject;
  for (const double bright : {2.0, 10.0, 1000.0}) {
    TemporalHistory history;
    for (int k = 1; k <= 20; ++k) {
      (void)pass(noisy(bright), wall(), one_sided, history, k);
    }
    const Frame after = pass(noisy(1), wall(), one_sided, history, 21);
    std::vector<Other> others;
    for (int apart = 1; apart <= 4; ++apart) {
      others.push_back({noisy(1), {}, -apart});
      others.push_back({noisy(bright), {}, apart});
    }
    const Frame before = joined(noisy(1), others, settings);
    double leak_after = 0;
    double leak_before = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        leak_after += std::fabs(value(after, x, y) - value(noisy(1), x, y));
        leak_before += std::fabs(value(before, x, y) - value(noisy(1), x, y));
      }
    }
    EXPECT_LE(leak_before, leak_after) << bright;
  }
}

TEST(TwoSided, NothingIsTakenAcrossASaccadeOrACut) {
  AccumulateSettings settings = two_sided();
  std::vector<FrameRequest> requests;
  for (int k = 1; k <= 7; ++k) {
    requests.push_back(request_of(k));
  }
  requests[2].saccade_since_last_frame = true;
  requests[5].blink_since_last_frame = true;
  const auto reach = [&](std::size_t own) {
    std::vector<TemporalHistory> alone;
    for (const FrameRequest& request : requests) {
      alone.push_back(history_of_frame(even_frame(1, 1), map_of(), wall(), request, 1));
    }
    std::vector<WindowFrame> window;
    for (std::size_t k = 0; k < requests.size(); ++k) {
      window.push_back({&requests[k], &alone[k]});
    }
    const WindowReach found = reach_of(window, own, settings);
    return std::pair(found.begin, found.end);
  };
  using Range = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(reach(3), Range(0, 7));
  settings.reset_at_saccades = true;
  EXPECT_EQ(reach(3), Range(2, 7));
  EXPECT_EQ(reach(1), Range(0, 2)) << "the frames before the jump read nothing of those after";
  settings.reset_at_blinks = true;
  EXPECT_EQ(reach(3), Range(2, 5));
  EXPECT_EQ(reach(6), Range(5, 7));
  for (std::size_t k = 4; k < requests.size(); ++k) {
    requests[k].camera.pose = look_at({0, 0, 0}, {0.5, 0, -1}, {0, 1, 0});
  }
  EXPECT_EQ(reach(3), Range(2, 4)) << "a cut";
  EXPECT_EQ(reach(4), Range(4, 5));
}

}  // namespace
}  // namespace gazetrace
