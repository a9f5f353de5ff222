// SPDX-License-Identifier: Apache-2.0
// What a scene may hold: alpha, mirrored, singular and shared instances, any scale, any distance from the origin.
#include <gtest/gtest.h>

#include <limits>

#include "render/tracer_scenes.hpp"

namespace gazetrace::tracer_scene_test {
namespace {

using namespace test;

constexpr Vec3f kGlow{1, 1, 1};

// A quad of half size 1 at z = 0 that fills the middle of the picture, before a black background.
Geometry facing_quad(std::int32_t material, float half = 1) {
  return quad({{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}}, material);
}

Material glowing() {
  return diffuse_material({0, 0, 0}, kGlow);
}

TraceSettings no_bounces() {
  TraceSettings settings;
  settings.max_bounces = 0;
  return settings;
}

double center_mean(const Scene& scene, const TraceSettings& settings = no_bounces(), std::uint32_t spp = 64) {
  PathTracer tracer(scene, threads(1));
  const SparseFrame frame =
      tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(8, 8, spp), settings);
  EXPECT_EQ(frame.stats.non_finite_samples, 0U);
  EXPECT_EQ(frame.stats.rejected_rays, 0U);
  return mean_radiance(frame).y;
}

TEST(TracerScene, AlphaModes) {
  for (const float alpha : {0.0F, 0.25F, 0.75F, 1.0F}) {
    Scene scene;
    scene.materials = {glowing()};
    scene.materials[0].base_color.w = alpha;
    add_mesh(scene, {facing_quad(0)});
    scene.materials[0].alpha_mode = AlphaMode::opaque;
    EXPECT_EQ(center_mean(scene), 1.0);
    scene.materials[0].alpha_mode = AlphaMode::mask;
    EXPECT_EQ(center_mean(scene), alpha >= 0.5F ? 1.0 : 0.0);
    scene.materials[0].alpha_mode = AlphaMode::blend;
    // 4096 independent decisions: five standard deviations.
    EXPECT_NEAR(center_mean(scene), alpha, 5 * std::sqrt(alpha * (1 - alpha) / 4096.0));
  }
}

TEST(TracerScene, BlendedLayersDecideIndependently) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}), glowing()};
  scene.materials[0].base_color.w = 0.5F;
  scene.materials[0].alpha_mode = AlphaMode::blend;
  add_mesh(scene, {facing_quad(1)});
  for (const double z : {0.5, 1.0, 1.5}) {
    add_mesh(scene, {facing_quad(0)}, make_affine({0, 0, z}, {}, {1, 1, 1}));
  }
  EXPECT_NEAR(center_mean(scene), 0.125, 5 * std::sqrt(0.125 * 0.875 / 4096.0));
}

TEST(TracerScene, ShadowRaysSeeAlphaToo) {
  Scene scene;
  scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F}), diffuse_material({0, 0, 0})};
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].double_sided = true;
  add_mesh(scene, {facing_quad(0)});
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = normalize(Vec3f{1, 0, -1});
  scene.lights = {sun};
  // A screen between the quad and the sun, outside the camera's view.
  add_mesh(scene, {quad({{{-6, -3, 3}, {-1.5F, -3, 3}, {-1.5F, 3, 3}, {-6, 3, 3}}}, 1)});
  TraceSettings settings;
  settings.max_bounces = 1;
  scene.materials[1].base_color.w = 0;
  const double open = center_mean(scene, settings, 256);
  ASSERT_GT(open, 0.01);
  scene.materials[1].base_color.w = 1;
  EXPECT_EQ(center_mean(scene, settings, 256), 0);
  scene.materials[1].base_color.w = 0.3F;
  EXPECT_NEAR(center_mean(scene, settings, 256) / open, 0.7, 5 * std::sqrt(0.21 / (64 * 256)));
}

TEST(TracerScene, EmissionLeavesTheFrontOnly) {
  for (const bool back : {false, true}) {
    for (const bool double_sided : {false, true}) {
      Scene scene;
      scene.materials = {glowing()};
      scene.materials[0].double_sided = double_sided;
      add_mesh(scene, {facing_quad(0)}, make_affine({}, back ? Quatd{0, 1, 0, 0} : Quatd{}, {1, 1, 1}));
      EXPECT_EQ(center_mean(scene), back && !double_sided ? 0.0 : 1.0);
    }
  }
}

