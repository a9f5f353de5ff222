// SPDX-License-Identifier: Apache-2.0
// What the guided filter takes from the samples' own first hits: texture that its guides do not show, known by the
// samples but for noise of known strength, under light that is noisier still.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "support/guides_wall.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::sampled_first_hits_test {
namespace {

constexpr int kSize = kGuidesWallPx;
constexpr std::uint32_t kSamples = 16;
constexpr double kAlbedo = 0.5;  // of the guides

struct Planted {
  double texture = 0;       // by so much the albedo is off the guides', up and down in squares of two pixels
  double albedo_sigma = 0;  // standard deviation of the mean of a pixel's samples
  double light_sigma = 0;   // the same, of light, which is 1 everywhere
  bool has_halves = true;   // else all samples of each pixel are of one half
};

struct Errors {
  double raw = 0, filtered = 0;  // mean square errors of luminance
  double estimated = 0;          // mean of Frame::squared_error
};

double albedo_at(const Planted& planted, int x, int y) {
  return kAlbedo + ((x / 2 + y / 2) % 2 == 0 ? planted.texture : -planted.texture);
}

Errors errors_of(const Planted& planted) {
  const Guides guides = wall();
  const SamplingMap map = map_with_fovea({0, kSize}, {0, kSize}, kSamples, 4);
  std::mt19937 random(23);
  std::normal_distribution<double> noise(0, std::sqrt(2.0));  // of half the samples
  SparseFrame sparse;
  sparse.width_px = kSize;
  sparse.height_px = kSize;
  Errors errors;
  for (const Site& site : map.sites) {
    const int x = site.block_x;
    const int y = site.block_y;
    const double truth = albedo_at(planted, x, y);
    const double albedo_a = truth + planted.albedo_sigma * noise(random);
    const double albedo_b = truth + planted.albedo_sigma * noise(random);
    const double light_a = 1 + planted.light_sigma * noise(random);
    const double light_b = 1 + planted.light_sigma * noise(random);
    const double albedo = (albedo_a + albedo_b) / 2;
    const double light = (light_a + light_b) / 2;
    const auto n = static_cast<float>(kSamples);
    const auto grey = [n](double value) { return n * static_cast<float>(value) * Vec3f{1, 1, 1}; };
    const auto half_of = [&](double difference) { return planted.has_halves ? static_cast<float>(difference / 2) : 0; };
    SurfaceSums surface;
    surface.reflected = grey(albedo * light);
    surface.albedo = grey(albedo);
    surface.normal = n * Vec3f{0, 0, 1};
    surface.position_m = n * guides.camera.place(static_cast<float>(x) + 0.5F - 0.5F * kSize,
                                                 static_cast<float>(y) + 0.5F - 0.5F * kSize, 10);
    surface.square =
        static_cast<float>(kSamples * (light * light + planted.light_sigma * planted.light_sigma * kSamples));
    surface.half_difference = half_of(albedo * (light_a - light_b));
    surface.albedo_difference = half_of(albedo_a - albedo_b);
    surface.count = kSamples;
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    sparse.surfaces.push_back(surface);
    sparse.first_hits.emplace_back();
    sparse.sum.push_back(surface.reflected);
    sparse.count.push_back(kSamples);
    const double spread = planted.albedo_sigma * planted.albedo_sigma +
                          albedo * albedo * planted.light_sigma * planted.light_sigma;  // of means
    sparse.sum_square_luminance.push_back(
        static_cast<float>(kSamples * (albedo * albedo * light * light + kSamples * spread)));
    sparse.half_difference.push_back(half_of(albedo_a * light_a - albedo_b * light_b));
    const double off = albedo * light - truth;
    errors.raw += off * off;
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  const Frame frame = reconstruct(sparse, map, "guided", 1, &guides);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double off = static_cast<double>(frame.radiance(x, y).y) - albedo_at(planted, x, y);
      errors.filtered += off * off;
      errors.estimated += static_cast<double>(frame.squared_error(x, y));
    }
  }
  constexpr double kPixels = kSize * kSize;
  return {errors.raw / kPixels, errors.filtered / kPixels, errors.estimated / kPixels};
}

// The samples' own mean is too noisy to show a texture whose albedo they know well.
TEST(SampledFirstHits, ShowTextureThatGuidesMissUnderNoisyLight) {
  constexpr double kTexture = 0.1;
  const Errors errors = errors_of({.texture = kTexture, .albedo_sigma = 0.01, .light_sigma = 0.4});
  EXPECT_LT(errors.filtered, 0.25 * kTexture * kTexture);
  EXPECT_LT(errors.filtered, 0.1 * errors.raw);
}

// Whether light is known better than texture or worse.
TEST(SampledFirstHits, BringTheirOwnNoiseIntoTheEstimatedError) {
  for (const double light_sigma : {0.01, 0.06, 0.1}) {
    const Errors errors = errors_of({.texture = 0.1, .albedo_sigma = 0.04, .light_sigma = light_sigma});
    EXPECT_GT(errors.estimated, 0.5 * errors.filtered) << light_sigma;
    EXPECT_LT(errors.estimated, 2 * errors.filtered) << light_sigma;
  }
}

// As where frames at rest are added up, and all samples of a pixel are of frames with odd numbers.
TEST(SampledFirstHits, NoiseIsNotTakenForTextureWhereHalvesAreUnknown) {
  constexpr double kSigma = 0.05;
  const Errors errors = errors_of({.albedo_sigma = kSigma, .has_halves = false});
  EXPECT_LT(errors.filtered, 0.1 * kSigma * kSigma);
}

}  // namespace
}  // namespace gazetrace::sampled_first_hits_test
