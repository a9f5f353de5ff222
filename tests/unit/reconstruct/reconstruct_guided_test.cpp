// SPDX-License-Identifier: Apache-2.0
// The guided filter on planted guides and samples: what it must keep, and what must not cross an edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "reconstruct/surface_smoothing.hpp"
#include "support/guides_wall.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::reconstruct_guided_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kSize = kGuidesWallPx;

// Blocks of 4 with 8 samples; with `fovea`, single pixels in the middle.
SamplingMap block_map(bool fovea = false, std::uint32_t foveal_samples = 32) {
  return fovea ? map_with_fovea({21, 42}, {22, 41}, foveal_samples, 4) : map_with_fovea({}, {}, foveal_samples, 4);
}

// One sample in every other pixel of each site, on what the guides show there; `light_at(x, y)` falls on it.
template <class LightAt>
SparseFrame trace_planted(const SamplingMap& map, const Guides& guides, const LightAt& light_at) {
  SparseFrame sparse;
  sparse.width_px = map.width_px;
  sparse.height_px = map.height_px;
  for (const Site& site : map.sites) {
    sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
    const std::size_t first = sparse.surfaces.size();
    Vec3f sum;
    std::uint32_t count = 0;
    for_each_pixel(map, site, [&](int x, int y) {
      if (site.pixels > 1 && (x + y) % 2 != 0) {
        return;
      }
      const std::uint32_t samples = site.pixels > 1 ? 1 : site.samples;
      const auto n = static_cast<float>(samples);
      count += samples;
      sum += n * guides.emission(x, y);
      const SurfaceKind kind = guides.kind(x, y);
      if (kind == SurfaceKind::miss || kind == SurfaceKind::unlit) {
        return;
      }
      const auto light = static_cast<float>(light_at(x, y));
      const Vec3f albedo = guides.albedo(x, y);
      sum += n * light * albedo;
      const Vec3f place = guides.camera.place(static_cast<float>(x) + 0.5F - 0.5F * kSize,
                                              static_cast<float>(y) + 0.5F - 0.5F * kSize, guides.depth_m(x, y));
      SurfaceSums* surface = nullptr;
      for (std::size_t s = first; s < sparse.surfaces.size(); ++s) {
        const auto m = static_cast<float>(sparse.surfaces[s].count);
        if (dot(sparse.surfaces[s].normal / m, guides.normal(x, y)) > 0.9F &&
            std::fabs(sparse.surfaces[s].position_m.z / m - place.z) < 0.002F && sparse.surfaces[s].kind == kind) {
          surface = &sparse.surfaces[s];
        }
      }
      if (surface == nullptr) {
        surface = &sparse.surfaces.emplace_back();
        surface->kind = kind;
      }
      surface->reflected += n * light * albedo;
      surface->albedo += n * albedo;
      surface->normal += n * guides.normal(x, y);
      surface->position_m += n * place;
      surface->square += n * light * light;
      surface->count += samples;
    });
    sparse.sum.push_back(sum);
    sparse.count.push_back(count);
    sparse.sum_square_luminance.push_back(0);
    // So much noise that the filter smooths as much as it can.
    const float noise = planted_noise(site);
    for (std::size_t s = first; s < sparse.surfaces.size(); ++s) {
      sparse.surfaces[s].half_difference = noise;
    }
    sparse.half_difference.push_back(noise);
  }
  sparse.first_surface.push_back(static_cast<std::uint32_t>(sparse.surfaces.size()));
  return sparse;
}

Frame guided(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides, int threads = 1) {
  return reconstruct(sparse, map, "guided", threads, &guides);
}

TEST(ReconstructGuided, EvenLightOnTextureGivesTheTextureExactly) {
  Guides guides = wall();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.05F, 0.95F);
  for (Vec3f& albedo : guides.albedo.pixels) {
    albedo = {uniform(random), uniform(random), uniform(random)};
  }
  const SamplingMap map = block_map();
  const Frame frame = guided(trace_planted(map, guides, [](int, int) { return 3; }), map, guides);
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    EXPECT_NEAR(frame.radiance.pixels[i].x, 3 * guides.albedo.pixels[i].x, 1e-5);
    EXPECT_NEAR(frame.radiance.pixels[i].z, 3 * guides.albedo.pixels[i].z, 1e-5);
  }
}

