// SPDX-License-Identifier: Apache-2.0
// Samples of several frames as those of one, against sums by hand.
#include "temporal/frames_at_rest.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr int kSide = 64;

SamplingMap map_of(double spp, std::int32_t frame = 1) {
  FoveationSettings settings;
  settings.sampling = UniformSampling{};
  settings.spp = spp;
  MapContext context;
  context.frame = frame;
  return make_sampling_map(settings, view_of_perspective(1, kSide, kSide), std::nullopt, context);
}

SurfaceSums surface(float light, const Vec3f& normal, const Vec3f& place) {
  SurfaceSums sums;
  sums.reflected = {light, light, light};
  sums.albedo = {0.5F, 0.5F, 0.5F};
  sums.normal = normal;
  sums.position_m = place;
  sums.square = 4 * light * light;
  sums.count = 1;
  return sums;
}

// One sample in each site, of a surface that faces the camera, of this light.
template <class Light>
SparseFrame frame_of(const SamplingMap& map, const Light& light) {
  SparseFrame frame;
  frame.width_px = frame.height_px = kSide;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const float value = light(i);
    frame.sum.push_back({value, value, value});
    frame.sum_square_luminance.push_back(value * value);
    frame.count.push_back(1);
    frame.half_difference.push_back(0);
    frame.first_surface.push_back(static_cast<std::uint32_t>(i));
    frame.surfaces.push_back(surface(value, {0, 0, 1}, {0, 0, -3}));
  }
  frame.first_surface.push_back(static_cast<std::uint32_t>(frame.surfaces.size()));
  return frame;
}

GuideCamera camera() {
  GuideCamera camera;
  camera.up_step = {0, 0.01F, 0};
  return camera;
}

TEST(FramesAtRest, ThoseThatShowTheSameReadWhatIsInAllTheirWindows) {
  AccumulateSettings settings;
  settings.window = 11;
  for (const std::int32_t hold : {1, 2, 4, 12}) {
    settings.hold = hold;
    for (std::int64_t group = -2; group < 5; ++group) {
      const std::int64_t first = 1 + group * hold;
      for (std::int64_t frame = first; frame < first + hold; ++frame) {
        const ShownAtRest shown = shown_at_rest(frame, frame + settings.window, settings);
        EXPECT_EQ(shown.first, first + hold - 1 - 11) << frame;
        EXPECT_EQ(shown.last, first + 11) << frame;
      }
    }
  }
  settings.hold = 100;  // more than a window can hold
  EXPECT_EQ(shown_at_rest(12, 12 + settings.window, settings).first, 1);
  EXPECT_EQ(shown_at_rest(12, 12 + settings.window, settings).last, 12);
  settings.hold = 0;
  EXPECT_EQ(shown_at_rest(3, 3 + settings.window, settings).first, 4 - 11);
  EXPECT_EQ(shown_at_rest(3, 3 + settings.window, settings).last, 1 + 11);
  // Frame 3 is the last one: its group has no fourth.
  EXPECT_EQ(shown_at_rest(3, 3, settings).first, 3 - 11);
  settings.window = 2;
  EXPECT_EQ(shown_at_rest(7, 7 + settings.window, settings).first, 5);
  EXPECT_EQ(shown_at_rest(7, 7 + settings.window, settings).last, 9);
}

TEST(FramesAtRest, SumsAndCountsAreThoseOfAllSamples) {
  const SamplingMap map = map_of(1);
  const SparseFrame one = frame_of(map, [](std::size_t i) { return 0.25F * static_cast<float>(i % 7); });
  const SparseFrame two = frame_of(map, [](std::size_t i) { return 1.0F + static_cast<float>(i % 3); });
  const GuideCamera eye = camera();
  const SamplesAtRest all = add_up({{4, &map, &one}, {5, &map, &two}}, &eye, 2);
  ASSERT_EQ(all.sparse.surfaces.size(), map.sites.size()) << "both frames saw one surface in every site";
  EXPECT_EQ(all.map.samples(), 2 * map.samples());
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const float a = one.sum[i].x;
    const float b = two.sum[i].x;
    EXPECT_FLOAT_EQ(all.sparse.sum[i].y, a + b);
    EXPECT_FLOAT_EQ(all.sparse.sum_square_luminance[i], a * a + b * b);
    EXPECT_EQ(all.sparse.count[i], 2U);
    EXPECT_EQ(all.map.sites[i].samples, 2U);
    // Of one sample each: half the difference of the frame with the even number and that with the odd one.
    EXPECT_NEAR(all.sparse.half_difference[i], (a - b) / 2, 1e-6);
    const SurfaceSums& sums = all.sparse.surfaces[all.sparse.first_surface[i]];
    EXPECT_FLOAT_EQ(sums.reflected.z, a + b);
    EXPECT_FLOAT_EQ(sums.square, 4 * (a * a + b * b));
    EXPECT_EQ(sums.count, 2U);
    EXPECT_NEAR(sums.half_difference, (a - b) / 2, 1e-6);
  }
}

