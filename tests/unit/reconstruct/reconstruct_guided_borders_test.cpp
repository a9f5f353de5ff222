// SPDX-License-Identifier: Apache-2.0
// The guided filter where blocks are cut, by another region or by the frame's edge, and which single pixels it changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>

#include "foveation/sites.hpp"
#include "reconstruct/surface_smoothing.hpp"
#include "support/guides_wall.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace {
namespace {

constexpr int kSize = kGuidesWallPx;

// A square of single pixels with 32 samples within [begin, kSize - begin), blocks of 8 samples around.
SamplingMap map_about_the_middle(int begin, int block_px) {
  return map_with_fovea({begin, kSize - begin}, {begin, kSize - begin}, 32, block_px);
}

// All samples of a site at the middle of its pixels, under light_at(x, y) of its first pixel. As the tracer, no
// surfaces for sites that keep their own mean. There is so much noise
// that the filter smooths as much as it can.
template <class LightAt>
SparseFrame trace_planted(const SamplingMap& map, const Guides& guides, const LightAt& light_at,
                          const std::optional<std::uint64_t>& pass_through_samples = {}) {
  const PassThrough pass_through(map, pass_through_samples);
  SparseFrame sparse;
  sparse.width_px = map.width_px;
  sparse.height_px = map.height_px;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const Site& site = map.sites[i];
    Vec3f place;
    float light = -1;
    for_each_pixel(map, site, [&](int x, int y) {
      place += guides.camera.place(static_cast<float>(x) + 0.5F - 0.5F * kSize,
                                   static_cast<float>(y) + 0.5F - 0.5F * kSize, guides.depth_m(x, y));
      light = light < 0 ? static_cast<float>(light_at(x, y)) : light;
    });
    const float noise = planted_noise(site);
    const auto n = static_cast<float>(site.samples);
    const Vec3f reflected = n * light * Vec3f{0.5F, 0.5F, 0.5F};
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    if (pass_through.needs_filtering(i)) {
      sparse.surfaces.push_back({reflected, n * Vec3f{0.5F, 0.5F, 0.5F}, n * Vec3f{0, 0, 1},
                                 place * (n / static_cast<float>(site.pixels)), n * light * light, noise, site.samples,
                                 SurfaceKind::diffuse});
    }
    sparse.sum.push_back(reflected);
    sparse.count.push_back(site.samples);
    sparse.sum_square_luminance.push_back(1e12F * static_cast<float>(site.samples));  // as planted_noise()
    sparse.half_difference.push_back(noise);
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  return sparse;
}

// The fovea keeps its own means: between blocks of one size no light is lost.
constexpr std::uint64_t kPassThrough = 16;
Frame guided(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides) {
  return reconstruct(sparse, map, "guided", 1, &guides, kPassThrough);
}

// The same from the left and from the right, from above and from below: blocks are, where a side of the fovea cuts
// them.
TEST(ReconstructGuidedBorders, AMirroredFrameIsFilteredToItsMirrorImage) {
  const Guides guides = wall();
  for (const int begin : {20, 21}) {
    const SamplingMap map = map_about_the_middle(begin, 2);
    const SparseFrame sparse = trace_planted(
        map, guides,
        [](int x, int y) {
          const int bx = std::min(x / 2, kSize / 2 - 1 - x / 2);
          const int by = std::min(y / 2, kSize / 2 - 1 - y / 2);
          return 1 + (bx * 7 + by * 13) % 5;
        },
        kPassThrough);
    const Frame frame = guided(sparse, map, guides);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const float value = frame.radiance(x, y).x;
        ASSERT_NEAR(value, frame.radiance(kSize - 1 - x, y).x, 1e-4F * value) << begin << ": " << x << ',' << y;
        ASSERT_NEAR(value, frame.radiance(x, kSize - 1 - y).x, 1e-4F * value) << begin << ": " << x << ',' << y;
      }
    }
  }
}