// A lamp shows only half of what the guides say. Its samples are sure of that for all of its blocks together, but not
// from one block to the next, so that it is kept smoothed over blocks: many times the light of the wall beside it, of
// which its own samples say that nothing is wrong.
TEST(ReconstructGuided, WhatIsWrongWithALightIsNotTakenFromWhatIsBesideIt) {
  constexpr int kLampBlock = 8;
  constexpr float kWall = 0.5F;
  Guides guides = wall();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 4 * kLampBlock; x < 4 * kLampBlock + 4; ++x) {
      guides.kind(x, y) = SurfaceKind::unlit;
      guides.normal(x, y) = {};
      guides.albedo(x, y) = {1, 1, 1};
      guides.emission(x, y) = {300, 200, 100};
    }
  }
  const SamplingMap map = block_map();
  SparseFrame sparse = trace_planted(map, guides, [](int, int) { return 1; });
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const bool lamp = map.sites[i].block_x == kLampBlock;
    sparse.half_difference[i] = (lamp ? 50.0F : 1e-4F) * (map.sites[i].block_y % 2 == 0 ? 1.0F : -1.0F);
    sparse.sum[i] *= lamp ? 0.5F : 1.0F;
  }
  for (SurfaceSums& surface : sparse.surfaces) {
    surface.half_difference = 1e-4F;
  }
  const Frame frame = guided(sparse, map, guides);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      // Between the middles of blocks a pixel takes part in what is kept of both.
      if (x < 4 * kLampBlock - 4 || x >= 4 * kLampBlock + 8) {
        EXPECT_NEAR(frame.radiance(x, y).x, kWall, 0.11F * kWall) << x << ',' << y;
        EXPECT_NEAR(frame.radiance(x, y).z, kWall, 0.11F * kWall) << x << ',' << y;
      }
    }
  }
  EXPECT_LT(frame.radiance(4 * kLampBlock + 1, kSize / 2).x, 250);  // mended in part; the guides say 300
}

// An edge through the middle of blocks, at pixel 30: beyond it another normal, another depth, or light of its own. What
// is on each side has nothing of the other's, to rounding.
TEST(ReconstructGuided, NothingCrossesAnEdgeOfNormalDepthOrEmission) {
  const SamplingMap map = block_map();
  for (const int what : {0, 1, 2, 3}) {
    Guides guides = wall();
    for (int y = 0; y < kSize; ++y) {
      for (int x = 30; x < kSize; ++x) {
        if (what == 0) {
          guides.normal(x, y) = {1, 0, 0};
        } else if (what == 1) {
          guides.depth_m(x, y) = 10.5F;
        } else {
          guides.kind(x, y) = what == 2 ? SurfaceKind::miss : SurfaceKind::unlit;
          guides.depth_m(x, y) = what == 2 ? kInfinity : 10.0F;
          guides.normal(x, y) = {};
          guides.albedo(x, y) = {1, 1, 1};
          guides.emission(x, y) = {1e4F, 2e4F, 3e4F};
        }
      }
    }
    const SparseFrame sparse = trace_planted(map, guides, [](int x, int) { return x < 30 ? 1 : 1000; });
    const Frame frame = guided(sparse, map, guides);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const float expected = x < 30 ? 0.5F : what < 2 ? 500.0F : 1e4F;
        ASSERT_NEAR(frame.radiance(x, y).x / expected, 1, 1e-5) << what << ' ' << x << ',' << y;
      }
    }
  }
}