// glTF: a mirroring matrix reverses the winding, so fronts stay fronts, baked or instanced.
TEST(TracerScene, MirroredInstancesKeepTheirFront) {
  Scene scene;
  scene.materials = {glowing()};
  add_mesh(scene, {facing_quad(0)}, make_affine({}, {}, {-1, 1, 1}));
  EXPECT_EQ(center_mean(scene), 1.0);
  scene.instances.push_back({0, make_affine({0, 0, -100}, {}, {-1, -1, -1})});  // now shared: an instance
  EXPECT_EQ(center_mean(scene), 1.0);
}

TEST(TracerScene, SingularInstancesAreHarmless) {
  Scene scene;
  scene.materials = {glowing(), diffuse_material({1, 1, 1})};
  add_mesh(scene, {facing_quad(0)});
  add_mesh(scene, box(0.2F, false, 1));
  scene.instances[1].to_world = make_affine({0, 0, 1}, {}, {0, 0, 0});
  for (const Vec3d scale : {Vec3d{1, 1, 0}, Vec3d{1e-18, 1, 1}, Vec3d{1e-30, 1e-30, 1e-30}, Vec3d{0, 1, 1}}) {
    scene.instances.push_back({1, make_affine({50, 0, -2}, {}, scale)});
  }
  EXPECT_EQ(center_mean(scene), 1.0);
}

// The same picture at any scale: radiance has no metres in it.
TEST(TracerScene, ScaleDoesNotChangeRadiance) {
  double reference = 0;
  for (const double scale : {1.0, 1e-6, 1e-3, 1e3, 1e6}) {
    for (const bool shared : {false, true}) {
      Scene scene;
      scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F})};
      const Affine to_world = make_affine({}, {}, {scale, scale, scale});
      add_mesh(scene, {quad({{{-3, -1, 3}, {3, -1, 3}, {3, -1, -3}, {-3, -1, -3}}}, 0)}, to_world);
      add_mesh(scene, box(0.7F, false, 0), to_world);
      if (shared) {
        for (Instance instance : {scene.instances[0], scene.instances[1]}) {
          instance.to_world.t = Vec3d{0, -1000, 0} * scale;
          scene.instances.push_back(instance);
        }
      }
      scene.environment = constant_environment({1, 1, 1});
      PathTracer tracer(scene, threads(2));
      const Vec3d eye = Vec3d{2, 1.5, 4} * scale;
      const SparseFrame frame = tracer.at_rest().trace(camera_at(eye, {0, 0, 0}), 1, uniform_map(32, 24, 64), {});
      EXPECT_EQ(frame.stats.non_finite_samples, 0U);
      EXPECT_EQ(frame.stats.rejected_rays, 0U);
      const double mean = mean_radiance(frame).y;
      reference = reference == 0 ? mean : reference;
      EXPECT_NEAR(mean, reference, 2e-3 * reference) << scale << shared;
    }
  }
}

TEST(TracerScene, FarFromTheOriginNothingBreaks) {
  for (const double far : {1e3, 1e5, 1e7}) {
    Scene scene;
    scene.materials = {diffuse_material({0.5F, 0.5F, 0.5F})};
    add_mesh(scene, box(1.0F, false, 0), make_affine({far, far, -far}, {}, {1, 1, 1}));
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(1));
    const SparseFrame frame = tracer.at_rest().trace(camera_at({far + 3, far + 2, -far + 5}, {far, far, -far}), 1,
                                                     uniform_map(16, 16, 16), {});
    EXPECT_EQ(frame.stats.non_finite_samples, 0U);
    EXPECT_EQ(frame.stats.rejected_rays, 0U);
    EXPECT_TRUE(is_finite(to_float(mean_radiance(frame))));
  }
}

// A convex body in a white furnace: rays that start on it must not meet it again.
TEST(TracerScene, AFlatSurfaceDoesNotShadowItself) {
  for (const double far : {0.0, 10.0, 1e4}) {
    Scene scene;
    scene.materials = {diffuse_material({1, 1, 1})};
    add_mesh(scene, {facing_quad(0, 1000)}, make_affine({far, 0, far}, normalize(Quatd{0.1, 0.2, 0.05, 1}), {1, 1, 1}));
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(1));
    TraceSettings settings;
    settings.max_bounces = 1;
    settings.light_sampling = LightSampling::bsdf_only;
    const SparseFrame frame =
        tracer.at_rest().trace(camera_at({far, 0, far + 20}, {far, 0, far}), 1, uniform_map(32, 32, 64), settings);
    EXPECT_NEAR(mean_radiance(frame).y, 1.0, 3e-3) << far;
  }
}