// Light falls on nothing but one block, of which the fovea, or the frame's edge, leaves the first column.
TEST(ReconstructGuidedBorders, WhatIsLeftOfACutBlockCountsAndLosesNoLight) {
  struct Cut {
    int begin, block_px, x;
  };
  const Guides guides = wall();
  for (const Cut& cut : {Cut{21, 2, 20}, Cut{21, 4, 20}, Cut{kSize / 2, 3, 63}}) {
    SCOPED_TRACE(cut.block_px);
    const SamplingMap map = map_about_the_middle(cut.begin, cut.block_px);
    const int by = 30 / cut.block_px;
    const SparseFrame sparse = trace_planted(
        map, guides,
        [&](int x, int y) {
          return x / cut.block_px == cut.x / cut.block_px && y / cut.block_px == by && map.region(x, y) == 1 ? 100 : 0;
        },
        kPassThrough);
    SurfaceCells cells = make_surface_cells(sparse, map, guides.camera, 1);
    const auto light = [&] {
      double sum = 0;
      for (const SurfaceCell& cell : cells.cells) {
        sum += static_cast<double>(cell.samples * cell.reflected.x);
      }
      return sum;
    };
    const double traced = light();
    ASSERT_GT(traced, 0);
    smooth_surfaces(cells, map, {}, 1);
    EXPECT_NEAR(light() / traced, 1, 1e-5);
    const Frame frame = guided(sparse, map, guides);
    float most = 0;
    for (const Vec3f& c : frame.radiance.pixels) {
      most = std::max(most, c.x);
    }
    EXPECT_GT(frame.radiance(cut.x, by * cut.block_px).x, 0.5F * most);
  }
}

// A rate of 15.5 (7.5) samples gives every other pixel 16 (8), which is enough; 16.5 (8.5) gives enough to all.
TEST(ReconstructGuidedBorders, PixelsOfOneExpectationAreAllSmoothedOrAllKept) {
  const Guides guides = wall();
  std::mt19937 random(31);
  std::exponential_distribution<float> noise(1);
  for (const std::uint32_t enough : {16U, 8U}) {
    for (const bool kept : {false, true}) {
      SamplingMap map = map_about_the_middle(20, 4);
      for (std::size_t i = 0; i < map.sites.size(); ++i) {
        Site& site = map.sites[i];
        const std::uint32_t fewest = kept ? enough : enough - 1;
        site.samples = site.region == 0 ? fewest + static_cast<std::uint32_t>(random() % 2) : site.samples;
        map.expected_samples.push_back(site.region == 0 ? static_cast<float>(fewest) + 0.5F
                                                        : static_cast<float>(site.samples));
      }
      const SparseFrame sparse = trace_planted(
          map, guides, [&](int, int) { return noise(random); }, enough);
      const Frame none = reconstruct(sparse, map, "none", 1);
      const Frame frame = reconstruct(sparse, map, "guided", 1, &guides, enough);
      int same = 0;
      for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
        same += map.region.pixels[i] == 0 && frame.radiance.pixels[i] == none.radiance.pixels[i] ? 1 : 0;
      }
      EXPECT_EQ(same, kept ? 24 * 24 : 0) << enough;
    }
  }
}

// Every other pixel expects enough samples. Their neighbours' means are surer than what surfaces say of them, so that
// much is given back around the pixels that are kept; their own estimates must not know of it.
TEST(ReconstructGuidedBorders, PixelsThatAreKeptKeepTheirNoiseToo) {
  const Guides guides = wall();
  SamplingMap map = map_about_the_middle(0, 1);
  for (Site& site : map.sites) {
    site.samples = (site.block_x + site.block_y) % 2 == 0 ? kPassThrough : kPassThrough / 2;
  }
  SparseFrame sparse = trace_planted(
      map, guides, [](int x, int y) { return 1 + (x * 7 + y * 13) % 5; }, kPassThrough);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const auto n = static_cast<float>(map.sites[i].samples);
    const float mean = sparse.sum[i].x / n;
    sparse.sum_square_luminance[i] = n * (mean * mean + 0.01F);
    sparse.half_difference[i] *= 1e-8F;
  }
  for (SurfaceSums& surface : sparse.surfaces) {
    surface.half_difference *= 1e-6F;
  }
  const Frame none = reconstruct(sparse, map, "none", 1);
  const Frame frame = guided(sparse, map, guides);
  const PassThrough pass_through(map, kPassThrough);
  int kept = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    if (!pass_through.needs_filtering(i)) {
      ++kept;
      for_each_pixel(map, map.sites[i], [&](int x, int y) {
        EXPECT_EQ(frame.radiance(x, y), none.radiance(x, y));
        EXPECT_EQ(frame.variance(x, y), none.variance(x, y)) << x << ',' << y;
        EXPECT_EQ(frame.squared_error(x, y), none.variance(x, y)) << x << ',' << y;
      });
    }
  }
  EXPECT_EQ(kept, kSize * kSize / 2);
}

}  // namespace
}  // namespace gazetrace
