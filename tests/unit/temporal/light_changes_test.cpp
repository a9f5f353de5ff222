// SPDX-License-Identifier: Apache-2.0
#include "temporal/light_changes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gazetrace::light_changes_test {
namespace {

// Of one site with so many samples.
LightSums sums_of(double mean, double variance, std::uint32_t samples) {
  LightSums sums;
  sums.add(samples * mean, samples * (mean * mean + variance), samples);
  return sums;
}

// 64 samples of each frame, exponentially distributed about its light.
std::vector<LightSums> noisy(const std::vector<double>& light, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<LightSums> frames;
  for (const double mean : light) {
    LightSums sums;
    std::exponential_distribution<double> sample(1 / mean);
    for (int k = 0; k < 64; ++k) {
      const double value = sample(random);
      sums.add(value, value * value, 1);
    }
    frames.push_back(sums);
  }
  return frames;
}

TEST(LightChanges, AChangeEndsTheRangeOnItsSide) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto frames = noisy({10, 10, 10, 1, 1, 1, 1, 8, 8}, seed);
    const FrameRange range = frames_in_same_light(frames, 4);
    EXPECT_EQ(range.first, 3U) << seed;
    EXPECT_EQ(range.last, 6U) << seed;
    EXPECT_EQ(frames_in_same_light(frames, 3).first, 3U) << seed;
    EXPECT_EQ(frames_in_same_light(frames, 2).last, 2U) << seed;
    EXPECT_EQ(frames_in_same_light(frames, 7).first, 7U) << seed;
  }
}

TEST(LightChanges, OfSeveralChangesTheNearestCounts) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto frames = noisy({100, 100, 100, 4, 4, 1, 1, 1}, seed);
    EXPECT_EQ(frames_in_same_light(frames, 7).first, 5U) << seed;
  }
}

TEST(LightChanges, NoiseIsNoChange) {
  int lost = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    const FrameRange range = frames_in_same_light(noisy(std::vector<double>(9, 1.0), seed), 4);
    lost += range.first != 0 || range.last != 8 ? 1 : 0;
  }
  EXPECT_LT(lost, 10);  // of 500 at 4 standard deviations, eight places each
}

// One path in a thousand is a thousand times as bright. That a frame has none of them says nothing.
TEST(LightChanges, RareBrightPathsAreNoChange) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> chance(0, 1);
  int lost = 0;
  for (int k = 0; k < 500; ++k) {
    std::vector<LightSums> frames(9);
    for (LightSums& sums : frames) {
      for (int i = 0; i < 64; ++i) {
        const double value = chance(random) < 1e-3 ? 1000 : 1;
        sums.add(value, value * value, 1);
      }
    }
    const FrameRange range = frames_in_same_light(frames, 4);
    lost += range.first != 0 || range.last != 8 ? 1 : 0;
  }
  EXPECT_LT(lost, 10);
}

// Frames with more samples in each site have less noise, and roots of other means: that is no change.
TEST(LightChanges, MoreSamplesAreNoChange) {
  std::mt19937 random(3);
  std::exponential_distribution<double> sample(1);
  int lost = 0;
  for (int k = 0; k < 200; ++k) {
    std::vector<LightSums> frames(6);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      for (int site = 0; site < 64; ++site) {
        double light = 0;
        double square = 0;
        const std::uint32_t count = f < 3 ? 1 : 16;
        for (std::uint32_t i = 0; i < count; ++i) {
          const double value = std::pow(sample(random), 4);
          light += value;
          square += value * value;
        }
        frames[f].add(light, square, count);
      }
    }
    const FrameRange range = frames_in_same_light(frames, 3);
    lost += range.first != 0 || range.last != 5 ? 1 : 0;
  }
  EXPECT_LT(lost, 5);
}

// Most of the noise is in a few samples. The root of the light still tells that it has halved.
TEST(LightChanges, RareBrightPathsDoNotHideAChange) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> chance(0, 1);
  std::vector<LightSums> frames(9);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (int i = 0; i < 256; ++i) {
      const double light = (f < 4 ? 2 : 1) * (0.5 + chance(random)) * (chance(random) < 0.02 ? 50 : 1);
      frames[f].add(light, light * light, 1);
    }
  }
  EXPECT_EQ(frames_in_same_light(frames, 6).first, 4U);
}

// Without noise, and less than what the same place may differ by from frame to frame.
TEST(LightChanges, WhatHasNoNoiseMayDifferALittle) {
  const std::vector<LightSums> frames(5, sums_of(1, 0, 10));
  EXPECT_EQ(frames_in_same_light(frames, 2).first, 0U);
  std::vector<LightSums> other = frames;
  other[0] = other[1] = sums_of(2, 0, 10);
  EXPECT_EQ(frames_in_same_light(other, 2).first, 2U);
}

// Each block by itself has too few samples to tell.
TEST(LightChanges, BlocksAreLookedAtTogetherWithThoseAroundThem) {
  const LightSums before = sums_of(1, 1, 10);
  const LightSums after = sums_of(2.5, 1, 10);
  EXPECT_EQ(frames_in_same_light({before, after}, 1).first, 0U);
  LightChanges light(24, 24, 2);
  for (std::size_t block = 0; block < 9; ++block) {
    light.at(block, 0) = before;
    light.at(block, 1) = after;
  }
  for (const FrameRange& range : light.same_light(1, 2)) {
    EXPECT_EQ(range.first, 1U);
  }
}

TEST(LightChanges, WhatChangesInOneBlockStaysThere) {
  LightChanges light(40, 24, 2);
  for (std::size_t block = 0; block < 15; ++block) {
    light.at(block, 0) = light.at(block, 1) = sums_of(1, 1, 10);
  }
  light.at(LightChanges::block_of(3, 3, 40), 1) = sums_of(9, 1, 10);
  const std::vector<FrameRange> ranges = light.same_light(1, 2);
  EXPECT_EQ(ranges[LightChanges::block_of(7, 7, 40)].first, 1U);
  EXPECT_EQ(ranges[LightChanges::block_of(16, 0, 40)].first, 0U);
  EXPECT_EQ(ranges[LightChanges::block_of(39, 23, 40)].first, 0U);
}

}  // namespace
}  // namespace gazetrace::light_changes_test