// Where a budget leaves few samples to look at, they are not kept as they are: noise is worst there of all places.
TEST(ReconstructGuided, SinglePixelsWithFewSamplesAreSmoothedBesideCoarserBlocks) {
  const SamplingMap map = block_map(true, 1);
  const Guides guides = wall();
  std::mt19937 random(7);
  std::exponential_distribution<float> noise(1);
  const SparseFrame sparse = trace_planted(map, guides, [&](int, int) { return noise(random); });
  const auto spread_in_fovea = [&](const Frame& frame) {
    double squares = 0;
    for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      const double off = map.region.pixels[i] == 0 ? static_cast<double>(frame.radiance.pixels[i].x) - 0.5 : 0.0;
      squares += off * off;
    }
    return squares;
  };
  EXPECT_LT(spread_in_fovea(guided(sparse, map, guides)), spread_in_fovea(reconstruct(sparse, map, "none", 1)) / 16);
}

// Noise shrinks by far, and the mean of the frame stays: here every sample has the same weight in it, borders apart.
TEST(ReconstructGuided, NoiseIsSmoothedAndTheMeanKept) {
  const SamplingMap map = block_map();
  const Guides guides = wall();
  std::mt19937 random(17);
  std::uniform_real_distribution<float> noise(0, 2);
  const SparseFrame sparse = trace_planted(map, guides, [&](int, int) { return noise(random); });
  const auto mean_and_spread = [&](const Frame& frame) {
    double sum = 0;
    double squares = 0;
    for (const Vec3f& c : frame.radiance.pixels) {
      sum += static_cast<double>(c.x);
      squares += static_cast<double>(c.x) * static_cast<double>(c.x);
    }
    const double n = kSize * kSize;
    return std::pair{sum / n, squares / n - (sum / n) * (sum / n)};
  };
  const auto [none_mean, none_variance] = mean_and_spread(reconstruct(sparse, map, "none", 1));
  const auto [mean, variance] = mean_and_spread(guided(sparse, map, guides));
  EXPECT_LT(variance, none_variance / 16);
  EXPECT_NEAR(mean / none_mean, 1, 0.02);
}

// A few samples carry most of the light, as where a lamp is rarely found: smoothed it is all there still.
TEST(ReconstructGuided, RareLightIsNotLost) {
  Layout layout;
  layout.regions = {{"uniform", 1, 2, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kSize, kSize, 0);
  const SamplingMap map = map_from_layout(std::move(layout));
  Guides guides = wall();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t i = 0; i < guides.albedo.pixels.size(); ++i) {
    guides.albedo.pixels[i] = Vec3f{1, 1, 1} * (0.1F + 0.8F * unit(random));
    guides.normal.pixels[i] = normalize(Vec3f{0.3F * unit(random), 0.3F * unit(random), 1});
    guides.depth_m.pixels[i] = i % kSize < 30 ? 10.0F : 10.1F;
  }
  const SparseFrame sparse =
      trace_planted(map, guides, [&](int, int) { return unit(random) < 0.03F ? 30.0F : 0.1F * unit(random); });
  SurfaceCells cells = make_surface_cells(sparse, map, guides.camera, 1);
  const auto sums = [&] {
    Vec3d light;
    Vec3d albedo;
    for (const SurfaceCell& cell : cells.cells) {
      light += static_cast<double>(cell.samples) * to_double(cell.reflected);
      albedo += static_cast<double>(cell.samples) * to_double(cell.albedo);
    }
    return std::pair{light.x, albedo.x};
  };
  const auto [light, albedo] = sums();
  smooth_surfaces(cells, map, {}, 2);
  EXPECT_NEAR(sums().first / light, 1, 1e-5);
  EXPECT_NEAR(sums().second / albedo, 1, 1e-5);
  const auto brightest = std::max_element(cells.cells.begin(), cells.cells.end(),
                                          [](const auto& a, const auto& b) { return a.light < b.light; });
  EXPECT_LT(brightest->light, 15) << "and it is smoothed";
}

