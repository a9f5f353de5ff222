// SPDX-License-Identifier: Apache-2.0
// Scenes of any size at any place: no light leaks out of or into a closed box, and no surface shadows itself.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::extreme_scale_test {
namespace {

using namespace test;

constexpr int kSize = 32;
constexpr std::uint32_t kSpp = 64;  // so that one leaking path is less than the smallest share that is allowed

struct Place {
  double scale, offset;  // half the box's side; distance of its centre from the origin along each axis
};
// The last one is 1e7 units away, where floats are whole numbers.
const std::vector<Place> kPlaces{{1e-6, 0}, {1e-3, 0}, {1, 0}, {1e3, 0}, {1e6, 0}, {1, 1e3}, {1e4, 1e7}};
const Quatd kTurned = normalize(Quatd{0.21, 0.34, -0.13, 1});

// Points on a wall are rounded by up to 2^-22 of their largest coordinate. A point that is so close to an edge of the
// wall (2 edges across, per half side) may end up behind the next wall, at each of 12 bounces.
double largest_leak(const Place& place) {
  return 12 * 2 * 0x1p-22 * (place.offset + 2 * place.scale) / place.scale;
}

enum class Kind { baked, instanced };

std::string describe(const Place& place, bool turned, Kind kind) {
  char text[128];
  std::snprintf(text, sizeof(text), "half side %g m, %g m from the origin, %s, %s", place.scale, place.offset,
                turned ? "turned" : "upright", kind == Kind::baked ? "baked" : "instanced");
  return text;
}

Scene box_scene(const Place& place, bool turned, Kind kind, bool inward) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  scene.materials[0].double_sided = true;
  const double s = place.scale;
  add_mesh(scene, box(1, inward, 0),
           make_affine(Vec3d{1, 1, -1} * place.offset, turned ? kTurned : Quatd{}, {s, s, s}));
  if (kind == Kind::instanced) {
    // Far away, but within the same few orders of magnitude.
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].to_world.t += Vec3d{0, 500, 0} * s;
  }
  return scene;
}

Camera inside(const Place& place, int face) {
  const Vec3d center = Vec3d{1, 1, -1} * place.offset;
  const double s = place.scale;
  const Vec3d eye = center + Vec3d{0.3, -0.2, 0.1} * s;
  const Vec3d way{face % 3 == 0 ? 1.0 : 0.3, face % 3 == 1 ? 1.0 : -0.2, face % 3 == 2 ? 1.0 : 0.1};
  return camera_at(eye, eye + way * (face < 3 ? s : -s), 100);
}

template <class Test>
void for_all_boxes(const Test& test) {
  for (const Place& place : kPlaces) {
    for (const bool turned : {false, true}) {
      for (const Kind kind : {Kind::baked, Kind::instanced}) {
        SCOPED_TRACE(describe(place, turned, kind));
        test(place, turned, kind);
      }
    }
  }
}

