// SPDX-License-Identifier: Apache-2.0
// Both filters on frames small enough to work out by hand, and the promises that hold for any frame.
#include "gazetrace/reconstruct.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::reconstruct_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A map from a picture of region numbers, one string a row. Blocks: region 0 of 1 px, 1 of 2 px, 2 of 4 px; 32, 16 and
// 8 samples a block.
SamplingMap map_from_picture(const std::vector<std::string>& rows) {
  Layout layout;
  layout.regions = {{"fovea", 1, 32, SampleUnit::per_block},
                    {"intermediate", 2, 16, SampleUnit::per_block},
                    {"periphery", 4, 8, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < layout.region.height_px; ++y) {
    for (int x = 0; x < layout.region.width_px; ++x) {
      layout.region(x, y) =
          static_cast<std::uint8_t>(rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] - '0');
    }
  }
  return map_from_layout(std::move(layout));
}

// Every site's mean is what `value_at` gives for the mean position of its pixels; all samples are alike, gray.
template <class ValueAt>
SparseFrame sample(const SamplingMap& map, const ValueAt& value_at) {
  SparseFrame sparse;
  sparse.width_px = map.width_px;
  sparse.height_px = map.height_px;
  for (const Site& site : map.sites) {
    double x = 0;
    double y = 0;
    for_each_pixel(map, site, [&](int px, int py) {
      x += (px + 0.5) / site.pixels;
      y += (py + 0.5) / site.pixels;
    });
    const auto n = static_cast<float>(site.samples);
    const auto value = static_cast<float>(value_at(x, y));
    sparse.sum.push_back(Vec3f{n * value, 2 * n * value, -n * value});
    sparse.count.push_back(site.samples);
    sparse.sum_square_luminance.push_back(0);
  }
  return sparse;
}

std::size_t site_at(const SamplingMap& map, int x, int y) {
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const BlockRect rect = block_rect(map, map.sites[i]);
    if (map.sites[i].region == map.region(x, y) && x >= rect.x && x < rect.x_end && y >= rect.y && y < rect.y_end) {
      return i;
    }
  }
  return map.sites.size();
}

void set_site(SparseFrame& sparse, std::size_t site, float value, std::uint32_t count) {
  const auto n = static_cast<float>(count);
  sparse.sum[site] = {n * value, 2 * n * value, -n * value};
  sparse.count[site] = count;
}

std::vector<float> red_row(const Frame& frame, int y) {
  std::vector<float> row;
  for (int x = 0; x < frame.radiance.width_px; ++x) {
    row.push_back(frame.radiance(x, y).x);
  }
  return row;
}

const std::vector<std::string> kThreeRegions{
    "222222222222", "222222222222", "222211112222", "222111111222", "221110011122", "221110001122",
    "221110011122", "222111111222", "222211112222", "222222222222", "222222222222",
};

// --- by hand -------------------------------------------------------------------------------------------------------

TEST(ReconstructNone, EveryPixelHasItsSitesMean) {
  const SamplingMap map = map_from_picture({"0111", "1111"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 0, 0), 5, 32);
  set_site(sparse, site_at(map, 1, 0), 7, 16);  // the three pixels left in the first block
  set_site(sparse, site_at(map, 2, 0), 9, 16);
  const Frame frame = reconstruct(sparse, map, "none", 1);
  EXPECT_THAT(red_row(frame, 0), testing::ElementsAre(5, 7, 9, 9));
  EXPECT_THAT(red_row(frame, 1), testing::ElementsAre(7, 7, 9, 9));
  EXPECT_EQ(frame.radiance(0, 1), (Vec3f{7, 14, -7}));
  EXPECT_EQ(frame.sample_count(0, 0), 32.0F);
  EXPECT_EQ(frame.sample_count(1, 1), 16.0F / 3.0F);
  EXPECT_EQ(frame.sample_count(3, 0), 4.0F);
  EXPECT_TRUE(frame.albedo.empty() && frame.normal.empty() && frame.depth_m.empty());
}

