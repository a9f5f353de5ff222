// SPDX-License-Identifier: Apache-2.0
// Whole counts from real-valued rates: unbiased, of seed and frame alone, without stripes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "foveation/sites.hpp"
#include "foveation/whole_counts.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace::whole_counts_test {
namespace {

FoveationSettings geisler_perry() {
  FoveationSettings settings;
  settings.sampling = parse_density("geisler-perry");
  return settings;
}

PlanarView small_view() {
  return view_of_display(display_by_name("paper"), {}, 480, 270);
}

// Any rates: the mean over seeds of every count is its expectation, each count within 1 of it, the total within 1. The
// statistic of each site is a binomial share; with 400 sites a bound of 4.9 sigma leaves 4e-4 for a false alarm.
TEST(WholeCounts, AreUnbiased) {
  constexpr int kSeeds = 4000;
  const PlanarView view = view_of_perspective(1.0, 20, 20);
  FoveationSettings uniform;
  SamplingMap map = make_sampling_map(uniform, view, std::nullopt);
  std::vector<double> weights(map.sites.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = i % 5 == 0 ? 0.5 : 0.003 + 2.7 * std::pow(std::sin(0.37 * static_cast<double>(i)), 2);
  }
  double sum = 0;
  for (const double w : weights) {
    sum += w;
  }
  std::vector<double> ups(weights.size(), 0);
  for (int seed = 0; seed < kSeeds; ++seed) {
    set_whole_counts(map, weights, 1, 1e6, static_cast<std::uint64_t>(seed), 3);
    EXPECT_LE(std::abs(static_cast<double>(map.samples()) - sum), 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double up = map.sites[i].samples - std::floor(weights[i]);
      ASSERT_TRUE(up == 0 || up == 1);
      ups[i] += up;
    }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double p = weights[i] - std::floor(weights[i]);
    const double sigma = std::sqrt(p * (1 - p) / kSeeds);
    EXPECT_NEAR(ups[i] / kSeeds, p, 4.9 * sigma + 1e-9) << "site " << i;
  }
}

TEST(WholeCounts, DependOnSeedAndFrameAlone) {
  const PlanarView view = small_view();
  const Vec3d gaze = view.direction(77, 99);
  const FoveationSettings settings = geisler_perry();
  const auto counts = [&](std::uint64_t seed, std::int32_t frame, int threads) {
    MapContext context;
    context.seed = seed;
    context.frame = frame;
    context.threads = threads;
    std::vector<std::uint32_t> list;
    for (const Site& site : make_sampling_map(settings, view, gaze, context).sites) {
      list.push_back(site.samples);
    }
    return list;
  };
  EXPECT_EQ(counts(1, 5, 1), counts(1, 5, 3));
  EXPECT_NE(counts(1, 5, 1), counts(1, 6, 1));
  EXPECT_NE(counts(1, 5, 1), counts(2, 5, 1));
}

// A rate of 1/2 must not round up whole columns or rows of the picture.
TEST(WholeCounts, HalfASampleMakesNoStripes) {
  const PlanarView view = view_of_perspective(1.0, 128, 128);
  FoveationSettings settings;
  settings.spp = 0.5;
  MapContext context;
  context.seed = 9;
  const ImageGray counts = samples_per_pixel(make_sampling_map(settings, view, std::nullopt, context));
  for (int i = 0; i < 128; ++i) {
    double row = 0;
    double column = 0;
    for (int k = 0; k < 128; ++k) {
      row += static_cast<double>(counts(k, i));
      column += static_cast<double>(counts(i, k));
    }
    // Two of each 2 x 2 pixels: a row's count is a sum of 64 terms of 0, 1, 2 with mean 1 and variance 1/3.
    EXPECT_NEAR(row, 64, 5 * std::sqrt(64 / 3.0)) << i;
    EXPECT_NEAR(column, 64, 5 * std::sqrt(64 / 3.0)) << i;
  }
}

}  // namespace
}  // namespace gazetrace::whole_counts_test