TEST(ReconstructGuided, SitesWithoutSamplesTakeFromLikeSurfacesAndNoSamplesAtAllLeaveWhatShines) {
  const SamplingMap map = block_map();
  Guides guides = wall();
  for (int y = 0; y < 4; ++y) {  // a block that has samples
    for (int x = 0; x < 4; ++x) {
      guides.emission(x, y) = {7, 7, 7};
    }
  }
  SparseFrame sparse = trace_planted(map, guides, [](int, int) { return 4; });
  SparseFrame holes = sparse;
  holes.surfaces.clear();
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    holes.first_surface[i] = static_cast<std::uint32_t>(holes.surfaces.size());
    if (map.sites[i].block_x % 3 == 0 && map.sites[i].block_y % 3 == 0) {
      holes.surfaces.push_back(sparse.surfaces[sparse.first_surface[i]]);
    } else {
      holes.sum[i] = {};
      holes.count[i] = 0;
    }
  }
  holes.first_surface.back() = static_cast<std::uint32_t>(holes.surfaces.size());
  const Frame frame = guided(holes, map, guides);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      EXPECT_NEAR(frame.radiance(x, y).x, 2 + guides.emission(x, y).x, 1e-5);
    }
  }
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    sparse.first_surface[i] = 0;
    sparse.sum[i] = {};
    sparse.count[i] = 0;
  }
  sparse.first_surface.back() = 0;
  sparse.surfaces.clear();
  for (const Vec3f& c : guided(sparse, map, guides).radiance.pixels) {
    EXPECT_TRUE(is_finite(to_double(c)));
  }
}

TEST(ReconstructGuided, FiniteForBlackAlbedoAndFarPlaces) {
  const SamplingMap map = block_map();
  Guides guides = wall();
  guides.camera.perspective = true;
  std::mt19937 random(23);
  for (std::size_t i = 0; i < guides.depth_m.pixels.size(); ++i) {
    guides.depth_m.pixels[i] = std::pow(10.0F, std::uniform_real_distribution<float>(-6, 15)(random));
    guides.albedo.pixels[i] = i % 3 == 0 ? Vec3f{} : Vec3f{1, 0, 0.5F};
    guides.normal.pixels[i] = i % 7 == 0 ? Vec3f{} : Vec3f{0, 0, 1};
    if (i % 5 == 0) {
      guides.kind.pixels[i] = SurfaceKind::miss;
      guides.depth_m.pixels[i] = kInfinity;
    }
  }
  const Frame frame =
      guided(trace_planted(map, guides, [](int x, int) { return x % 2 == 0 ? 0.0 : 1e15; }), map, guides);
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    EXPECT_TRUE(is_finite(to_double(frame.radiance.pixels[i])));
    EXPECT_TRUE(std::isfinite(frame.variance.pixels[i]));
  }
}

// A pixel that nothing near it faces: weights far under 1e-19 have squares that are 0, and their inverses no square.
TEST(ReconstructGuided, FiniteVarianceOfSurfacesSeenEdgeOn) {
  const SamplingMap map = block_map();
  Guides guides = wall();
  std::mt19937 random(29);
  std::uniform_real_distribution<float> noise(0, 2);
  const SparseFrame sparse = trace_planted(map, guides, [&](int, int) { return noise(random); });
  for (int k = 0; k < 16; ++k) {
    const float cosine = std::pow(10.0F, -0.25F * static_cast<float>(k));
    guides.normal(4 * k + 1, 30) = {std::sqrt(1 - cosine * cosine), 0, cosine};
  }
  const Frame frame = guided(sparse, map, guides);
  for (int k = 0; k < 16; ++k) {
    EXPECT_TRUE(is_finite(to_double(frame.radiance(4 * k + 1, 30)))) << k;
    EXPECT_GT(frame.variance(4 * k + 1, 30), 0) << k;
    EXPECT_LT(frame.variance(4 * k + 1, 30), 1) << k;
  }
}