TEST(ReconstructLinear, TwoWholeBlocks) {
  const SamplingMap map = map_from_picture({"1111", "1111"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 2, 0), 8, 16);
  for (const int y : {0, 1}) {  // centroids at x = 1 and 3: quarter steps between, held outside
    EXPECT_THAT(red_row(reconstruct(sparse, map, "linear", 1), y), testing::ElementsAre(0, 2, 6, 8));
  }
  // Three times the samples, three times the weight: at x = 1.5, (0.75 * 16 * 0 + 0.25 * 48 * 8) / 24.
  set_site(sparse, site_at(map, 2, 0), 8, 48);
  EXPECT_FLOAT_EQ(reconstruct(sparse, map, "linear", 1).radiance(1, 0).x, 4.0F);
  EXPECT_FLOAT_EQ(reconstruct(sparse, map, "linear", 1).radiance(2, 0).x, 8.0F * 36 / 40);
}

TEST(ReconstructLinear, FourBlocksAreBilinear) {
  const SamplingMap map = map_from_picture({"1111", "1111", "1111", "1111"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 2, 2), 16, 16);
  const Frame frame = reconstruct(sparse, map, "linear", 1);
  EXPECT_EQ(frame.radiance(1, 1).x, 1.0F);  // 1/4 * 1/4
  EXPECT_EQ(frame.radiance(2, 1).x, 3.0F);  // 3/4 * 1/4
  EXPECT_EQ(frame.radiance(1, 2).x, 3.0F);
  EXPECT_EQ(frame.radiance(2, 2).x, 9.0F);
  EXPECT_EQ(frame.radiance(3, 3).x, 16.0F);
}

TEST(ReconstructLinear, BlockCutByTheFrame) {
  const SamplingMap map = map_from_picture({"11111", "11111"});  // centroids at x = 1, 3 and 4.5
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 2, 0), 3, 16);
  set_site(sparse, site_at(map, 4, 0), 9, 16);
  const Frame frame = reconstruct(sparse, map, "linear", 1);
  EXPECT_FLOAT_EQ(frame.radiance(2, 1).x, 2.25F);  // x = 2.5: 3/4 of the way from 0 to 3
  EXPECT_FLOAT_EQ(frame.radiance(3, 1).x, 5.0F);   // x = 3.5: a third of the way from 3 to 9
  EXPECT_FLOAT_EQ(frame.radiance(4, 1).x, 9.0F);
}

TEST(ReconstructLinear, BlockThatStraddlesABorder) {
  const SamplingMap map = map_from_picture({"1110", "1110"});  // the second block's part sits at x = 2.5
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 2, 0), 6, 16);
  set_site(sparse, site_at(map, 3, 0), 100, 32);
  set_site(sparse, site_at(map, 3, 1), 200, 32);
  const Frame frame = reconstruct(sparse, map, "linear", 1);
  EXPECT_FLOAT_EQ(frame.radiance(0, 0).x, 0.0F);
  EXPECT_FLOAT_EQ(frame.radiance(1, 0).x, 2.0F);  // x = 1.5: a third of the way from x = 1 to x = 2.5
  EXPECT_FLOAT_EQ(frame.radiance(2, 0).x, 6.0F);
  EXPECT_EQ(frame.radiance(3, 0).x, 100.0F);  // the finer region's own
  EXPECT_EQ(frame.radiance(3, 1).x, 200.0F);
}

