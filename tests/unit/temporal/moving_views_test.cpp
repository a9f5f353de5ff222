// SPDX-License-Identifier: Apache-2.0
// What other views saw of a frame's surfaces, against walls whose light is known at every point.
#include "temporal/moving_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/motion.hpp"

namespace gazetrace {
namespace {

constexpr int kSide = 580;  // more tiles than parts of the work, some of them cut by the edge
constexpr double kFovRad = 1;
const double kStep = 2 * std::tan(kFovRad / 2) / kSide;  // size of a pixel at 1 m

SamplingMap map_of_blocks(int block_px) {
  Layout layout;
  layout.regions = {{"uniform", block_px, 1, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kSide, kSide);
  return map_from_layout(std::move(layout));
}

Camera camera_at(const Vec3d& position_m) {
  Camera camera;
  camera.pose.position_m = position_m;
  camera.projection.yfov_rad = kFovRad;
  return camera;
}

// What the camera at the origin sees of the wall.
Guides guides_of_wall() {
  Guides guides;
  const auto step = static_cast<float>(kStep);
  guides.camera = {true, {0, 0, -1}, {step, 0, 0}, {0, step, 0}, {}};
  guides.albedo = ImageRgb(kSide, kSide, {0.25F, 0.25F, 0.25F});
  guides.normal = ImageRgb(kSide, kSide, {0, 0, 1});
  guides.depth_m = ImageGray(kSide, kSide, 3);
  guides.kind = Image<SurfaceKind>(kSide, kSide, SurfaceKind::diffuse);
  return guides;
}

struct Wall {
  double z_m = -3;
  Vec3f normal{0, 0, 1};
  SurfaceKind kind = SurfaceKind::diffuse;
  std::function<float(const Vec3d& place)> light;
  int samples = 1;
};

// One frame that looks along -z at a wall: every site samples it in its middle.
struct View {
  Camera camera;
  SamplingMap map;
  SparseFrame frame;
};

View view_of(const Vec3d& eye, const Wall& wall, int block_px = 1) {
  View view{camera_at(eye), map_of_blocks(block_px), {}};
  SparseFrame& frame = view.frame;
  frame.width_px = frame.height_px = kSide;
  for (std::size_t i = 0; i < view.map.sites.size(); ++i) {
    const Site& site = view.map.sites[i];
    const double side = view.map.regions[site.region].block_px;
    const double depth = eye.z - wall.z_m;
    const Vec3d place{eye.x + ((site.block_x + 0.5) * side - 0.5 * kSide) * kStep * depth,
                      eye.y - ((site.block_y + 0.5) * side - 0.5 * kSide) * kStep * depth, wall.z_m};
    SurfaceSums sums;
    const auto n = static_cast<float>(wall.samples);
    const float light = wall.light(place);
    sums.reflected = Vec3f{1, 1, 1} * (n * 0.5F * light);
    sums.albedo = Vec3f{1, 1, 1} * (n * 0.5F);
    sums.normal = wall.normal * n;
    sums.position_m = to_float(place - eye) * n;
    sums.square = n * light * light;
    sums.count = static_cast<std::uint32_t>(wall.samples);
    sums.kind = wall.kind;
    frame.first_surface.push_back(static_cast<std::uint32_t>(i));
    frame.surfaces.push_back(sums);
    frame.sum.push_back(sums.reflected);
    frame.count.push_back(sums.count);
  }
  frame.first_surface.push_back(static_cast<std::uint32_t>(frame.surfaces.size()));
  return view;
}

ViewSamples samples_of(const View& view, std::int32_t frame) {
  return {frame, &view.camera, &view.map, &view.frame};
}

JoinedSurfaces join(const View& own, const std::vector<View>& others, int threads = 2) {
  std::vector<ViewSamples> views;
  for (std::size_t k = 0; k < others.size(); ++k) {
    views.push_back(samples_of(others[k], 11 + static_cast<std::int32_t>(k)));
  }
  return surfaces_of_views(samples_of(own, 10), views, guides_of_wall(), threads);
}

std::uint64_t added(const JoinedSurfaces& joined) {
  return std::accumulate(joined.samples_of_others.begin(), joined.samples_of_others.end(), std::uint64_t{0});
}

float lit_evenly(const Vec3d&) {
  return 1;
}

// Every sample of another view that lies within the frame counts once, and only there.
TEST(MovingViews, EverySampleJoinsTheSiteThatSeesItsPlace) {
  const auto light = [](const Vec3d& place) { return static_cast<float>(5 + place.x + 0.5 * place.y); };
  const View own = view_of({0, 0, 0}, {.light = light});
  for (const Vec3d eye : {Vec3d{0.2, -0.05, 0}, Vec3d{0.05, 0.02, 0.4}, Vec3d{0, 0, -0.1}}) {
    const View other = view_of(eye, {.light = light, .samples = 3});
    const PixelProjection projection(own.camera, kSide, kSide);
    std::uint64_t inside = 0;
    for (const SurfaceSums& surface : other.frame.surfaces) {
      const Vec2d px = projection.point(eye + to_double(surface.position_m * (1.0F / 3))).px;
      inside += px.x >= 0 && px.y >= 0 && px.x < kSide && px.y < kSide ? 3 : 0;
    }
    ASSERT_GT(inside, 3U * kSide * kSide / 2);
    const JoinedSurfaces joined = join(own, {other});
    EXPECT_EQ(added(joined), inside);
    // What joins a pixel was seen at most half a pixel from its middle on each axis.
    const double half_px_m = 0.5 * kStep * 3;
    for (std::size_t i = 0; i < joined.surfaces.size(); ++i) {
      const SurfaceSums& before = own.frame.surfaces[i];
      const SurfaceSums& surface = joined.surfaces[i];
      const double own_light = before.reflected.x / before.albedo.x;
      EXPECT_NEAR(surface.reflected.x / surface.albedo.x, own_light, 1.5 * half_px_m + 1e-5) << i;
      EXPECT_EQ(surface.albedo, before.albedo);
      EXPECT_EQ(surface.position_m, before.position_m);
      EXPECT_EQ(surface.count, before.count);
    }
    double sum = 0;
    for (const float samples : joined.others_per_pixel) {
      sum += static_cast<double>(samples);
    }
    EXPECT_NEAR(sum, static_cast<double>(inside), 1e-3);
  }
}

TEST(MovingViews, OnlyTheSameSurfaceJoins) {
  const View own = view_of({0, 0, 0}, {.light = lit_evenly});
  const Vec3d eye{0.2, 0, 0};
  const auto joins = [&](const Wall& wall) { return added(join(own, {view_of(eye, wall)})); };
  EXPECT_GT(joins({.light = lit_evenly}), 0U);
  // Up to two pixels off its plane: so large in the middle, and 1.3 times in the corners.
  const double pixel_m = 3 * kStep;
  EXPECT_GT(joins({.z_m = -3 + 1.8 * pixel_m, .light = lit_evenly}), 0U);
  EXPECT_EQ(joins({.z_m = -3 + 2.8 * pixel_m, .light = lit_evenly}), 0U);
  EXPECT_GT(joins({.normal = {0.5F, 0, 0.866F}, .light = lit_evenly}), 0U) << "30 degrees";
  EXPECT_EQ(joins({.normal = {0.643F, 0, 0.766F}, .light = lit_evenly}), 0U) << "40 degrees";
  const View glossy = view_of({0, 0, 0}, {.kind = SurfaceKind::glossy, .light = lit_evenly});
  EXPECT_EQ(added(join(glossy, {view_of(eye, {.light = lit_evenly})})), 0U) << "another kind";
}

TEST(MovingViews, WhatShinesByTheViewJoinsUnderTheSameViewOnly) {
  const Wall glossy{.kind = SurfaceKind::glossy, .light = lit_evenly};
  const View own = view_of({0, 0, 0}, glossy);
  EXPECT_EQ(added(join(own, {view_of({0.2, 0, 0}, glossy)})), 0U);
  EXPECT_EQ(added(join(own, {view_of({0, 0, 0}, glossy)})), static_cast<std::uint64_t>(kSide * kSide));
}

// Under 5 degrees the middle of the wall, 3 m away, is seen from 0.26 m beside it.
TEST(MovingViews, WhatWasSeenFromFarAsideIsLeftOut) {
  const View own = view_of({0, 0, 0}, {.light = lit_evenly});
  const auto joins_middle = [&](double aside_m) {
    const JoinedSurfaces joined = join(own, {view_of({aside_m, 0, 0}, {.light = lit_evenly})});
    std::uint64_t samples = 0;
    for (std::size_t i = 0; i < own.map.sites.size(); ++i) {
      const Site& site = own.map.sites[i];
      const bool is_middle = std::abs(site.block_x - kSide / 2) <= 2 && std::abs(site.block_y - kSide / 2) <= 2;
      samples += is_middle ? joined.samples_of_others[i] : 0;
    }
    return samples;
  };
  EXPECT_GT(joins_middle(0.25), 20U);
  EXPECT_EQ(joins_middle(0.28), 0U);
}

TEST(MovingViews, WhatWasSeenTooCoarselyIsLeftOut) {
  const View fine = view_of({0, 0, 0}, {.light = lit_evenly});
  const View halved = view_of({0.01, 0.01, 0}, {.light = lit_evenly}, 2);
  const View coarse = view_of({0.01, 0.01, 0}, {.light = lit_evenly}, 4);
  EXPECT_GT(added(join(fine, {halved})), 0U);
  EXPECT_EQ(added(join(fine, {coarse})), 0U);
  EXPECT_GT(added(join(coarse, {fine})), 0U);
  // At 1.2 m a block covers what 1.6 pixels do at 3 m.
  const View near = view_of({0, 0, -1.8}, {.light = lit_evenly}, 4);
  EXPECT_GT(added(join(fine, {near})), 0U);
}

// The guides say what a pixel without samples sees, of which nobody has seen the light but the others.
TEST(MovingViews, ASiteWithoutSamplesIsLitAsOthersSawItsSurface) {
  View own = view_of({0, 0, 0}, {.light = lit_evenly});
  SparseFrame& frame = own.frame;
  frame.surfaces.clear();
  std::fill(frame.first_surface.begin(), frame.first_surface.end(), 0U);
  std::fill(frame.count.begin(), frame.count.end(), 0U);
  std::fill(frame.sum.begin(), frame.sum.end(), Vec3f{});
  const auto light = [](const Vec3d& place) { return static_cast<float>(5 + place.x); };
  const double across_m = kSide * kStep * 3;
  // Shifted by a twentieth of the frame, so that as much on the left stays unseen.
  const JoinedSurfaces joined = join(own, {view_of({across_m / 20, 0, 0}, {.light = light, .samples = 3})});
  ASSERT_EQ(joined.first_surface.size(), own.map.sites.size() + 1);
  int lit = 0;
  for (std::size_t i = 0; i < own.map.sites.size(); ++i) {
    const int x = own.map.sites[i].block_x;
    const std::uint32_t begin = joined.first_surface[i];
    ASSERT_EQ(joined.first_surface[i + 1] - begin, x < kSide / 20 ? 0U : 1U) << x;
    if (x < kSide / 20) {
      EXPECT_EQ(joined.others_per_pixel[i], 0.0F);
      continue;
    }
    ++lit;
    const SurfaceSums& surface = joined.surfaces[begin];
    const double here_m = (x + 0.5 - 0.5 * kSide) * kStep * 3;
    EXPECT_NEAR(surface.reflected.x, 0.25 * (5 + here_m), 0.25 * 0.5 * kStep * 3 + 1e-4);
    EXPECT_EQ(surface.albedo.x, 0.25F);
    EXPECT_NEAR(surface.position_m.x, here_m, 1e-5);
    EXPECT_EQ(surface.count + joined.samples_of_others[begin], 3U);
    EXPECT_EQ(joined.others_per_pixel[i], 3.0F);
  }
  EXPECT_EQ(lit, kSide * kSide * 19 / 20);
}

TEST(MovingViews, WhatNothingJoinsKeepsItsBits) {
  const View own = view_of({0, 0, 0}, {.light = lit_evenly});
  const JoinedSurfaces joined = join(own, {view_of({50, 0, 0}, {.light = lit_evenly})});
  EXPECT_EQ(added(joined), 0U);
  for (std::size_t i = 0; i < joined.surfaces.size(); ++i) {
    EXPECT_EQ(joined.surfaces[i].reflected, own.frame.surfaces[i].reflected);
    EXPECT_EQ(joined.surfaces[i].square, own.frame.surfaces[i].square);
    EXPECT_EQ(joined.surfaces[i].half_difference, 0.0F);
  }
}

// The replica of the joined light's error has the error's variance, whether the frame's own samples state one or not.
TEST(MovingViews, ReplicasHaveTheVarianceOfTheError) {
  constexpr double kDeviation = 0.3;
  std::mt19937 random(5);
  for (const int samples : {1, 2}) {
    const auto noisy_view = [&] {
      std::normal_distribution<float> noise(0, static_cast<float>(kDeviation / std::sqrt(samples)));
      View view = view_of({0, 0, 0}, {.light = [&](const Vec3d&) { return 1 + noise(random); }, .samples = samples});
      for (SurfaceSums& surface : view.frame.surfaces) {
        surface.half_difference = samples > 1 ? 0.5F * noise(random) : 0;  // of reflected, with albedo 1/2
      }
      return view;
    };
    const View own = noisy_view();
    const std::vector<View> others{noisy_view(), noisy_view(), noisy_view(), noisy_view()};
    const JoinedSurfaces joined = join(own, others);
    double replicas = 0;
    double errors = 0;
    for (const SurfaceSums& surface : joined.surfaces) {
      const double error = surface.reflected.x / static_cast<double>(surface.count) - 0.5;
      errors += error * error;
      replicas += static_cast<double>(surface.half_difference) * static_cast<double>(surface.half_difference);
    }
    // Each is a sum of 4096 squares of a normal number of this variance: 5 standard deviations.
    const double expected = kSide * kSide * 0.25 * kDeviation * kDeviation / (5 * samples);
    const double allowed = 5 * std::sqrt(2.0 / (kSide * kSide)) * expected;
    EXPECT_NEAR(errors, expected, allowed) << samples;
    EXPECT_NEAR(replicas, expected, allowed) << samples;
  }
}

TEST(MovingViews, TheSameBitsByAnyNumberOfThreads) {
  const auto light = [](const Vec3d& place) { return static_cast<float>(2 + std::sin(7 * place.x + place.y)); };
  const View own = view_of({0, 0, 0}, {.light = light}, 2);
  const std::vector<View> others{view_of({0.1, 0, 0.3}, {.light = light}), view_of({0.3, 0.1, 0}, {.light = light})};
  const std::vector<SurfaceSums> one = join(own, others, 1).surfaces;
  const std::vector<SurfaceSums> three = join(own, others, 3).surfaces;
  ASSERT_EQ(one.size(), own.map.sites.size());
  ASSERT_EQ(three.size(), one.size());
  EXPECT_NE(one[one.size() / 2].reflected, own.frame.surfaces[one.size() / 2].reflected);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].reflected, three[i].reflected);
    EXPECT_EQ(one[i].square, three[i].square);
    EXPECT_EQ(one[i].half_difference, three[i].half_difference);
  }
}

}  // namespace
}  // namespace gazetrace
