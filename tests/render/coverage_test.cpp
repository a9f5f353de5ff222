// SPDX-License-Identifier: Apache-2.0
// How much of a pixel surfaces cover: closed forms, and the tracer's own samples.
#include "gazetrace/coverage.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <iostream>
#include <map>

#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/guides.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::coverage_test {
namespace {

using namespace test;

constexpr int kWidth = 16, kHeight = 12;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::uint32_t kWall = 0x11112222, kBall = 0x33334444;

// An orthographic camera whose pixels are 1 m wide; the frame's centre is the world's.
Camera flat_camera() {
  Camera camera;
  camera.pose.position_m = {0, 0, 5};
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = kHeight / 2.0;
  return camera;
}

// A wall from x = -20 m to `edge_m`.
Scene wall_to(float edge_m) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, {quad({{{-20, -20, 0}, {edge_m, -20, 0}, {edge_m, 20, 0}, {-20, 20, 0}}}, 0)});
  return scene;
}

float share_of(const Coverage& coverage, std::uint32_t id, int x, int y) {
  for (std::size_t rank = 0; rank < coverage.id.size(); ++rank) {
    if (std::bit_cast<std::uint32_t>(coverage.id[rank](x, y)) == id) {
      return coverage.share[rank](x, y);
    }
  }
  return 0;
}

TEST(Coverage, AnEdgeCoversItsPartOfAPixel) {
  for (const float inside : {0.125F, 0.3F, 0.77F}) {
    const Scene scene = wall_to(1 + inside);  // through pixel 9
    PathTracer tracer(scene, threads(2));
    const Coverage coverage =
        tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {{false, {kWall}}}, {.rays = 256})[0];
    for (int y = 0; y < kHeight; ++y) {
      EXPECT_EQ(share_of(coverage, kWall, 8, y), 1.0F);
      // 256 rays stand in 256 columns of equal width, one in each.
      EXPECT_NEAR(share_of(coverage, kWall, 9, y), inside, 1.0 / 256 + 1e-6) << inside;
      EXPECT_EQ(share_of(coverage, kWall, 10, y), 0.0F);
    }
  }
}

TEST(Coverage, ThePixelFilterSpreadsTheEdge) {
  const Scene scene = wall_to(1.5F);  // through the centre of pixel 9
  PathTracer tracer(scene, threads(2));
  const Coverage coverage = tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {{false, {kWall}}},
                                                      {.rays = 1024, .filter = PixelFilter::blackman_harris})[0];
  // The part of the window on the wall's side of the edge: 1.5 px wide to each side, integrated by hand.
  const auto part = [](double from_center) {
    const double x = std::clamp((from_center + 1.5) / 3, 0.0, 1.0);
    const double t = 2 * kPi * x;
    return x + (-0.48829 * std::sin(t) + 0.14128 / 2 * std::sin(2 * t) - 0.01168 / 3 * std::sin(3 * t)) /
                   (2 * kPi * 0.35875);
  };
  for (int x = 7; x <= 11; ++x) {
    EXPECT_NEAR(share_of(coverage, kWall, x, 5), part(9 - x), 3e-3) << x;
  }
}

