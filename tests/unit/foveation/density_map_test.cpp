// SPDX-License-Identifier: Apache-2.0
// From densities to sampling maps: blocks, budgets, terms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "support/map_consistency.hpp"
#include "support/sampling_models.hpp"

namespace gazetrace::density_map_test {
namespace {

PlanarView small_view() {
  return view_of_display(display_by_name("paper"), {}, 480, 270);
}

double expected_sum(const SamplingMap& map) {
  double sum = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    sum += map.expected(i);
  }
  return sum;
}

TEST(DensityMap, EveryModelGivesAConsistentMap) {
  const PlanarView view = small_view();
  for (const std::string& name : all_models()) {
    SCOPED_TRACE(name);
    for (const Vec2d at : {Vec2d{240, 135}, Vec2d{3.5, 200}, Vec2d{-4000, 100}}) {
      const SamplingMap map = make_sampling_map(model(name), view, view.direction(at.x, at.y));
      expect_consistent(map);
      // In all, the whole counts are what was expected to within one sample.
      EXPECT_NEAR(static_cast<double>(map.samples()), expected_sum(map), 1.01);
    }
  }
}

TEST(DensityMap, BlocksAreTheSmallestThatExpectEnough) {
  const PlanarView view = small_view();
  const Vec3d gaze = view.direction(200.3, 100.8);
  for (const std::string name : {"mar", "geisler-perry", "acuity", "linear", "retina", "log-polar", "curve"}) {
    SCOPED_TRACE(name);
    for (const std::uint32_t spp : {32U, 3U}) {
      FoveationSettings settings = model(name);
      density_of(settings).full_rate_spp = spp;
      const SamplingMap map = make_sampling_map(settings, view, gaze);
      const ImageGray density = *density_image(settings, view, gaze);
      const double wanted = std::min(settings.block_samples, static_cast<double>(spp));
      std::vector<PixelIndex> pixels;
      for (std::size_t i = 0; i < map.sites.size(); ++i) {
        const Site& site = map.sites[i];
        const double side = map.regions[site.region].block_px;
        pixels_of_site(map, site, pixels);
        double least = 1;
        double most = 0;
        double sum = 0;
        for (const PixelIndex& p : pixels) {
          const auto here = static_cast<double>(density(p.x, p.y));
          least = std::min(least, here);
          most = std::max(most, here);
          sum += here;
        }
        if (side > 1) {
          EXPECT_LT(most * spp * side * side / 4, wanted);  // half the side would not do anywhere in it
          // The middle of a block stands for all of it.
          EXPECT_LE(map.expected(i), most * spp * site.pixels * (1 + 1e-6));
          EXPECT_GE(map.expected(i), least * spp * site.pixels * (1 - 1e-6));
        } else {
          EXPECT_NEAR(map.expected(i), sum * spp, 1e-5 * spp);
        }
        if (most == 1) {
          EXPECT_EQ(side, 1);
          EXPECT_EQ(site.samples, spp);  // exactly, wherever it stands in the order
        }
      }
      // Most blocks expect enough: one that does not is next to a denser place, by the margin of the bound.
      const auto poor = std::count_if(map.sites.begin(), map.sites.end(), [&](const Site& site) {
        const double side = map.regions[site.region].block_px;
        const auto index = static_cast<std::size_t>(&site - map.sites.data());
        return side < settings.max_block_px && site.pixels == side * side && map.expected(index) < 0.7 * wanted;
      });
      EXPECT_LT(static_cast<double>(poor), 0.25 * static_cast<double>(map.sites.size()));
    }
  }
}

TEST(DensityMap, BudgetsAreMet) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, 480, 270);
  const double pixels = 480.0 * 270;
  for (const std::string& name : all_models()) {
    for (const double spp : {0.13, 1.04, 7.5, 200.0}) {
      for (const Vec2d at : {Vec2d{240, 135}, Vec2d{475, 5}}) {
        FoveationSettings settings = model(name);
        settings.spp = spp;
        const SamplingMap map = make_sampling_map(settings, view, view.direction(at.x, at.y));
        expect_consistent(map);
        EXPECT_NEAR(static_cast<double>(map.samples()), spp * pixels, 1.01) << name << " " << spp;
      }
    }
  }
  // Frames without gaze, too.
  FoveationSettings settings;
  settings.spp = 1.04;
  const SamplingMap map = make_sampling_map(settings, view, std::nullopt);
  EXPECT_NEAR(static_cast<double>(map.samples()), 1.04 * pixels, 1.01);
  EXPECT_EQ(map.regions[0].block_px, 1);
}

