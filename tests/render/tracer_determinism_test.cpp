// SPDX-License-Identifier: Apache-2.0
// The same bits for any thread count, any kernel variant that covers the scene, and any frame order.
#include <gtest/gtest.h>

#include <memory>

#include "render/tracer_scenes.hpp"
#include "support/picture_evidence.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/samples/sample_list.hpp"

namespace gazetrace::tracer_determinism_test {
namespace {

using namespace test;

Texture checker(bool srgb) {
  Texture texture;
  texture.srgb = srgb;
  for (int size = 8; size >= 1; size /= 2) {
    Texture::Level level{size, size, {}};
    for (int i = 0; i < size * size; ++i) {
      const bool on = size == 1 || ((i % size) + (i / size)) % 2 == 0;
      for (const int value : {on ? 230 : 40, 120, on ? 30 : 200, 255}) {
        level.rgba.push_back(static_cast<std::uint8_t>(value));
      }
    }
    texture.levels.push_back(level);
  }
  return texture;
}

Scene small_scene(bool textured, bool emitter) {
  Scene scene;
  scene.materials.push_back(diffuse_material({0.7F, 0.5F, 0.3F}));
  scene.materials.push_back(diffuse_material({0.2F, 0.4F, 0.8F}));
  scene.materials[1].metallic = 0.5F;
  scene.materials[1].roughness = 0.3F;
  if (textured) {
    scene.textures = {checker(true), checker(false)};
    scene.materials[0].base_color_texture.texture = 0;
    scene.materials[0].normal_texture.texture = 1;
    scene.materials[0].metallic_roughness_texture.texture = 1;
  }
  add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1), make_affine({0, 0.7, 0}, {0, 0.2, 0, 0.98}, {1, 1, 1}));
  scene.environment = constant_environment({1, 1, 1});
  if (emitter) {
    scene.materials.push_back(diffuse_material({0.1F, 0.1F, 0.1F}, {5, 5, 5}));
    add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 2)});
  }
  return scene;
}

const Camera kCamera = camera_at({3, 3, 5}, {0, 0.4, 0});

void expect_same_bits(const SparseFrame& a, const SparseFrame& b, const SamplingMap& map) {
  EXPECT_TRUE(same_samples(a, b, map));
  EXPECT_EQ(a.stats.rays_bounce, b.stats.rays_bounce);
  EXPECT_EQ(a.stats.rays_shadow, b.stats.rays_shadow);
}

SamplingMap foveated_map(int width_px, int height_px, const Vec3d& gaze) {
  FoveationSettings settings;
  std::get<RegionSampling>(settings.sampling).samples = {8, 8, 4};
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = {6, 15};
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, width_px, height_px), gaze);
}

TEST(TracerDeterminism, OneAndTwoThreadsGiveTheSameBits) {
  const Scene scene = small_scene(true, true);
  const SamplingMap map = foveated_map(150, 110, {0.1, 0.05, -1});
  TraceSettings settings;
  settings.guides = true;
  const SparseFrame one = PathTracer(scene, threads(1)).at_rest().trace(kCamera, 3, map, settings);
  const SparseFrame two = PathTracer(scene, threads(2)).at_rest().trace(kCamera, 3, map, settings);
  expect_same_bits(one, two, map);
  ASSERT_EQ(one.guides.size(), two.guides.size());
  for (std::size_t i = 0; i < one.guides.size(); ++i) {
    EXPECT_EQ(one.guides[i].normal, two.guides[i].normal);
    EXPECT_EQ(one.guides[i].depth_m, two.guides[i].depth_m);
  }
}