TEST(Coverage, RanksGoFromMuchToLittleAndAddUp) {
  Scene scene = wall_to(20);
  for (int i = 0; i < 3; ++i) {  // boards before the wall, over 1/8, 1/4 and 1/2 of pixel (9, 5)
    const float left = 1 + (i == 0 ? 0 : i == 1 ? 0.125F : 0.375F);
    const float right = 1 + (i == 0 ? 0.125F : i == 1 ? 0.375F : 0.875F);
    add_mesh(scene, {quad({{{left, -9, 1}, {right, -9, 1}, {right, 9, 1}, {left, 9, 1}}}, 0)});
  }
  PathTracer tracer(scene, threads(2));
  const SurfaceIds ids{false, {8, 1, 2, 4}};
  const Coverage all = tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {ids}, {.rays = 64})[0];
  const auto id = [](const Coverage& c, std::size_t rank) { return std::bit_cast<std::uint32_t>(c.id[rank](9, 5)); };
  EXPECT_EQ(id(all, 0), 4U);
  EXPECT_EQ(id(all, 1), 2U);
  EXPECT_EQ(id(all, 2), 1U);  // of the board and the wall behind, which have an eighth each, the smaller number
  EXPECT_EQ(id(all, 3), 8U);
  EXPECT_EQ(id(all, 4), 0U);
  EXPECT_EQ(all.share[0](9, 5) + all.share[1](9, 5) + all.share[2](9, 5) + all.share[3](9, 5), 1.0F);
  const Coverage two = tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {ids}, {.rays = 64, .ranks = 2})[0];
  ASSERT_EQ(two.id.size(), 2U);
  EXPECT_EQ(id(two, 1), 2U);
  EXPECT_EQ(two.share[0](9, 5), 0.5F);
  // Surfaces of one identifier are one; identifier 0 is not counted.
  const Coverage joined =
      tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {{false, {7, 7, 0, 7}}}, {.rays = 64})[0];
  EXPECT_EQ(id(joined, 0), 7U);
  EXPECT_EQ(joined.share[0](9, 5), 0.75F);
  EXPECT_EQ(id(joined, 1), 0U);
}

// What covers a pixel through lens, shutter and half-transparent surfaces is what the samples hit there.
TEST(Coverage, SeesWhatTheSamplesSee) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1}), diffuse_material({1, 0, 0})};
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].base_color.w = 0.4F;
  add_mesh(scene, box(0.5F, false, 0));
  add_mesh(scene, {quad({{{-2, -2, 1}, {2, -2, 1}, {2, 0, 1}, {-2, 0, 1}}}, 1)});
  scene.motions.push_back({[](std::int64_t t) {
    return make_affine({static_cast<double>(t) / kSecond, 0.4, 0}, {}, {1, 1, 1});
  }});
  scene.instances[0].motion = 0;
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.lens = {0.2, 6};
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({-kSecond / 2, kSecond / 2});
  constexpr int kRays = 1024;
  const std::vector<Coverage> coverage =
      posed.coverage(camera, 1, kWidth, kHeight, {{false, {kBall, kWall}}, {true, {1, 2}}}, {.rays = kRays});
  TraceSettings settings;
  settings.guides = true;
  settings.max_bounces = 0;
  const SparseFrame samples = posed.trace(camera, 1, uniform_map(kWidth, kHeight, kRays), settings);
  const SamplingMap map = uniform_map(kWidth, kHeight, kRays);
  int mixed = 0;
  for (std::size_t site = 0; site < map.sites.size(); ++site) {
    const int x = map.sites[site].block_x;
    const int y = map.sites[site].block_y;
    double shares = 0;
    for (const ImageGray& share : coverage[0].share) {
      shares += static_cast<double>(share(x, y));
    }
    const double hits = static_cast<double>(samples.guides[site].hits) / samples.count[site];
    // Six standard deviations of two independent counts; those of stratified samples are smaller.
    const double sigma = std::sqrt(2 * std::max(hits * (1 - hits), 1.0 / kRays) / kRays);
    EXPECT_NEAR(shares, hits, 6 * sigma) << x << ' ' << y;
    mixed += hits > 0.05 && hits < 0.95 ? 1 : 0;
    EXPECT_EQ(share_of(coverage[0], kWall, x, y), share_of(coverage[1], 2, x, y));
    if (static_cast<double>(share_of(coverage[0], kBall, x, y)) == 0 && y > kHeight - 4 && x > 4 && x < 11) {
      EXPECT_NEAR(share_of(coverage[0], kWall, x, y), 0.4, 6 * std::sqrt(0.24 / kRays));
    }
  }
  EXPECT_GT(mixed, 30);
}

