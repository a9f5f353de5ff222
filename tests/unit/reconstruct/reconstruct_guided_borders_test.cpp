// SPDX-License-Identifier: Apache-2.0
// The guided filter where blocks are cut, by another region or by the frame's edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "foveation/sites.hpp"
#include "reconstruct/surface_smoothing.hpp"
#include "support/guides_wall.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::reconstruct_guided_borders_test {
namespace {

constexpr int kSize = kGuidesWallPx;

// A square of single pixels with 32 samples within [begin, kSize - begin), blocks of 8 samples around.
SamplingMap map_about_the_middle(int begin, int block_px) {
  return map_with_fovea({begin, kSize - begin}, {begin, kSize - begin}, 32, block_px);
}

// All samples of a site at the middle of its pixels, under light_at(x, y) of its first pixel. There is so much noise
// that the filter smooths as much as it can. Nothing is traced in the fovea: between blocks of one size no light is
// lost.
template <class LightAt>
SparseFrame trace_planted(const SamplingMap& map, const Guides& guides, const LightAt& light_at) {
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
    const std::uint32_t samples = map.regions[site.region].block_px > 1 ? site.samples : 0;
    const auto n = static_cast<float>(samples);
    const Vec3f reflected = n * light * Vec3f{0.5F, 0.5F, 0.5F};
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    if (samples > 0) {
      sparse.surfaces.push_back({reflected, n * Vec3f{0.5F, 0.5F, 0.5F}, n * Vec3f{0, 0, 1},
                                 place * (n / static_cast<float>(site.pixels)), n * light * light, noise, samples,
                                 SurfaceKind::diffuse});
    }
    sparse.sum.push_back(reflected);
    sparse.count.push_back(samples);
    sparse.sum_square_luminance.push_back(1e12F * n);  // as planted_noise()
    sparse.half_difference.push_back(noise);
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  return sparse;
}

Frame guided(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides) {
  return reconstruct(sparse, map, "guided", 1, &guides);
}

// The same from the left and from the right, from above and from below: blocks are, where a side of the fovea cuts
// them.
TEST(ReconstructGuidedBorders, AMirroredFrameIsFilteredToItsMirrorImage) {
  const Guides guides = wall();
  for (const int begin : {20, 21}) {
    const SamplingMap map = map_about_the_middle(begin, 2);
    const SparseFrame sparse = trace_planted(map, guides, [](int x, int y) {
      const int bx = std::min(x / 2, kSize / 2 - 1 - x / 2);
      const int by = std::min(y / 2, kSize / 2 - 1 - y / 2);
      return 1 + (bx * 7 + by * 13) % 5;
    });
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
    const SparseFrame sparse = trace_planted(map, guides, [&](int x, int y) {
      return x / cut.block_px == cut.x / cut.block_px && y / cut.block_px == by && map.region(x, y) == 1 ? 100 : 0;
    });
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
    float most = 0;  // among the blocks: the fovea, which has no samples, is filled from what is around it
    for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      most = map.region.pixels[i] == 1 ? std::max(most, frame.radiance.pixels[i].x) : most;
    }
    EXPECT_GT(frame.radiance(cut.x, by * cut.block_px).x, 0.5F * most);
  }
}

}  // namespace
}  // namespace gazetrace::reconstruct_guided_borders_test