// Two pixels whose rays see each other's surfaces both become the mean of what each had alone; a third takes a share of
// a lamp that no pixel's centre sees.
TEST(ReconstructGuided, EdgesAreTheMeanOfWhatTheirRaysSee) {
  const SamplingMap map = block_map();
  Guides guides = wall();
  guides.albedo(20, 9) = {0.9F, 0.1F, 0.2F};
  const SparseFrame sparse = trace_planted(map, guides, [](int, int) { return 2; });
  const Frame alone = guided(sparse, map, guides);
  const auto a = static_cast<std::uint32_t>(guides.albedo.index(20, 9));
  const auto b = static_cast<std::uint32_t>(guides.albedo.index(21, 9));
  const auto c = static_cast<std::uint32_t>(guides.albedo.index(40, 40));
  guides.edge_rays = {{a, a}, {a, b}, {b, a}, {b, a}, {b, a}, {c, 0, true}, {c, c}};
  guides.edge_surfaces.push_back({0, 0, {1, 1, 1}, {}, {30, 60, 90}, kInfinity, SurfaceKind::unlit});
  const Frame frame = guided(sparse, map, guides);
  const Vec3f first = alone.radiance.pixels[a];
  const Vec3f second = alone.radiance.pixels[b];
  const Vec3f third = alone.radiance.pixels[c];
  const auto expect = [&](std::uint32_t pixel, const Vec3f& expected) {
    EXPECT_NEAR(frame.radiance.pixels[pixel].x, expected.x, 1e-5F);
    EXPECT_NEAR(frame.radiance.pixels[pixel].y, expected.y, 1e-5F);
    EXPECT_NEAR(frame.radiance.pixels[pixel].z, expected.z, 1e-5F);
  };
  EXPECT_NEAR(first.x, 1.8F, 0.01F);
  expect(a, (first * 2.0F + second) / 3.0F);
  expect(b, (second + first * 3.0F) / 4.0F);
  expect(c, (third * 2.0F + Vec3f{30, 60, 90}) / 3.0F);
  for (std::uint32_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    if (i != a && i != b && i != c) {
      EXPECT_EQ(frame.radiance.pixels[i], alone.radiance.pixels[i]);
    }
  }
}

// Regions of single pixels, of 2x2, 3x3 and of 8x8 blocks about each other: every pixel is filled, whichever square
// between blocks it lies in.
TEST(ReconstructGuided, EveryPixelIsFilledForBlocksOfAnySize) {
  Layout layout;
  layout.regions = {{"a", 1, 1, SampleUnit::per_block},
                    {"b", 2, 4, SampleUnit::per_block},
                    {"c", 3, 5, SampleUnit::per_block},
                    {"d", 8, 8, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kSize, kSize, 3);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const int away = std::max(std::abs(x - 17), std::abs(y - 40));
      layout.region(x, y) = static_cast<std::uint8_t>(away < 6 ? 0 : away < 13 ? 1 : away < 23 ? 2 : 3);
    }
  }
  const SamplingMap map = map_from_layout(std::move(layout));
  const Guides guides = wall();
  const Frame frame = guided(trace_planted(map, guides, [](int, int) { return 5; }), map, guides);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      ASSERT_NEAR(frame.radiance(x, y).x, 2.5F, 1e-5F) << x << ',' << y;
    }
  }
}

TEST(ReconstructGuided, SameBitsForAnyNumberOfThreads) {
  const SamplingMap map = block_map(true);
  const Guides guides = wall();
  std::mt19937 random(29);
  std::exponential_distribution<float> noise(1);
  const SparseFrame sparse = trace_planted(map, guides, [&](int, int) { return noise(random); });
  EXPECT_EQ(guided(sparse, map, guides, 1).radiance, guided(sparse, map, guides, 2).radiance);
}

TEST(ReconstructGuided, RefusesInputsWithoutGuides) {
  const SamplingMap map = block_map();
  const Guides guides = wall();
  SparseFrame sparse = trace_planted(map, guides, [](int, int) { return 1; });
  EXPECT_THROW((void)reconstruct(sparse, map, "guided", 1), Error);
  sparse.first_surface.clear();
  EXPECT_THROW((void)guided(sparse, map, guides), Error);
}

}  // namespace
}  // namespace gazetrace::reconstruct_guided_test