// White walls inside, bright light outside, and the camera inside. A path that gets out adds the sky's radiance times
// its weight, which is 1 for white walls with rays only, so the mean is the share of leaking paths. A shadow ray that
// gets out weighs up to 4 (the cosine over pi, by the density 1 / (4 pi)), and one of 49,152 would be more than a box
// at the origin may leak: those boxes, which have the same bound, are judged together, 983,040 paths.
TEST(ExtremeScale, NoLightLeaksIntoAClosedBox) {
  constexpr double kPaths = 6 * kSize * kSize * kSpp / 8.0;
  ASSERT_LE(4 / (20 * kPaths), largest_leak({1, 0}));
  double by_light_at_origin = 0;
  int boxes_at_origin = 0;
  for_all_boxes([&](const Place& place, bool turned, Kind kind) {
    Scene scene = box_scene(place, turned, kind, true);
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(2));
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    settings.max_bounces = 12;
    settings.russian_roulette = false;
    double leaked = 0, by_light_samples = 0, rays = 0;
    for (int face = 0; face < 6; ++face) {
      settings.seed = static_cast<std::uint64_t>(face);
      settings.light_sampling = LightSampling::bsdf_only;
      const SparseFrame found =
          tracer.at_rest().trace(inside(place, face), 1, uniform_map(kSize, kSize, kSpp / 2), settings);
      EXPECT_EQ(found.stats.non_finite_samples + found.stats.rejected_rays, 0U);
      leaked += mean_radiance(found).y / 6;
      rays += static_cast<double>(found.stats.rays_bounce + found.stats.rays_primary);
      settings.light_sampling = LightSampling::light_only;
      by_light_samples +=
          mean_radiance(tracer.at_rest().trace(inside(place, face), 1, uniform_map(kSize, kSize, kSpp / 8), settings))
              .y /
          6;
    }
    std::printf("%s: %.3g of the paths leak (%.3g rays), %.3g of the light\n", describe(place, turned, kind).c_str(),
                leaked, rays, by_light_samples);
    EXPECT_LE(leaked, largest_leak(place));
    if (place.offset > 0) {
      EXPECT_LE(by_light_samples, largest_leak(place));
    } else {
      EXPECT_LE(by_light_samples, 4 / kPaths);  // one shadow ray at most
      by_light_at_origin += by_light_samples;
      ++boxes_at_origin;
    }
  });
  EXPECT_EQ(boxes_at_origin, 20);
  EXPECT_LE(by_light_at_origin / boxes_at_origin, largest_leak({1, 0}));
}

// The other way round: a lamp in the box, black outside, the camera outside.
TEST(ExtremeScale, NoLightLeaksOutOfAClosedBox) {
  for_all_boxes([](const Place& place, bool turned, Kind kind) {
    Scene scene = box_scene(place, turned, kind, false);
    scene.materials.push_back(diffuse_material({1, 1, 1}, {1, 1, 1}));
    scene.materials[1].double_sided = true;
    // Shadow rays stop short of their light by a few times 2^-18 of the largest coordinate, so that it does not shadow
    // itself: a wall closer to it than that, two thousandths of the box a thousand half sides away, would not be seen.
    const double lamp = place.offset > 0 ? 0.9 : 0.999;
    add_mesh(scene, box(1, false, 1), scene.instances[0].to_world * make_affine({}, {}, {lamp, lamp, lamp}));
    // From a floor below, light samples aim at the emitter through the walls.
    add_mesh(scene, {quad({{{-6, -2, 6}, {6, -2, 6}, {6, -2, -6}, {-6, -2, -6}}}, 0)},
             make_affine(Vec3d{1, 1, -1} * place.offset, {}, Vec3d{1, 1, 1} * place.scale));
    PathTracer tracer(scene, threads(2));
    const Vec3d center = Vec3d{1, 1, -1} * place.offset;
    const Camera camera = camera_at(center + Vec3d{2, 3, 4} * place.scale, center, 45);
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(kSize, kSize, kSpp), settings);
    EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
    EXPECT_GT(frame.stats.rays_shadow, 0U);
    EXPECT_LE(mean_radiance(frame).y, largest_leak(place));
  });
}

// A white convex body in a white room looks white; anything missing would be self-shadowing.
TEST(ExtremeScale, NoSurfaceShadowsItself) {
  for_all_boxes([](const Place& place, bool turned, Kind kind) {
    Scene scene = box_scene(place, turned, kind, false);
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(2));
    const Vec3d center = Vec3d{1, 1, -1} * place.offset;
    const Camera camera = camera_at(center + Vec3d{2, 3, 4} * place.scale, center, 30);
    TraceSettings settings;
    settings.diffuse = DiffuseModel::matte;
    settings.max_bounces = 1;
    settings.light_sampling = LightSampling::bsdf_only;
    const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(kSize, kSize, kSpp), settings);
    EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
    const double lost = 1 - mean_radiance(frame).y;
    std::printf("%s: %.3g of the paths meet their own surface\n", describe(place, turned, kind).c_str(), lost);
    EXPECT_NEAR(lost, 0, 1e-7);
  });
}