TEST(FramesAtRest, OtherSurfacesOfASiteStayApart) {
  const SamplingMap map = map_of(1);
  const SparseFrame one = frame_of(map, [](std::size_t) { return 1.0F; });
  SparseFrame two = one;
  for (std::size_t i = 0; i < map.sites.size(); i += 2) {
    two.surfaces[i] = surface(3, {1, 0, 0}, {0, 0, -8});
  }
  const GuideCamera eye = camera();
  const SamplesAtRest all = add_up({{1, &map, &one}, {2, &map, &two}}, &eye, 2);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    EXPECT_EQ(all.sparse.first_surface[i + 1] - all.sparse.first_surface[i], i % 2 == 0 ? 2U : 1U);
  }
}

// Single samples of unit variance in n frames: the replica must be as large as the error of their mean, 1 / n.
TEST(FramesAtRest, TheReplicaIsAsLargeAsTheErrorOfTheMean) {
  const SamplingMap map = map_of(1);
  std::mt19937 random(7);
  std::normal_distribution<float> light(10, 1);
  for (const int count : {2, 3, 8}) {
    std::vector<SparseFrame> frames;
    for (int k = 0; k < count; ++k) {
      frames.push_back(frame_of(map, [&](std::size_t) { return light(random); }));
    }
    std::vector<SamplesOfFrame> given;
    for (int k = 0; k < count; ++k) {
      given.push_back({k + 1, &map, &frames[static_cast<std::size_t>(k)]});
    }
    const GuideCamera eye = camera();
    const SamplesAtRest all = add_up(given, &eye, 1);
    double squares = 0;
    for (const float difference : all.sparse.half_difference) {
      squares += static_cast<double>(difference) * static_cast<double>(difference);
    }
    const auto sites = static_cast<double>(map.sites.size());
    // Chi squared of so many degrees of freedom, within four standard deviations.
    EXPECT_NEAR(squares / sites * count, 1, 4 * std::sqrt(2 / sites)) << count << " frames";
  }
}

TEST(FramesAtRest, RatesMayDifferButNotBlocks) {
  EXPECT_TRUE(same_sites(map_of(0.4, 1), map_of(0.4, 2)));
  EXPECT_TRUE(same_sites(map_of(2), map_of(7)));
  FoveationSettings settings;
  settings.sampling = RegionSampling{};
  const PlanarView view = view_of_perspective(1, kSide, kSide);
  const auto looking_at = [&](double x) { return make_sampling_map(settings, view, view.direction(x, 30)); };
  EXPECT_TRUE(same_sites(looking_at(30), looking_at(30)));
  EXPECT_FALSE(same_sites(looking_at(30), looking_at(40)));
  EXPECT_FALSE(same_sites(looking_at(30), map_of(2)));
}

// 201 times a value that has no short binary form: the sum is that of whole numbers, rounded once.
TEST(FramesAtRest, GuidesOfManyFramesAreRoundedOnce) {
  const SamplingMap map = map_of(1);
  SparseFrame one = frame_of(map, [](std::size_t) { return 1.0F; });
  GuideSums guides;
  guides.albedo = {0.1F, 0.7F, 0.3F};
  guides.normal = {0.6F, -0.1F, 0.9F};
  guides.depth_m = 12345.678F;
  guides.hits = 1;
  one.guides.assign(map.sites.size(), guides);
  constexpr std::int32_t kFrames = 201;
  std::vector<SamplesOfFrame> given;
  given.reserve(kFrames);
  for (std::int32_t k = 0; k < kFrames; ++k) {
    given.push_back({k + 1, &map, &one});
  }
  const GuideCamera eye = camera();
  const SamplesAtRest all = add_up(given, &eye, 2);
  const auto times = [](float value) { return static_cast<float>(kFrames * static_cast<double>(value)); };
  for (const GuideSums& sums : all.sparse.guides) {
    EXPECT_EQ(sums.albedo, (Vec3f{times(0.1F), times(0.7F), times(0.3F)}));
    EXPECT_EQ(sums.normal, (Vec3f{times(0.6F), times(-0.1F), times(0.9F)}));
    EXPECT_EQ(sums.depth_m, times(12345.678F));
    EXPECT_EQ(sums.hits, 201U);
  }
}

}  // namespace
}  // namespace gazetrace
