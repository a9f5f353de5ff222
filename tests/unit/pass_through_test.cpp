// SPDX-License-Identifier: Apache-2.0
// Which pixels keep the mean of their own samples: how many samples are enough, for every kind of map.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "gazetrace/display.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

FoveationSettings model(const std::string& name) {
  FoveationSettings settings;
  settings.falloff = name;
  settings.parameters.table = {"", {{0, 1}, {5, 0.5}, {20, 0.1}, {60, 0.02}}};
  return settings;
}

PlanarView small_view() {
  return view_of_display(display_by_name("paper"), {}, 480, 270);
}

std::uint32_t enough(const FoveationSettings& settings, const std::optional<Vec3d>& gaze,
                     const std::optional<std::uint64_t>& asked = {}) {
  return PassThrough(make_sampling_map(settings, small_view(), gaze), asked).enough_samples();
}

TEST(PassThrough, AFoveaAtItsFullRateHasEnoughSamples) {
  const Vec3d gaze = small_view().direction(240, 135);
  FoveationSettings regions;
  EXPECT_EQ(enough(regions, gaze), 16U);
  EXPECT_EQ(enough(regions, std::nullopt), kNone);
  regions.region_samples = {15, 8, 4};
  EXPECT_EQ(enough(regions, gaze), 15U);
  regions.uniform_spp = 12;
  EXPECT_EQ(enough(regions, std::nullopt), kNone);  // nowhere more than elsewhere
  regions.region_samples = {7, 4, 2};
  EXPECT_EQ(enough(regions, gaze), 16U);
  for (const FalloffInfo& info : falloffs()) {
    if (info.name != "regions" && !info.from_picture) {
      FoveationSettings settings = model(info.name);
      settings.uniform_spp = 9;
      EXPECT_EQ(enough(settings, gaze), info.name == "uniform" ? kNone : 9U) << info.name;
    }
  }
}

TEST(PassThrough, WhatIsAskedForHoldsInEveryMap) {
  using Counts = std::pair<std::uint32_t, std::uint32_t>;
  for (const auto& [asked, taken] : {Counts{0, kNone}, Counts{1, 1}, Counts{64, 64}}) {
    EXPECT_EQ(enough({}, small_view().direction(240, 135), asked), taken);
    EXPECT_EQ(enough({}, std::nullopt, asked), taken);
  }
}

TEST(PassThrough, OnABudgetTheFullRateIsWhatTheBudgetMakesOfIt) {
  const PlanarView view = small_view();
  for (const std::string name : {"regions", "acuity"}) {
    FoveationSettings settings = model(name);
    for (const double spp : {0.3, 0.6, 1.2, 2.4, 4.8}) {
      settings.budget_spp = spp;
      const SamplingMap map = make_sampling_map(settings, view, view.direction(240, 135));
      const std::uint32_t enough_samples = PassThrough(map, {}).enough_samples();
      const float most = samples_per_pixel(map)(240, 135);
      if (most >= 9 && most < 16) {
        EXPECT_NEAR(static_cast<float>(enough_samples), most, 1) << name;
        EXPECT_GE(most, static_cast<float>(enough_samples)) << name;
      } else if (most < 7 || most > 16) {
        EXPECT_EQ(enough_samples, 16U) << name;
      }
    }
  }
}

TEST(PassThrough, BlocksAreFilteredHoweverManySamplesTheyHave) {
  const PlanarView view = small_view();
  const SamplingMap map = make_sampling_map({}, view, view.direction(240, 135));
  const PassThrough pass_through(map, 1);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    ASSERT_EQ(pass_through.needs_filtering(i), map.regions[map.sites[i].region].block_px > 1);
  }
}

}  // namespace
}  // namespace gazetrace