// A floor, a box that moves over it and a lamp, all of it shifted; coordinates are sums of few powers of 2, so that no
// shift rounds them in double.
Scene shifted_scene(const Vec3d& shift) {
  Scene scene;
  scene.materials = {diffuse_material({0.75F, 0.5F, 0.25F})};
  add_mesh(scene, {quad({{{-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}}}, 0)}, make_affine(shift, {}, {1, 1, 1}));
  add_mesh(scene, box(0.5F, false, 0), make_affine(shift, {}, {1, 1, 1}));
  scene.instances[1].motion = 0;
  scene.motions.push_back({[shift](std::int64_t t_ns) {
                             return make_affine(shift + Vec3d{static_cast<double>(t_ns) / 4, 0, 0}, {}, {1, 1, 1});
                           },
                           4});
  PunctualLight lamp;
  lamp.position_m = shift + Vec3d{1, 3, 2};
  lamp.intensity = {40, 40, 40};
  scene.lights.push_back(lamp);
  return scene;
}

// From the point of view of a camera nothing happens where it is shifted with everything else. By whole cells of the
// tracer, every number of the picture is the same; by others, rounding may throw single paths elsewhere.
TEST(ExtremeScale, AShiftOfEverythingKeepsThePicture) {
  struct Seen {
    SparseFrame frame;
    std::vector<RayHit> hits;
    SurfaceMotion motion;
  };
  const auto see = [](const Vec3d& shift) {
    const Scene scene = shifted_scene(shift);
    PathTracer tracer(scene, threads(2));
    const Camera camera = camera_at(shift + Vec3d{2, 1.5, 4}, shift, 45);
    const PosedScene posed = tracer.at({0, 2});
    return Seen{posed.trace(camera, 1, uniform_map(kSize, kSize, 16), {}),
                posed.first_hits(camera, kSize, kSize, {{16.5, 16.5}, {3.5, 30.5}}),
                posed.surface_motion(camera, kSize, kSize, {camera, 4})};
  };
  const Seen here = see({});
  ASSERT_GT(mean_radiance(here.frame).y, 0.01);
  for (const Vec3d& shift : {Vec3d{1024.0 * 97, 0, 0}, Vec3d{1024.0 * 9766, -1024.0 * 4883, 1024.0 * 6836}}) {
    const Seen there = see(shift);
    EXPECT_EQ(there.frame.sum, here.frame.sum);
    for (std::size_t i = 0; i < here.hits.size(); ++i) {
      EXPECT_LT(length(there.hits[i].position_m - shift - here.hits[i].position_m), 1e-6);
    }
    for (std::size_t i = 0; i < here.motion.other_px.pixels.size(); ++i) {
      const Vec2d& a = here.motion.other_px.pixels[i];
      const Vec2d& b = there.motion.other_px.pixels[i];
      EXPECT_LT(std::hypot(a.x - b.x, a.y - b.y), 1e-3) << i;
    }
  }
  for (const Vec3d& shift : {Vec3d{777, 0, 0}, Vec3d{-6.4e6, 300, 1e7 + 1.0 / 3}}) {
    const Seen there = see(shift);
    EXPECT_NEAR(mean_radiance(there.frame).y / mean_radiance(here.frame).y, 1, 1e-3);
  }
}