TEST(DensityMap, ABudgetBeyondEveryLimitIsRefusedAndOneJustBelowIsMet) {
  const PlanarView view = view_of_perspective(1.0, 20, 20);
  FoveationSettings settings = model("mar");
  settings.spp = 1'000'000.1;
  EXPECT_THROW(make_sampling_map(settings, view, view.direction(3, 3)), Error);
  settings.spp = 399e6 / 400;  // nearly all sites at their limit of 10^6 a pixel
  const SamplingMap map = make_sampling_map(settings, view, view.direction(3, 3));
  EXPECT_NEAR(static_cast<double>(map.samples()), 399e6, 1.01);
  for (const Site& site : map.sites) {
    EXPECT_LE(site.samples, 1'000'000U * site.pixels);
  }
}

TEST(DensityMap, WholeRatesStayAsTheyAre) {
  const PlanarView view = small_view();
  const Vec3d gaze = view.direction(200, 100);
  const SamplingMap before = make_sampling_map({}, view, gaze);
  FoveationSettings settings;
  settings.spp = static_cast<double>(before.samples()) / (view.width_px * view.height_px);
  const SamplingMap same = make_sampling_map(settings, view, gaze);
  ASSERT_EQ(same.sites.size(), before.sites.size());
  for (std::size_t i = 0; i < before.sites.size(); ++i) {
    EXPECT_EQ(same.sites[i].samples, before.sites[i].samples);
  }
  EXPECT_TRUE(before.expected_samples.empty());
  EXPECT_EQ(before.expected(7), before.sites[7].samples);
}

TEST(DensityMap, MirrorSymmetricAboutTheGaze) {
  // The gaze on the corner between four blocks of every size, in the middle of the frame.
  const PlanarView view = view_of_perspective(1.1, 128, 64);
  const Vec3d gaze = view.direction(64, 32);
  for (const std::string& name : all_models()) {
    FoveationSettings settings = model(name);
    const SamplingMap map = make_sampling_map(settings, view, gaze);
    const auto density = density_image(settings, view, gaze);
    const bool top_is_bottom = name != "retina";  // its upper meridian differs from the lower
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 128; ++x) {
        ASSERT_EQ(map.region(x, y), map.region(127 - x, y)) << name << " " << x << "," << y;
        if (top_is_bottom) {
          ASSERT_EQ(map.region(x, y), map.region(x, 63 - y)) << name << " " << x << "," << y;
        }
        if (density) {
          ASSERT_NEAR((*density)(x, y), (*density)(127 - x, y), 1e-6) << name;
        }
      }
    }
  }
}

// The bump of a curve may lie within one block.
TEST(DensityMap, BlocksSeeTheBumpOfACurve) {
  const PlanarView view = small_view();
  const Vec3d gaze = view.direction(240, 135);
  FoveationSettings settings;
  settings.sampling = a_curve({{0, 0.01}, {9.8, 0.01}, {10, 1}, {10.2, 0.01}, {60, 0.01}});
  const SamplingMap map = make_sampling_map(settings, view, gaze);
  expect_consistent(map);
  const ImageGray density = *density_image(settings, view, gaze);
  for (int y = 0; y < view.height_px; ++y) {
    for (int x = 0; x < view.width_px; ++x) {
      const double side = map.regions[map.region(x, y)].block_px;
      if (side > 1) {
        ASSERT_LT(static_cast<double>(density(x, y)) * 32 * side * side / 4, 8) << x << ',' << y;
      }
    }
  }
}

TEST(DensityMap, ExtremesGiveMaps) {
  const PlanarView plain = view_of_perspective(1.0, 61, 37);
  for (const std::string& name : all_models()) {
    SCOPED_TRACE(name);
    for (const Vec3d& gaze : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, plain.direction(600, -370)}) {
      expect_consistent(make_sampling_map(model(name), plain, gaze));
    }
    const PlanarView dot = view_of_perspective(1.0, 1, 1);
    expect_consistent(make_sampling_map(model(name), dot, dot.direction(0.5, 0.5)));
    for (const double fov_deg : {0.1, 179.0}) {
      const PlanarView view = view_of_perspective(fov_deg * kRadPerDeg, 50, 30);
      expect_consistent(make_sampling_map(model(name), view, view.direction(20, 3)));
    }
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make_sampling_map(model(name), plain, Vec3d{kNan, 0, -1}), Error);
    EXPECT_THROW(make_sampling_map(model(name), plain, Vec3d{0, 0, 0}), Error);
  }
  FoveationSettings settings = model("mar");  // a floor of 1
  density_of(settings).least_density = 1;
  EXPECT_EQ(make_sampling_map(settings, plain, Vec3d{0, 0, -1}).samples(), 32U * 61 * 37);
}

}  // namespace
}  // namespace gazetrace::density_map_test
