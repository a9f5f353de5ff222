// SPDX-License-Identifier: Apache-2.0
// What a denoiser is shown of samples whose light and first hits are known.
#include "reconstruct/denoiser_input.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "support/guides_wall.hpp"

namespace gazetrace::denoiser_input_test {
namespace {

constexpr int kSize = kGuidesWallPx;

struct Seen {
  float light = 1;      // irradiance over pi
  float albedo = 0.5F;  // of what the samples hit
  float shift_px = 0;   // how far that is from what the guides see there
};

// Samples of every site, all alike.
SparseFrame samples_of(const SamplingMap& map, const Guides& guides, const Seen& seen) {
  SparseFrame sparse;
  sparse.width_px = kSize;
  sparse.height_px = kSize;
  for (const Site& site : map.sites) {
    const auto n = static_cast<float>(site.samples);
    const float light = seen.light * seen.albedo;
    const float block = static_cast<float>(map.regions[site.region].block_px);
    SurfaceSums surface;
    surface.reflected = n * light * Vec3f{1, 1, 1};
    surface.albedo = n * seen.albedo * Vec3f{1, 1, 1};
    surface.normal = n * Vec3f{0, 0, 1};
    surface.position_m = n * guides.camera.place((static_cast<float>(site.block_x) + 0.5F) * block - 0.5F * kSize,
                                                 (static_cast<float>(site.block_y) + 0.5F) * block - 0.5F * kSize, 10);
    surface.square = n * seen.light * seen.light;
    surface.count = site.samples;
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    sparse.surfaces.push_back(surface);
    sparse.first_hits.emplace_back().square_shift_px2 = n * seen.shift_px * seen.shift_px;
    sparse.sum.push_back(surface.reflected);
    sparse.sum_square_luminance.push_back(n * light * light);
    sparse.count.push_back(site.samples);
    sparse.half_difference.push_back(0);
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  return sparse;
}

SamplingMap fine_map(std::uint32_t samples) {
  return map_with_fovea({0, kSize}, {0, kSize}, samples, 4);
}

// Of one pixel: samples are shown as they are; features are means over four rays and twelve samples.
TEST(DenoiserInput, SamplesAndRaysCountAlike) {
  Guides guides = wall();  // of albedo 0.5
  guides.spp = 4;
  const SamplingMap map = fine_map(12);
  const DenoiserInput shown = denoiser_input(samples_of(map, guides, {.light = 3, .albedo = 0.9F}), map, guides, 1);
  EXPECT_TRUE(shown.clean);
  for (std::size_t i = 0; i < shown.radiance.pixels.size(); ++i) {
    EXPECT_NEAR(shown.radiance.pixels[i].x, 2.7F, 1e-5F);
    EXPECT_NEAR(shown.albedo.pixels[i].y, (4 * 0.5F + 12 * 0.9F) / 16, 1e-5F);
    EXPECT_NEAR(shown.normal.pixels[i].z, 1, 1e-5F);
    EXPECT_EQ(shown.samples.pixels[i], 12);
  }
}

// Behind a lens the rays of the guides see something else.
TEST(DenoiserInput, ShiftedSamplesCountAlone) {
  const Guides guides = wall();
  const SamplingMap map = fine_map(2);
  const DenoiserInput shown = denoiser_input(samples_of(map, guides, {.albedo = 0.9F, .shift_px = 3}), map, guides, 1);
  EXPECT_FALSE(shown.clean);
  for (const Vec3f& albedo : shown.albedo.pixels) {
    EXPECT_NEAR(albedo.x, 0.9F, 1e-5F);
  }
}

// Blocks of 4x4 pixels know the light, and each pixel knows its own texture and what shines there.
TEST(DenoiserInput, PixelsOfABlockHaveTheirOwnTextureUnderItsLight) {
  Guides guides = wall();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      guides.albedo(x, y) = (x + y) % 2 == 0 ? Vec3f{0.2F, 0.4F, 0.6F} : Vec3f{0.8F, 0.6F, 0.4F};
      guides.emission(x, y) = x == 5 ? Vec3f{7, 7, 7} : Vec3f{};
    }
  }
  const SamplingMap map = map_with_fovea({0, 0}, {0, 0}, 1, 4);
  SparseFrame sparse = samples_of(map, guides, {.light = 2});
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    if (map.sites[i].block_x == 1) {  // pixels 4 to 7, of which one column shines
      sparse.first_hits[i].shone = static_cast<float>(sparse.count[i]) * Vec3f{1.75F, 1.75F, 1.75F};
      sparse.sum[i] += sparse.first_hits[i].shone;
    }
  }
  const DenoiserInput shown = denoiser_input(sparse, map, guides, 2);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Vec3f albedo = guides.albedo(x, y);
      EXPECT_NEAR(shown.radiance(x, y).x, 2 * albedo.x + (x == 5 ? 7 : 0), 1e-3F);
      EXPECT_NEAR(shown.radiance(x, y).z, 2 * albedo.z + (x == 5 ? 7 : 0), 1e-3F);
      EXPECT_EQ(shown.albedo(x, y), albedo);
      EXPECT_EQ(shown.samples(x, y), 0.5F);
    }
  }
}

}  // namespace
}  // namespace gazetrace::denoiser_input_test
