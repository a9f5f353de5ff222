// SPDX-License-Identifier: Apache-2.0
// The network and the samples beside it, on pictures whose truth is known; where Open Image Denoise is found.
#include "reconstruct/denoise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>

#include "gazetrace/display.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"
#include "reconstruct/open_image_denoise.hpp"

namespace gazetrace::denoise_test {
namespace {

constexpr int kSize = 96;

struct Planted {
  float texture = 0;  // standard deviation of light that changes from pixel to pixel, which no feature tells
  float noise = 0;    // of the mean of a pixel's samples
  float samples = 64;
};

struct Picture {
  ImageRgb truth;
  DenoiserInput input;
};

Picture planted(const Planted& planted) {
  Picture out;
  out.truth = ImageRgb(kSize, kSize);
  out.input.radiance = out.truth;
  out.input.halves = {out.truth, out.truth};
  out.input.albedo = ImageRgb(kSize, kSize, {0.5F, 0.5F, 0.5F});
  out.input.normal = ImageRgb(kSize, kSize, {0, 0, 1});
  out.input.samples = ImageGray(kSize, kSize, planted.samples);
  out.input.clean = true;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (std::size_t i = 0; i < out.truth.pixels.size(); ++i) {
    const float light = 0.5F + planted.texture * normal(random);
    out.truth.pixels[i] = {light, light, light};
    for (ImageRgb& half : out.input.halves) {
      const float seen = light + std::sqrt(2.0F) * planted.noise * normal(random);
      half.pixels[i] = {seen, seen, seen};
    }
    out.input.radiance.pixels[i] = 0.5F * (out.input.halves[0].pixels[i] + out.input.halves[1].pixels[i]);
  }
  return out;
}

double error_of(const ImageRgb& picture, const ImageRgb& truth) {
  double squares = 0;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const double off = static_cast<double>(picture.pixels[i].y) - static_cast<double>(truth.pixels[i].y);
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(truth.pixels.size()));
}

class Denoise : public testing::Test {
 protected:
  void SetUp() override {
    if (denoiser_library().path.empty()) {
      GTEST_SKIP() << "Open Image Denoise was not found; cmake/denoiser.sh brings it";
    }
  }
};

// What the network takes for noise, and both halves have, comes back.
TEST_F(Denoise, IsNoWorseThanSamplesThatKnowBetter) {
  const Picture picture = planted({.texture = 0.1F, .noise = 0.01F});
  const double raw = error_of(picture.input.radiance, picture.truth);
  ASSERT_GT(error_of(open_image_denoise(picture.input, 2, DenoiserNetwork::high), picture.truth), 3 * raw);
  EXPECT_LT(error_of(denoise(picture.input, DenoiserWork::with_halves, 2), picture.truth), 1.1 * raw);
}

TEST_F(Denoise, IsTheNetworksWhereThereIsNothingButNoise) {
  const Picture picture = planted({.texture = 0, .noise = 0.1F});
  const double network = error_of(open_image_denoise(picture.input, 2, DenoiserNetwork::high), picture.truth);
  ASSERT_LT(network, 0.2 * error_of(picture.input.radiance, picture.truth));
  EXPECT_LT(error_of(denoise(picture.input, DenoiserWork::with_halves, 2), picture.truth), 2 * network);
}

// A window's samples are many, the frame's own few: their time would buy more as samples.
TEST_F(Denoise, RunsASmallerNetworkOnceForFewSamplesOfTheFramesOwn) {
  const Picture picture = planted({.texture = 0.1F, .noise = 0.01F});
  const ImageRgb usual = open_image_denoise(picture.input, 2, DenoiserNetwork::usual);
  EXPECT_EQ(denoise(picture.input, DenoiserWork::usual, 2), usual);
  const ImageRgb fast = open_image_denoise(picture.input, 2, DenoiserNetwork::fast);
  EXPECT_EQ(denoise(picture.input, DenoiserWork::fast, 2), fast);
  EXPECT_NE(fast, usual);
}

TEST(DenoiserWorkOf, AFrameFollowsItsOwnSamples) {
  FoveationSettings settings;
  settings.sampling = UniformSampling{};
  const PlanarView view = view_of_perspective(1.0, 256, 144);
  settings.spp = 16;
  EXPECT_EQ(denoiser_work(make_sampling_map(settings, view, {})), DenoiserWork::with_halves);
  settings.spp = 15;
  SamplingMap map = make_sampling_map(settings, view, {});
  EXPECT_EQ(denoiser_work(map), DenoiserWork::usual);
  for (Site& site : map.sites) {  // as a window's frames leave it
    site.samples = 23 * 15;
  }
  EXPECT_EQ(denoiser_work(map), DenoiserWork::usual);
  // A fovea of a tenth of the picture.
  for (std::size_t t = 0; t < map.tiles.size() / 10; ++t) {
    map.tiles[t].samples = 16 * map.tiles[t].site_count;
  }
  EXPECT_EQ(denoiser_work(map), DenoiserWork::with_halves);
  settings.spp = 3;
  EXPECT_EQ(denoiser_work(make_sampling_map(settings, view, {})), DenoiserWork::fast);
}

// Few samples say little about their own error: the network runs once.
TEST_F(Denoise, IsTheNetworksWithFewSamples) {
  const Picture picture = planted({.texture = 0.1F, .noise = 0.01F, .samples = 15});
  EXPECT_EQ(denoise(picture.input, DenoiserWork::with_halves, 2),
            open_image_denoise(picture.input, 2, DenoiserNetwork::high));
}

// A fovea of many samples, in a margin that has few and keeps the network's picture.
TEST_F(Denoise, GivesBackToTheFewPixelsThatHaveManySamples) {
  Picture picture = planted({.texture = 0.1F, .noise = 0.01F});
  ImageGray& samples = picture.input.samples;
  for (std::size_t i = samples.pixels.size() / 8; i < samples.pixels.size(); ++i) {
    samples.pixels[i] = 1;
  }
  const ImageRgb network = open_image_denoise(picture.input, 2, DenoiserNetwork::high);
  const ImageRgb denoised = denoise(picture.input, DenoiserWork::with_halves, 2);
  EXPECT_NE(denoised.pixels.front(), network.pixels.front());
  EXPECT_EQ(denoised.pixels.back(), network.pixels.back());
}

// Of the pixels around the middle, without those next to it.
double error_around_middle(const ImageRgb& picture, const ImageRgb& truth) {
  double squares = 0;
  int pixels = 0;
  for (int y = -8; y <= 8; ++y) {
    for (int x = -8; x <= 8; ++x) {
      if (std::abs(x) > 3 || std::abs(y) > 3) {
        const double off = static_cast<double>(picture(kSize / 2 + x, kSize / 2 + y).y) -
                           static_cast<double>(truth(kSize / 2 + x, kSize / 2 + y).y);
        squares += off * off;
        ++pixels;
      }
    }
  }
  return std::sqrt(squares / pixels);
}

// A firefly of either half, in a pixel that is brighter in both, is no light that both have: the noise around it stays
// away.
TEST_F(Denoise, FireflyOfOneHalfGivesNoNoiseBack) {
  for (std::size_t half = 0; half < 2; ++half) {
    Picture picture = planted({.texture = 0, .noise = 0.1F});
    picture.input.halves[half](kSize / 2, kSize / 2) = {30, 30, 30};
    picture.input.halves[1 - half](kSize / 2, kSize / 2) = {1, 1, 1};
    picture.input.radiance(kSize / 2, kSize / 2) = {15.5F, 15.5F, 15.5F};
    EXPECT_LT(error_around_middle(denoise(picture.input, DenoiserWork::with_halves, 2), picture.truth), 0.2 * 0.1)
        << half;
  }
}

TEST_F(Denoise, ThreadsChangeNoBit) {
  const Picture picture = planted({.texture = 0.05F, .noise = 0.05F});
  EXPECT_EQ(denoise(picture.input, DenoiserWork::with_halves, 1), denoise(picture.input, DenoiserWork::with_halves, 2));
}

}  // namespace
}  // namespace gazetrace::denoise_test