// The shipped scene, by an independent way: the guides' object at the centre of every pixel.
TEST(Coverage, MattesOfTheCourtyardAgreeWithItsObjects) {
  const Scene scene = load_scene(std::string(GAZETRACE_SOURCE_DIR) + "/scenes/courtyard/courtyard.gltf");
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at_rest();
  const CameraPath& path = scene.cameras.front().path;
  Camera camera;
  camera.pose = path.pose_at(path.begin_ns);
  camera.projection = path.projection;
  constexpr int kAcross = 240, kDown = 135;
  const MatteTable table = matte_table(scene, "crypto_object");
  const Coverage mattes = posed.coverage(camera, 1, kAcross, kDown, {table.surfaces}, {.rays = 64})[0];
  const Guides guides = posed.guides(camera, kAcross, kDown, {});
  int whole = 0;
  int other = 0;
  std::map<std::uint32_t, std::pair<double, double>> areas;  // by identifier: of mattes, and of centres
  std::map<std::uint32_t, double> edges;                     // the variance of a count of centres
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const std::uint32_t object = guides.object(x, y);
      const std::uint32_t id = object == 0 ? 0 : table.surfaces.ids[object - 1];
      areas[id].second += id != 0 ? 1 : 0;
      double covered = 0;
      for (std::size_t rank = 0; rank < mattes.id.size(); ++rank) {
        const auto at_rank = std::bit_cast<std::uint32_t>(mattes.id[rank](x, y));
        const double share = static_cast<double>(mattes.share[rank](x, y));
        covered += share;
        if (at_rank != 0) {
          areas[at_rank].first += share;
          edges[at_rank] += share * (1 - share);
        }
      }
      if (mattes.share[0](x, y) == 1.0F || covered == 0) {
        ++whole;
        other += std::bit_cast<std::uint32_t>(mattes.id[0](x, y)) != id ? 1 : 0;
      }
    }
  }
  double worst = 0;
  for (const auto& [id, area] : areas) {
    // A pixel of share s is hit in its centre with about that probability.
    const double sigma = std::sqrt(edges[id] + 1);
    worst = std::max(worst, std::abs(area.first - area.second) / sigma);
  }
  std::cout << "of " << kAcross * kDown << " pixels, " << whole << " show one thing alone, and " << other
            << " of these another than the guides; " << areas.size() << " things, the area of the worst differs by "
            << worst << " standard deviations\n";
  EXPECT_GT(whole, kAcross * kDown / 3);
  EXPECT_LE(other, whole / 1000);  // what is finer than a sixty-fourth of a pixel can be in its centre
  EXPECT_GT(areas.size(), 20U);
  EXPECT_LT(worst, 5);
}

TEST(Coverage, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = wall_to(1.3F);
  const auto trace = [&](int count, std::uint64_t seed) {
    PathTracer tracer(scene, threads(count));
    return tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {{false, {kWall}}}, {.seed = seed})[0].share;
  };
  EXPECT_EQ(trace(1, 5), trace(2, 5));
  EXPECT_NE(trace(2, 5), trace(2, 6));
}

TEST(Coverage, RefusesWhatItCannotCount) {
  const Scene scene = wall_to(1);
  PathTracer tracer(scene, threads(1));
  const auto trace = [&](const SurfaceIds& ids, const CoverageSettings& settings) {
    (void)tracer.at_rest().coverage(flat_camera(), 1, kWidth, kHeight, {ids}, settings);
  };
  EXPECT_THROW(trace({false, {1}}, {.rays = 0}), Error);
  EXPECT_THROW(trace({false, {1}}, {.rays = 1025}), Error);
  EXPECT_THROW(trace({false, {1}}, {.ranks = 17}), Error);
  EXPECT_THROW(trace({false, {1, 2}}, {}), Error);
}

}  // namespace
}  // namespace gazetrace::coverage_test
