// SPDX-License-Identifier: Apache-2.0
// Reprojected accumulation of noise that hides no texture: what it gathers, and that it stays true in the mean.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include "gazetrace/temporal.hpp"
#include "support/reproject_wall.hpp"

namespace gazetrace {
namespace {

using namespace test;

constexpr int kFrames = 24;
constexpr Vec2d kGlide{0.23, -0.11};  // pixels a frame

// Of mean 1. even: as of a sky; exponential: with the long tail that light has.
enum class Light : std::uint8_t { even, exponential };

double sample_of(Light light, std::mt19937_64& random) {
  const double u = static_cast<double>(random() >> 11U) * 0x1p-53;
  return light == Light::even ? 2 * u : -std::log1p(-u);
}

// As traced: independent samples that tell their own variance.
Frame traced_frame(Light light, int samples, std::mt19937_64& random) {
  Frame frame = even_frame(0, static_cast<float>(samples));
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    double sum = 0;
    double squares = 0;
    for (int s = 0; s < samples; ++s) {
      const double value = sample_of(light, random);
      sum += value;
      squares += value * value;
    }
    const double mean = sum / samples;
    const auto shown = static_cast<float>(mean);
    frame.radiance.pixels[i] = {shown, shown, shown};
    frame.variance.pixels[i] = static_cast<float>((squares / samples - mean * mean) / (samples - 1));
  }
  return frame;
}

// Of one sequence, over pixels whose history never came in at a side.
struct Gathered {
  double count = 0;  // after the last frame
  double alone = 0;  // mean of frames 8 to the last, without accumulation
  double accumulated = 0;
};

Gathered gather(Light light, int samples, const Vec2d& glide, std::uint64_t seed) {
  AccumulateSettings settings;
  settings.mode = AccumulateMode::reproject;
  const SamplingMap map = map_of();
  const SurfaceMotion motion = wall(glide);
  std::mt19937_64 random(seed);
  TemporalHistory history;
  Gathered gathered;
  double pixels = 0;
  for (int k = 1; k <= kFrames; ++k) {
    const Frame frame = traced_frame(light, samples, random);
    const Frame out = reproject(frame, map, motion, request_of(k), settings, history, 1);
    for (int y = 5; y < kHeight - 2; ++y) {
      for (int x = 2; x < 8; ++x) {
        if (k >= 8) {
          gathered.alone += value(frame, x, y);
          gathered.accumulated += value(out, x, y);
          ++pixels;
        }
        if (k == kFrames) {
          gathered.count += static_cast<double>(out.sample_count(x, y)) / (6 * (kHeight - 7));
        }
      }
    }
  }
  gathered.alone /= pixels;
  gathered.accumulated /= pixels;
  return gathered;
}

TEST(ReprojectNoise, WhatHasNoTextureGathersMostOfItGlidingAsWell) {
  constexpr std::uint64_t kSeeds = 20;
  for (const Light light : {Light::even, Light::exponential}) {
    for (const int samples : {2, 8, 32}) {
      double still = 0;
      double gliding = 0;
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        still += gather(light, samples, {}, seed).count / kSeeds;
        gliding += gather(light, samples, kGlide, seed).count / kSeeds;
      }
      // Two samples tell little of their own variance.
      EXPECT_GT(gliding, (samples == 2 ? 0.6 : 0.7) * still)
          << samples << " samples of light " << static_cast<int>(light);
    }
  }
}

TEST(ReprojectNoise, TheMeanIsThatOfTheFramesAlone) {
  constexpr std::uint64_t kSeeds = 100;
  for (const Light light : {Light::even, Light::exponential}) {
    for (const int samples : {2, 8}) {
      double sum = 0;
      double squares = 0;
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Gathered gathered = gather(light, samples, kGlide, seed);
        const double off = gathered.accumulated - gathered.alone;
        sum += off;
        squares += off * off;
      }
      const double mean = sum / kSeeds;
      const double deviation = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
      // Three standard deviations of the mean: one of 370 would fail by chance.
      EXPECT_LT(std::fabs(mean), 3 * deviation) << samples << " samples of light " << static_cast<int>(light);
    }
  }
}

}  // namespace
}  // namespace gazetrace
