// SPDX-License-Identifier: Apache-2.0
// How close an object may be to an emitter, or how small on large ground, and still cast a shadow; and emitters that
// light samples cannot aim at.
#include <gtest/gtest.h>

#include <cmath>

#include "render/tracer_scenes.hpp"

namespace gazetrace::shadow_precision_test {
namespace {

using namespace test;

TraceSettings one_bounce(LightSampling sampling) {
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  settings.max_bounces = 1;
  settings.light_sampling = sampling;
  return settings;
}

// A square that faces down, with its middle at (0, y, 0).
Geometry facing_down(float half, float y, std::int32_t material) {
  return quad({{{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}}}, material);
}

// A panel that covers an emitter entirely, closer to it than a thousandth or a ten-thousandth of the distance to the
// floor.
TEST(ShadowPrecision, AThinCoverHidesALampFromAFarFloor) {
  for (const double distance : {20.0, 200.0}) {
    for (const bool turned : {false, true}) {
      Scene scene;
      scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F}), diffuse_material({0, 0, 0}, {1e4F, 1e4F, 1e4F})};
      scene.materials[0].double_sided = true;
      const auto lamp = static_cast<float>(distance);
      const float gap = 0.75e-4F * lamp;
      const Affine place = make_affine({}, turned ? normalize(Quatd{0.2, 0, 0.1, 1}) : Quatd{}, {1, 1, 1});
      add_mesh(scene, {facing_down(1, lamp, 1)}, place);
      add_mesh(scene, {facing_down(1.5F, lamp - gap, 0)}, place);
      add_mesh(scene, {quad({{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}}, 0)}, place);
      PathTracer tracer(scene, threads(1));
      const Camera camera = camera_at(transform_point(place, {0.5, 2, 0}), transform_point(place, {0, 0, 0}), 10);
      for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
        const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(16, 16, 64), one_bounce(sampling));
        EXPECT_EQ(mean_radiance(frame).y, 0) << distance << ' ' << turned;
      }
      // Without the cover the emitter is visible.
      scene.instances.erase(scene.instances.begin() + 1);
      PathTracer open(scene, threads(1));
      EXPECT_GT(
          mean_radiance(open.at_rest().trace(camera, 1, uniform_map(16, 16, 64), one_bounce(LightSampling::light_only)))
              .y,
          0.1);
    }
  }
}

// A sun at 45 degrees over level ground: where a cube stands, its shadow is as long as the cube is high, whatever the
// ground's size.
TEST(ShadowPrecision, SmallThingsShadowLargeGround) {
  for (const float half : {10.0F, 1e3F, 1e5F}) {
    for (const float side : {0.1F, 0.0015F}) {
      if (side < 1e-6F * half) {
        continue;  // floats tell no places on a triangle apart that are closer than 2^-23 of it
      }
      Scene scene;
      scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F})};
      add_mesh(scene, {quad({{{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}}}, 0)});
      add_mesh(scene, box(0.5F * side, false, 0), make_affine({0, 0.5 * double{side}, 0}, {}, {1, 1, 1}));
      PunctualLight sun;
      sun.kind = LightKind::directional;
      sun.direction = Vec3f{1, -1, 0} * static_cast<float>(std::sqrt(0.5));
      sun.intensity = {1, 1, 1};
      scene.lights = {sun};
      PathTracer tracer(scene, threads(1));
      // Looks at the middle of the shadow from above, a twentieth of it wide.
      const Vec3d middle{double{side}, 0, 0};
      const Camera camera = camera_at(middle + Vec3d{0, 3, 0.3} * double{side}, middle, 1);
      const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 4), one_bounce(LightSampling::mis));
      EXPECT_EQ(mean_radiance(frame).y, 0) << "ground " << half << ", cube " << side;
      const Camera beside = camera_at(Vec3d{0, 3, 3.3} * double{side}, Vec3d{0, 0, 3} * double{side}, 1);
      const SparseFrame lit = tracer.at_rest().trace(beside, 1, uniform_map(8, 8, 4), one_bounce(LightSampling::mis));
      EXPECT_NEAR(mean_radiance(lit).y, 0.5 / kPi * std::sqrt(0.5), 1e-5) << "ground " << half << ", cube " << side;
    }
  }
}

// Lamps that move have no place that could be aimed at; rays find them, whatever samples lights.
TEST(ShadowPrecision, LampsThatMoveShineUnderEveryWayOfSampling) {
  Scene scene;
  scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F}), diffuse_material({0, 0, 0}, {1, 1, 1})};
  add_mesh(scene, {facing_down(4, 2, 1)});
  add_mesh(scene, {quad({{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}}, 0)});
  scene.motions.push_back({[](std::int64_t) { return Affine{}; }, 1'000'000'000});
  scene.instances[0].motion = 0;
  PathTracer tracer(scene, threads(1));
  const Camera camera = camera_at({0.5, 1, 0}, {0, 0, 0}, 10);
  const auto seen = [&](LightSampling sampling) {
    return mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(16, 16, 64), one_bounce(sampling))).y;
  };
  const double by_rays = seen(LightSampling::bsdf_only);
  EXPECT_GT(by_rays, 0.1);
  EXPECT_NEAR(seen(LightSampling::mis) / by_rays, 1, 1e-6);
  EXPECT_NEAR(seen(LightSampling::light_only) / by_rays, 1, 1e-6);
}

}  // namespace
}  // namespace gazetrace::shadow_precision_test