TEST(TracerDeterminism, AFrameDoesNotDependOnItsPredecessors) {
  const Scene scene = small_scene(true, false);
  const SamplingMap map = uniform_map(40, 30, 4);
  PathTracer tracer(scene, threads(2));
  static_cast<void>(tracer.at_rest().trace(kCamera, 1, map, {}));
  const SparseFrame in_sequence = tracer.at_rest().trace(kCamera, 2, map, {});
  const SparseFrame alone = PathTracer(scene, threads(2)).at_rest().trace(kCamera, 2, map, {});
  expect_same_bits(in_sequence, alone, map);
  EXPECT_NE(in_sequence.sum, tracer.at_rest().trace(kCamera, 1, map, {}).sum);  // frames have their own random numbers
}

TEST(TracerDeterminism, GuidesDoNotChangeThePicture) {
  const Scene scene = small_scene(true, false);
  const SamplingMap map = uniform_map(32, 24, 4);
  PathTracer tracer(scene, threads(1));
  TraceSettings guided;
  guided.guides = true;
  expect_same_bits(tracer.at_rest().trace(kCamera, 1, map, {}), tracer.at_rest().trace(kCamera, 1, map, guided), map);
}

TEST(TracerDeterminism, BothKernelVariantsGiveTheSameBits) {
  for (const bool textured : {false, true}) {
    for (const bool emitter : {false, true}) {
      const Scene scene = small_scene(textured, emitter);
      const TracerOptions options = threads(1);
      const RenderScene render_scene(scene, options);
      const LightSampler lights(scene);
      const CameraRays camera(kCamera, 24);
      const SamplingMap map = uniform_map(32, 24, 16);
      const PixelFilterSampler filter(PixelFilter::box);
      const FrameContext context = make_frame_context(scene, render_scene, lights, camera, {});
      std::vector<std::vector<float>> pictures;
      for (const bool all : {false, true}) {
        const NamedKernel& kernel = choose_kernel(render_scene, all);
        const auto work = std::make_unique<Workspace>();
        KernelCounts counts;
        std::vector<float>& picture = pictures.emplace_back();
        SampleList list(map, 0, static_cast<std::uint32_t>(map.sites.size()), 5, 1);
        while (const int count = list.next(filter, work->samples)) {
          kernel.run(context, *work, count, counts);
          picture.insert(picture.end(), work->radiance.g.data, work->radiance.g.data + count);
        }
      }
      EXPECT_STREQ(choose_kernel(render_scene, false).name, "unlayered");
      EXPECT_EQ(pictures[0], pictures[1]) << textured << emitter;
    }
  }
}

TEST(TracerDeterminism, AllFeaturesIsAnOptionOfTheTracer) {
  const Scene scene = small_scene(false, false);
  TracerOptions all = threads(1);
  all.all_features = true;
  const SamplingMap map = uniform_map(32, 24, 4);
  const SparseFrame small = PathTracer(scene, threads(1)).at_rest().trace(kCamera, 1, map, {});
  const SparseFrame full = PathTracer(scene, all).at_rest().trace(kCamera, 1, map, {});
  EXPECT_EQ(small.stats.kernel, "unlayered");
  EXPECT_EQ(full.stats.kernel, "all");
  expect_same_bits(small, full, map);
}

TEST(TracerDeterminism, OnlyPixelReplaysItsSite) {
  const Scene scene = small_scene(true, true);
  const SamplingMap map = foveated_map(120, 90, {0.3, 0.2, -1});
  PathTracer tracer(scene, threads(1));
  const SparseFrame whole = tracer.at_rest().trace(kCamera, 1, map, {});
  std::vector<PixelIndex> pixels;
  for (const std::size_t i : {std::size_t{0}, map.sites.size() / 3, map.sites.size() / 2, map.sites.size() - 1}) {
    pixels_of_site(map, map.sites[i], pixels);
    TraceSettings settings;
    settings.only_pixel = pixels.back();
    const SparseFrame one = tracer.at_rest().trace(kCamera, 1, map, settings);
    EXPECT_EQ(one.sum[i], whole.sum[i]);
    EXPECT_EQ(one.count[i], whole.count[i]);
    EXPECT_EQ(one.stats.samples, map.sites[i].samples);
  }
}

}  // namespace
}  // namespace gazetrace::tracer_determinism_test