TEST(ExtremeScale, GeneratedSceneOfAllScales) {
  const std::string path =
      std::string(GAZETRACE_SHARED_DIR) + "/scenes/small/gen-extreme-scales/gen-extreme-scales.gltf";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << path << " is not here";
  }
  Scene scene = load_scene(path);
  ASSERT_EQ(scene.warnings.size(), 1U);  // the one that is flat
  EXPECT_NE(scene.warnings[0].find("flat_zero_z"), std::string::npos) << scene.warnings[0];
  scene.environment = constant_environment({1, 1, 1});
  PathTracer tracer(scene, threads(2));
  Camera camera;
  camera.pose = scene.cameras.at(0).path.pose_at(0);
  camera.projection = scene.cameras.at(0).path.projection;
  TraceSettings settings;
  settings.guides = true;
  const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(128, 72, 16), settings);
  EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
  for (std::size_t i = 0; i < frame.sum.size(); ++i) {
    ASSERT_TRUE(is_finite(frame.sum[i]));
    ASSERT_GT(frame.sum[i].y, 0) << "black under a white sky";
  }
  // The tenth of a millimetre: a camera of its own sees it fill the picture's middle.
  const SparseFrame close =
      tracer.at_rest().trace(camera_at({0, 1.00005, 5e-4}, {0, 1.00005, 0}, 20), 1, uniform_map(16, 16, 16), settings);
  const SamplingMap map = uniform_map(16, 16, 16);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    if (map.sites[i].block_x == 8 && map.sites[i].block_y == 8) {
      EXPECT_NEAR(close.guides[i].albedo.z / 16, 0.8, 1e-3);
    }
  }
}

TEST(ExtremeScale, DeepHierarchiesMultiplyUp) {
  for (const int depth : {64, 5000}) {
    GltfBuilder builder;
    builder.add_triangle();
    int child = 0;
    const double scale = std::pow(2.0, -20.0 / depth);  // 2^-20 in all
    for (int i = 0; i < depth; ++i) {
      child = builder.add_node({{"children", {child}}, {"scale", {scale, scale, scale}}, {"rotation", {0, 0, 1, 0}}},
                               false);
    }
    builder.json["scenes"][0]["nodes"] = {child};
    const TempFolder folder;
    const Scene scene = load_scene(folder.write("deep.gltf", builder.text()));
    ASSERT_EQ(scene.instances.size(), 1U);
    EXPECT_NEAR(scene.instances[0].to_world.x.x * std::exp2(20), 1, 1e-9) << depth;  // an even number of half turns
    EXPECT_NEAR(scene.instances[0].to_world.z.z * std::exp2(20), 1, 1e-9) << depth;
  }
}

TEST(ExtremeScale, MirroredAndZeroScales) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  const Geometry plate = quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0);
  TraceSettings settings;
  settings.max_bounces = 0;
  for (const Vec3d scale : {Vec3d{-1, 1, 1}, Vec3d{1, -1, 1}, Vec3d{-1e-6, 1e-6, 1e-6}, Vec3d{-1e6, -1e6, 1e6}}) {
    scene.meshes.clear();
    scene.instances.clear();
    add_mesh(scene, {plate}, make_affine({}, {}, scale));
    const double s = std::fabs(scale.x);
    PathTracer tracer(scene, threads(1));
    EXPECT_EQ(mean_radiance(
                  tracer.at_rest().trace(camera_at({0, 0, 5 * s}, {0, 0, 0}, 10), 1, uniform_map(8, 8, 4), settings))
                  .y,
              1.0)
        << scale.x << ' ' << scale.y;
  }
  // Flat, thin as a line, and nothing at all: left out by loading; here the tracer meets them bare.
  scene.meshes.clear();
  scene.instances.clear();
  add_mesh(scene, {plate});
  for (const Vec3d scale : {Vec3d{1, 1, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 0}}) {
    scene.instances.push_back({0, make_affine({0, 0, -1}, {}, scale)});
  }
  PathTracer tracer(scene, threads(1));
  const SparseFrame frame = tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(8, 8, 4), {});
  EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
  EXPECT_EQ(mean_radiance(frame).y, 1.0);
}

}  // namespace
}  // namespace gazetrace::extreme_scale_test
