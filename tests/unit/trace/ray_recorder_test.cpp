// SPDX-License-Identifier: Apache-2.0
// How many of the rays that were kept hit something when they are traced again.
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>

#include "trace/rays/embree.hpp"

namespace gazetrace::ray_recorder_test {
namespace {

// Rays along -z at x = 0, 1, 2 ..., of which those to the left of x = 10.5 meet a triangle: eleven.
constexpr int kRays = 21, kHits = 11;

std::unique_ptr<RayBatch> rays_in_a_row() {
  auto rays = std::make_unique<RayBatch>();
  for (std::size_t i = 0; i < kRays; ++i) {
    rays->ox[i] = static_cast<float>(i);
    rays->oy[i] = 0;
    rays->oz[i] = 5;
    rays->dx[i] = rays->dy[i] = 0;
    rays->dz[i] = -1;
    rays->tnear[i] = 0;
    rays->tfar[i] = 100;
    rays->alpha_key[i] = 0;
    rays->time[i] = 0;
  }
  return rays;
}

TEST(RayRecorder, EveryRayThatHitsCounts) {
  RayScene scene(1, nullptr);
  RayGeometry triangle;
  triangle.positions = {{-5, -50, 0}, {10.5F, -50, 0}, {10.5F, 500, 0}};
  triangle.triangles = {{0, 1, 2}};
  scene.add_geometry(triangle);
  scene.commit();
  const auto rays = rays_in_a_row();
  for (const RayShape shape : {RayShape::single, RayShape::packet, RayShape::coherent_packet}) {
    for (const bool occlusion : {false, true}) {
      RayRecorder recorder;
      recorder.record(*rays, kRays, shape, occlusion);
      EXPECT_EQ(recorder.size(), kRays);
      EXPECT_EQ(recorder.replay(scene), kHits) << static_cast<int>(shape) << ' ' << occlusion;
    }
  }
}

}  // namespace
}  // namespace gazetrace::ray_recorder_test