TEST(ReconstructLinear, BeyondTheBorderFinerSitesStandInAsOneBlock) {
  const SamplingMap map = map_from_picture({"1100", "1100"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  int value = 0;
  for (const auto& [x, y] : {PixelIndex{2, 0}, PixelIndex{3, 0}, PixelIndex{2, 1}, PixelIndex{3, 1}}) {
    set_site(sparse, site_at(map, x, y), static_cast<float>(value += 4), 32);
  }
  // The stand-in is 10 at (3, 1) with 16 samples, not 4 * 32: a quarter of the way at x = 1.5.
  const Frame frame = reconstruct(sparse, map, "linear", 1);
  EXPECT_FLOAT_EQ(frame.radiance(1, 0).x, 2.5F);
  EXPECT_FLOAT_EQ(frame.radiance(1, 1).x, 2.5F);
  EXPECT_THAT(red_row(frame, 1), testing::ElementsAre(0, 2.5, 12, 16));
}

TEST(ReconstructLinear, BeyondTheBorderACoarserSiteStandsInWithItsFewerSamples) {
  const SamplingMap map = map_from_picture({"11112222", "11112222", "11112222", "11112222"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  set_site(sparse, site_at(map, 5, 1), 16, 8);
  const Frame frame = reconstruct(sparse, map, "linear", 1);
  // The coarse centroid (6, 2) is moved into the cell, to (5.5, 1.5); 4 pixels of half a sample each make 2 samples.
  // Pixel (3.5, 0.5) lies a fifth of the way: 0.2 * 2 / (0.8 * 16 + 0.2 * 2).
  EXPECT_FLOAT_EQ(frame.radiance(3, 0).x, 16.0F * 0.4F / 13.2F);
  EXPECT_FLOAT_EQ(frame.radiance(2, 0).x, 0.0F);  // left of its own centroid: the border is not its neighbour
  // The other side: the stand-in for the fine blocks is 0 at (2, 2) with 8 samples; x = 4.5 is 5/8 of the way.
  EXPECT_FLOAT_EQ(frame.radiance(4, 0).x, 10.0F);
  EXPECT_FLOAT_EQ(frame.radiance(7, 3).x, 16.0F);
}

TEST(Reconstruct, VarianceOfTheMeanAndOfItsCombinations) {
  const SamplingMap map = map_from_picture({"1111", "1111"});
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  // Luminances 1 and 3: mean 2, spread (10 - 2 * 4) / 1 = 2, variance of the mean 1.
  const std::size_t a = site_at(map, 0, 0);
  const std::size_t b = site_at(map, 2, 0);
  sparse.sum[a] = {4, 4, 4};
  sparse.sum_square_luminance[a] = 10;
  sparse.count[a] = 2;
  // A single sample says nothing about its spread: 1, 3 and 5 have a mean of 3 and one of (35 - 3 * 9) / 2.
  sparse.sum[b] = {5, 5, 5};
  sparse.sum_square_luminance[b] = 25;
  sparse.count[b] = 1;
  const Frame none = reconstruct(sparse, map, "none", 1);
  EXPECT_NEAR(none.variance(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(none.variance(3, 0), 4.0, 1e-6);
  // At x = 1.5 the weights are 0.75 * 2 : 0.25 * 1, so a's share is 6/7 and the variance (6/7)^2 + 4 (1/7)^2.
  const Frame linear = reconstruct(sparse, map, "linear", 1);
  EXPECT_NEAR(linear.variance(1, 0), 40.0 / 49.0, 1e-6);
  EXPECT_NEAR(linear.variance(0, 0), 1.0, 1e-6);
  // With equal counts and the same spread: 0.75^2 + 0.25^2.
  sparse.sum[b] = {4, 4, 4};
  sparse.sum_square_luminance[b] = 10;
  sparse.count[b] = 2;
  EXPECT_NEAR(reconstruct(sparse, map, "linear", 1).variance(1, 0), 0.625, 1e-6);
}

TEST(Reconstruct, SingleSamplesTakeTheirVarianceFromThoseAround) {
  Layout layout;
  layout.regions = {{"even", 1, 1, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(64, 48);
  const SamplingMap map = map_from_layout(std::move(layout));
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  std::mt19937 random{5};
  std::normal_distribution<float> light(10, 2);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const float y = light(random);
    sparse.sum[i] = {y, y, y};
    sparse.sum_square_luminance[i] = y * y;
  }
  for (const char* filter : {"none", "linear"}) {
    const Frame frame = reconstruct(sparse, map, filter, 2);
    double mean = 0;
    for (const float variance : frame.variance.pixels) {
      mean += static_cast<double>(variance) / static_cast<double>(frame.variance.pixels.size());
    }
    EXPECT_NEAR(mean, 4, 0.2) << filter;  // 3072 samples: a standard error of 0.1
  }
  // Nothing else is known of a sample without others around.
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    set_site(sparse, i, 0, i == 0 ? 1 : 0);
    sparse.sum_square_luminance[i] = 0;
  }
  sparse.sum[0] = {3, 3, 3};
  sparse.sum_square_luminance[0] = 9;
  EXPECT_FLOAT_EQ(reconstruct(sparse, map, "none", 1).variance(0, 0), 9);
}

TEST(Reconstruct, VarianceInsideEvenlySampledBlocks) {
  const SamplingMap map = map_from_picture(std::vector<std::string>(8, "11111111"));
  SparseFrame sparse = sample(map, [](double, double) { return 0; });
  for (std::size_t i = 0; i < map.sites.size(); ++i) {  // 16 samples, half 0 and half 2: spread 16 / 15
    sparse.sum[i] = {16, 16, 16};
    sparse.sum_square_luminance[i] = 32;
  }
  // Along each axis the weights are 3/4 and 1/4.
  const double expected = 0.625 * 0.625 * (16.0 / 15.0) / 16.0;
  for (const auto& [x, y] : {PixelIndex{3, 3}, PixelIndex{4, 3}, PixelIndex{3, 4}, PixelIndex{4, 4}}) {
    EXPECT_NEAR(reconstruct(sparse, map, "linear", 1).variance(x, y), expected, 1e-6 * expected);
  }
}

TEST(Reconstruct, GuidesAreInterpolatedAndAMissStaysAtInfinity) {
  const SamplingMap map = map_from_picture({"111111", "111111"});
  SparseFrame sparse = sample(map, [](double, double) { return 1; });
  sparse.guides.resize(map.sites.size());
  GuideSums& first = sparse.guides[site_at(map, 0, 0)];
  first = {{16, 0, 8}, {0, 16, 0}, 32, 16};  // all hits, depth 2 m
  GuideSums& second = sparse.guides[site_at(map, 2, 0)];
  second = {{4, 0, 0}, {0, 0, 8}, 24, 8};  // half of the 16 samples hit, depth 3 m
  const Frame none = reconstruct(sparse, map, "none", 1);
  EXPECT_EQ(none.albedo(0, 0), (Vec3f{1, 0, 0.5F}));
  EXPECT_EQ(none.albedo(2, 0), (Vec3f{0.25F, 0, 0}));
  EXPECT_EQ(none.normal(3, 1), (Vec3f{0, 0, 0.5F}));
  EXPECT_EQ(none.depth_m(0, 0), 2.0F);
  EXPECT_EQ(none.depth_m(2, 0), 3.0F);
  EXPECT_EQ(none.depth_m(4, 0), kInfinity);
  EXPECT_EQ(none.normal(5, 0), (Vec3f{}));
  const Frame linear = reconstruct(sparse, map, "linear", 1);
  EXPECT_FLOAT_EQ(linear.albedo(1, 0).x, 0.75F * 1 + 0.25F * 0.25F);
  EXPECT_FLOAT_EQ(linear.normal(1, 0).z, 0.25F * 0.5F);
  EXPECT_FLOAT_EQ(linear.depth_m(1, 0), (0.75F * 2 + 0.125F * 3) / 0.875F);
  EXPECT_FLOAT_EQ(linear.depth_m(3, 0), 3.0F);  // the third block hit nothing and does not pull
  EXPECT_EQ(linear.depth_m(4, 0), kInfinity);   // ... and stays where it is
  EXPECT_FLOAT_EQ(linear.albedo(4, 0).x, 0.0625F);
}

TEST(Reconstruct, SitesWithoutSamplesTakeTheirNeighbors) {
  const SamplingMap map = map_from_picture({"00000"});
  SparseFrame sparse = sample(map, [](double x, double) { return x; });
  const auto set = [&](int x, float value, std::uint32_t count) { set_site(sparse, site_at(map, x, 0), value, count); };
  set(0, 2, 32);
  set(1, 0, 0);
  set(2, 4, 32);
  set(3, 0, 0);
  set(4, 0, 0);
  for (const char* filter : {"none", "linear"}) {
    const Frame frame = reconstruct(sparse, map, filter, 1);
    EXPECT_THAT(red_row(frame, 0), testing::ElementsAre(2, 3, 4, 4, 4));
    EXPECT_EQ(frame.sample_count(1, 0), 0.0F);
  }
  set(2, 4, 96);  // three times the samples
  EXPECT_EQ(reconstruct(sparse, map, "none", 1).radiance(1, 0).x, 3.5F);
}

TEST(Reconstruct, OneSampledSiteFillsTheFrameAndNoneLeavesItBlack) {
  const SamplingMap map = map_from_picture(kThreeRegions);
  SparseFrame sparse = sample(map, [](double, double) { return 3; });
  const std::size_t only = site_at(map, 6, 5);
  sparse.guides.resize(map.sites.size());
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    if (i != only) {
      set_site(sparse, i, 0, 0);
    }
  }
  for (const char* filter : {"none", "linear"}) {
    const Frame frame = reconstruct(sparse, map, filter, 1);
    for (const Vec3f& value : frame.radiance.pixels) {
      EXPECT_NEAR(value.x, 3, 1e-5) << filter;
      EXPECT_NEAR(value.z, -3, 1e-5) << filter;
    }
  }
  set_site(sparse, only, 0, 0);
  for (const char* filter : {"none", "linear"}) {
    const Frame frame = reconstruct(sparse, map, filter, 1);
    for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      EXPECT_EQ(frame.radiance.pixels[i], Vec3f{});
      EXPECT_EQ(frame.variance.pixels[i], 0.0F);
      EXPECT_EQ(frame.depth_m.pixels[i], kInfinity);
    }
  }
}

// --- for any frame -------------------------------------------------------------------------------------------------

std::vector<SamplingMap> many_maps() {
  std::vector<SamplingMap> maps{map_from_picture(kThreeRegions), map_from_picture({"0"}), map_from_picture({"2"})};
  std::mt19937 random{7};
  const auto real = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto pick = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(random); };
  for (int i = 0; i < 60; ++i) {
    FoveationSettings settings;
    const double inner = real(0, 40);
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {inner / 2, (inner + real(0, 40)) / 2};
    std::get<RegionSampling>(settings.sampling).blocks_px = {pick(1, 9), pick(0, 4) == 0 ? 64 : pick(1, 12)};
    const PlanarView view = view_of_perspective(1.0, pick(1, 140), pick(1, 100));
    maps.push_back(make_sampling_map(
        settings, view, view.direction(real(-0.2, 1.2) * view.width_px, real(-0.2, 1.2) * view.height_px)));
  }
  return maps;
}

TEST(Reconstruct, ConstantsStayConstantToTheBit) {
  for (const SamplingMap& map : many_maps()) {
    for (const char* filter : {"none", "linear"}) {
      const Frame frame = reconstruct(sample(map, [](double, double) { return 0.7F; }), map, filter, 1);
      for (const Vec3f& value : frame.radiance.pixels) {
        ASSERT_EQ(value, (Vec3f{0.7F, 1.4F, -0.7F}));
      }
    }
  }
}

TEST(Reconstruct, SinglePixelSitesAreTheSameBitsAndNothingLeavesTheSamplesRange) {
  std::mt19937 random{11};
  int compared = 0;
  for (const SamplingMap& map : many_maps()) {
    SparseFrame sparse =
        sample(map, [&](double, double) { return std::uniform_real_distribution<float>(1, 2)(random); });
    for (std::size_t i = 0; i < sparse.sum.size(); ++i) {
      sparse.sum_square_luminance[i] = 9.0F * static_cast<float>(sparse.count[i]);
    }
    const Frame none = reconstruct(sparse, map, "none", 1);
    const Frame frame = reconstruct(sparse, map, "linear", 1);
    for (std::size_t i = 0; i < none.radiance.pixels.size(); ++i) {
      ASSERT_EQ(none.sample_count.pixels[i], frame.sample_count.pixels[i]);
      ASSERT_TRUE(frame.radiance.pixels[i].x >= 0.99999F && frame.radiance.pixels[i].x <= 2.00001F);
      ASSERT_TRUE(frame.variance.pixels[i] >= 0 && frame.variance.pixels[i] <= 10);
      if (map.regions[map.region.pixels[i]].block_px == 1) {
        ++compared;
        ASSERT_EQ(none.radiance.pixels[i], frame.radiance.pixels[i]);
        ASSERT_EQ(none.variance.pixels[i], frame.variance.pixels[i]);
      }
    }
  }
  EXPECT_GT(compared, 1700);
}

TEST(Reconstruct, SameBitsForAnyNumberOfThreads) {
  std::mt19937 random{13};
  for (const SamplingMap& map : many_maps()) {
    const SparseFrame sparse =
        sample(map, [&](double, double) { return std::uniform_real_distribution<float>(0, 9)(random); });
    for (const char* filter : {"none", "linear"}) {
      EXPECT_EQ(reconstruct(sparse, map, filter, 1).radiance, reconstruct(sparse, map, filter, 2).radiance);
    }
  }
}

// A ramp must come out as the same ramp inside the hull of the centroids, straddling blocks and borders to finer
// regions included. Only a block whose neighbour is coarser may differ: there the coarse value is taken at the border.
TEST(ReconstructLinear, RampsStayStraightAcrossBorders) {
  const auto ramp = [](double x, double y) { return 10 + 0.5 * x - 0.25 * y; };
  int checked = 0;
  for (const bool odd : {false, true}) {
    FoveationSettings settings;
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {10, 20};
    const PlanarView view = view_of_perspective(1.0, odd ? 143 : 144, odd ? 93 : 96);
    const SamplingMap map = make_sampling_map(settings, view, view.direction(63.3, 41.8));
    const Frame frame = reconstruct(sample(map, ramp), map, "linear", 1);
    for (int y = 4; y < map.height_px - 4; ++y) {
      for (int x = 4; x < map.width_px - 4; ++x) {
        if (map.region(x, y) == 1) {  // leave out blocks within one block of the periphery
          bool near_coarse = false;
          for (int v = y / 2 * 2 - 2; v < y / 2 * 2 + 4; ++v) {
            for (int u = x / 2 * 2 - 2; u < x / 2 * 2 + 4; ++u) {
              near_coarse = near_coarse || map.region(u, v) == 2;
            }
          }
          if (near_coarse) {
            continue;
          }
        }
        if (map.region(x, y) != 0) {
          ++checked;
          ASSERT_NEAR(frame.radiance(x, y).x, ramp(x + 0.5, y + 0.5), 2e-5) << x << "," << y;
        }
      }
    }
  }
  EXPECT_GT(checked, 18000);
}

TEST(Reconstruct, RefusesUnknownFiltersAndForeignMaps) {
  const SamplingMap map = map_from_picture({"1111", "1111"});
  SparseFrame sparse = sample(map, [](double, double) { return 1; });
  try {
    (void)reconstruct(sparse, map, "liner", 1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_THAT(e.what(), testing::HasSubstr("did you mean 'linear'"));
  }
  sparse.sum.pop_back();
  EXPECT_THROW((void)reconstruct(sparse, map, "linear", 1), Error);
  std::vector<std::string> names;
  for (const FilterInfo& info : reconstruction_filters()) {
    EXPECT_FALSE(info.description.empty());
    names.push_back(info.name);
  }
  EXPECT_THAT(names, testing::ElementsAre("none", "linear", "guided", "oidn"));
}

}  // namespace
}  // namespace gazetrace::reconstruct_test