// A camera and surfaces where no float has room: refused rays are counted and named, the process lives.
TEST(TracerScene, RefusedRaysAreCountedAndNamed) {
  Scene scene;
  scene.materials = {glowing()};
  add_mesh(scene, {facing_quad(0)});
  PathTracer tracer(scene, threads(1));
  Camera camera;
  camera.pose.position_m = {std::numeric_limits<double>::infinity(), 0, 5};
  const SparseFrame frame = tracer.at_rest().trace(camera, 7, uniform_map(4, 4, 2), {});
  EXPECT_EQ(frame.stats.rejected_rays, 32U);
  ASSERT_EQ(frame.stats.bad_samples.size(), 16U);
  EXPECT_EQ(frame.stats.bad_samples[0].frame, 7);
  EXPECT_EQ(frame.stats.bad_samples[0].x_px, 0);
  EXPECT_EQ(frame.stats.bad_samples[0].y_px, 0);
  EXPECT_EQ(frame.stats.bad_samples[0].what, "rejected ray");
  EXPECT_EQ(frame.stats.bad_samples[3].x_px, 1);
  camera.pose.position_m = {2e18, 0, 5};
  EXPECT_EQ(tracer.at_rest().trace(camera, 7, uniform_map(4, 4, 2), {}).stats.rejected_rays, 32U);
}

TEST(TracerScene, NonFiniteRadianceIsCountedAndBlack) {
  Scene scene;
  scene.materials = {glowing()};
  scene.materials[0].emission = {3e38F, 3e38F, 3e38F};
  scene.materials[0].emission.y = std::numeric_limits<float>::infinity();
  scene.materials[0].unlit = false;
  add_mesh(scene, {facing_quad(0)});
  PathTracer tracer(scene, threads(1));
  const SparseFrame frame =
      tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(4, 4, 2), no_bounces());
  EXPECT_EQ(frame.stats.non_finite_samples, 32U);
  EXPECT_EQ(frame.stats.bad_samples.size(), 16U);
  EXPECT_EQ(frame.sum[0], (Vec3f{0, 0, 0}));
  EXPECT_EQ(frame.count[0], 2U);
}

TEST(TracerScene, UnlitMaterialsShowTheirColor) {
  Scene scene;
  scene.materials = {diffuse_material({0.25F, 0.5F, 0.75F})};
  scene.materials[0].unlit = true;
  add_mesh(scene, {facing_quad(0)});
  scene.environment = constant_environment({9, 9, 9});
  EXPECT_EQ(center_mean(scene, {}), 0.5);
}

TEST(TracerScene, OrthographicCameraAndClippingPlanes) {
  Scene scene;
  scene.materials = {glowing()};
  add_mesh(scene, {facing_quad(0)});
  PathTracer tracer(scene, threads(1));
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 2;  // the quad fills the inner half of each side
  EXPECT_NEAR(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(16, 16, 4), no_bounces())).y, 0.25, 1e-6);
  for (const ProjectionKind kind : {ProjectionKind::orthographic, ProjectionKind::perspective}) {
    camera.projection.kind = kind;
    camera.projection.ymag_m = 0.5;
    camera.projection.yfov_rad = 0.1;
    camera.projection.near_m = 5.1;
    EXPECT_EQ(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 4), no_bounces())).y, 0.0);
    camera.projection.near_m = 4.9;
    camera.projection.far_m = 4.95;
    EXPECT_EQ(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 4), no_bounces())).y, 0.0);
    camera.projection.far_m = 5.05;
    EXPECT_EQ(mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(8, 8, 4), no_bounces())).y, 1.0);
    camera.projection.near_m = 0;
    camera.projection.far_m = 0;
  }
}

TEST(TracerScene, GuidesHoldTheFirstHit) {
  Scene scene;
  scene.materials = {diffuse_material({0.2F, 0.4F, 0.6F})};
  add_mesh(scene, {facing_quad(0)});
  PathTracer tracer(scene, threads(1));
  TraceSettings settings;
  settings.guides = true;
  const SparseFrame frame =
      tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(4, 4, 8), settings);
  ASSERT_EQ(frame.guides.size(), frame.sum.size());
  for (const GuideSums& g : frame.guides) {
    EXPECT_EQ(g.hits, 8U);
    EXPECT_NEAR(g.albedo.y, 8 * 0.4, 1e-5);
    EXPECT_NEAR(g.normal.z, 8, 1e-3);
    EXPECT_NEAR(g.depth_m, 8 * 5, 1e-4);
  }
}

TEST(TracerScene, AnEmptySceneRenders) {
  Scene scene;
  scene.materials.emplace_back();
  EXPECT_EQ(center_mean(scene, {}), 0.0);
}

}  // namespace
}  // namespace gazetrace::tracer_scene_test
