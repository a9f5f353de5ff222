// SPDX-License-Identifier: Apache-2.0
// Which pixels keep the mean of their own samples: how many samples are enough, for every kind of map.
#include <gtest/gtest.h>

#include <cstddef>
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

TEST(PassThrough, NothingPassesThroughUnlessItIsAskedFor) {
  const Vec3d gaze = small_view().direction(240, 135);
  EXPECT_EQ(enough({}, gaze), kNone);
  EXPECT_EQ(enough({}, std::nullopt), kNone);
  for (const FalloffInfo& info : falloffs()) {
    if (!info.from_picture) {
      EXPECT_EQ(enough(model(info.name), gaze), kNone) << info.name;
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
