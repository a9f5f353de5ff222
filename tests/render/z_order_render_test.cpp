// SPDX-License-Identifier: Apache-2.0
// Pictures traced with samples along a Z-curve: the same for any number of threads and in parts, unbiased, and with
// less error in the means over squares of pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace {
namespace {

using namespace test;

// A floor in the corner of two walls under the sky, with a box on it.
Scene room() {
  Scene scene;
  scene.materials = {diffuse_material({0.8F, 0.7F, 0.6F}), diffuse_material({0.2F, 0.5F, 0.8F})};
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-4, -1, -4}, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}}}, 0),
                   quad({{{-4, -1, -4}, {4, -1, -4}, {4, 4, -4}, {-4, 4, -4}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1));
  return scene;
}

const Camera kCamera = camera_at({1, 1, 4}, {0, 0, 0});

TraceSettings z_order(std::uint64_t seed = 0) {
  TraceSettings settings;
  settings.sample_pattern = SamplePattern::z_order;
  settings.seed = seed;
  return settings;
}

// Blocks, counts that are no powers of two, and fractions of samples.
SamplingMap foveated(bool budget) {
  FoveationSettings settings;
  settings.region_samples = {11, 5, 3};
  settings.region_angles_deg = {12, 30};
  if (budget) {
    settings.budget_spp = 0.7;
  }
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, 150, 100), Vec3d{0.1, 0.05, -1});
}

TEST(ZOrderRender, ThreadsDoNotMatterAndTheOtherPatternDiffers) {
  const Scene scene = room();
  for (const bool budget : {false, true}) {
    const SamplingMap map = foveated(budget);
    PathTracer one(scene, threads(1));
    PathTracer four(scene, threads(4));
    const SparseFrame a = one.at_rest().trace(kCamera, 1, map, z_order());
    EXPECT_TRUE(same_samples(a, four.at_rest().trace(kCamera, 1, map, z_order()), map));
    EXPECT_FALSE(same_samples(a, one.at_rest().trace(kCamera, 1, map, {}), map));
    EXPECT_FALSE(same_samples(a, one.at_rest().trace(kCamera, 2, map, z_order()), map)) << "the next frame";
    EXPECT_FALSE(same_samples(a, one.at_rest().trace(kCamera, 1, map, z_order(1)), map)) << "another seed";
  }
}

TEST(ZOrderRender, OnlyPixelReplaysItsSite) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(1));
  const SamplingMap map = foveated(false);
  TraceSettings settings = z_order();
  const SparseFrame whole = tracer.at_rest().trace(kCamera, 1, map, settings);
  std::vector<PixelIndex> pixels;
  for (const std::size_t i : {std::size_t{0}, map.sites.size() / 3, map.sites.size() / 2, map.sites.size() - 1}) {
    pixels_of_site(map, map.sites[i], pixels);
    settings.only_pixel = pixels.back();
    const SparseFrame one = tracer.at_rest().trace(kCamera, 1, map, settings);
    EXPECT_EQ(one.sum[i], whole.sum[i]);
    EXPECT_EQ(one.count[i], whole.count[i]);
  }
}

// Mean luminance over the samples, or over the sites divided by what they expect.
double mean_of(const SparseFrame& frame, const SamplingMap& map, std::uint8_t region) {
  double sum = 0;
  double expected = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    if (map.sites[i].region == region) {
      sum += static_cast<double>(frame.sum[i].y);
      expected += map.expected(i);
    }
  }
  return sum / expected;
}

TEST(ZOrderRender, MeansOfEveryRegionAreThoseOfIndependentPixels) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  for (const bool budget : {false, true}) {
    for (std::uint8_t region = 0; region < 3; ++region) {
      std::vector<double> differences;
      for (std::uint64_t seed = 0; seed < 48; ++seed) {
        FoveationSettings settings;
        const SamplingMap map = foveated(budget);
        TraceSettings scrambled;
        scrambled.seed = seed + 1000;
        differences.push_back(mean_of(tracer.at_rest().trace(kCamera, 1, map, z_order(seed)), map, region) -
                              mean_of(tracer.at_rest().trace(kCamera, 1, map, scrambled), map, region));
      }
      EXPECT_GT(t_test(differences, 0).p_value, sidak(6)) << budget << " region " << static_cast<int>(region);
    }
  }
}

// Mean square difference of two frames' means over squares of pixels, at one sample a pixel.
double energy(const SparseFrame& a, const SparseFrame& b, const SamplingMap& map, int side) {
  Image<double> difference(map.width_px, map.height_px);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    difference(map.sites[i].block_x, map.sites[i].block_y) =
        static_cast<double>(a.sum[i].y) / a.count[i] - static_cast<double>(b.sum[i].y) / b.count[i];
  }
  double squares = 0;
  int count = 0;
  for (int y0 = 0; y0 + side <= map.height_px; y0 += side) {
    for (int x0 = 0; x0 + side <= map.width_px; x0 += side) {
      double sum = 0;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          sum += difference(x0 + x, y0 + y);
        }
      }
      squares += std::pow(sum / (side * side), 2);
      ++count;
    }
  }
  return squares / count;
}

TEST(ZOrderRender, LessErrorIsLeftInTheMeansOfSquares) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(128, 96, 1);
  const SparseFrame truth = tracer.at_rest().trace(kCamera, 77, uniform_map(128, 96, 1024), {});
  for (const int side : {4, 8}) {
    std::vector<double> differences;
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
      TraceSettings scrambled;
      scrambled.seed = seed;
      differences.push_back(energy(tracer.at_rest().trace(kCamera, 1, map, z_order(seed)), truth, map, side) -
                            0.8 * energy(tracer.at_rest().trace(kCamera, 1, map, scrambled), truth, map, side));
    }
    const MeanTest result = t_test(differences, 0);
    EXPECT_LT(result.mean, 0) << side;
    EXPECT_LT(result.p_value, sidak(2)) << side;
  }
}

}  // namespace
}  // namespace gazetrace
