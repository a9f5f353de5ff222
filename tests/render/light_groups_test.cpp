// SPDX-License-Identifier: Apache-2.0
// Light in groups: it adds up to the picture, leaves the picture as it is, and goes where theory says.
#include "gazetrace/light_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "render/tracer_scenes.hpp"
#include "support/reference_bsdf.hpp"

namespace gazetrace::light_groups_test {
namespace {

using namespace test;

constexpr int kWidth = 48, kHeight = 32;

// Glossy, metal, rough, clear-coated and glass bodies in a room that is open to the sky, with a lamp.
Scene room() {
  Scene scene;
  scene.materials.resize(6);
  for (Material& material : scene.materials) {
    material.metallic = 0;
    material.base_color = {0.7F, 0.5F, 0.3F, 1};
  }
  scene.materials[0].roughness = 0.9F;
  scene.materials[1].roughness = 0.3F;
  scene.materials[2].metallic = 1;
  scene.materials[2].roughness = 0.4F;
  scene.materials[3].roughness = 0.8F;
  scene.materials[3].clearcoat.factor = 0.8F;
  scene.materials[4].transmission.factor = 0.9F;
  scene.materials[4].roughness = 0.1F;
  scene.materials[5] = diffuse_material({0, 0, 0}, {6, 5, 4});
  scene.environment = constant_environment({0.4F, 0.6F, 1});
  add_mesh(scene, {quad({{{-6, -1, -6}, {-6, -1, 6}, {6, -1, 6}, {6, -1, -6}}}, 0),
                   quad({{{-6, -1, -4}, {6, -1, -4}, {6, 1, -4}, {-6, 1, -4}}}, 3)});
  for (int i = 0; i < 4; ++i) {
    add_mesh(scene, box(0.5F, false, i + 1), make_affine({-2.4 + 1.6 * i, -0.5, 0}, {}, {1, 1, 1}));
  }
  add_mesh(scene, {quad({{{-0.5F, 3, 0}, {0.5F, 3, 0}, {0.5F, 3, 1}, {-0.5F, 3, 1}}}, 5)});
  return scene;
}

Camera room_camera() {
  return camera_at({0, 1, 5}, {0, 0, 0});
}

double channel(const Vec3f& v, int c) {
  return static_cast<double>(c == 0 ? v.x : c == 1 ? v.y : v.z);
}

// The largest difference of a sum of groups from the whole, in parts of the whole.
template <class Groups, class Whole>
double worst_difference(std::size_t count, const Groups& group, const Whole& whole) {
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t g = 0; g < kLightGroups; ++g) {
        sum += channel(group(g, i), c);
      }
      const double all = channel(whole(i), c);
      worst = std::max(worst, std::abs(sum - all) / std::max(std::abs(all), 1e-6));
    }
  }
  return worst;
}

TEST(LightGroups, AddUpToTheSamplesAndLeaveThemAsTheyAre) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at_rest();
  const SamplingMap map = uniform_map(kWidth, kHeight, 8);
  for (const DiffuseModel diffuse : {DiffuseModel::burley, DiffuseModel::lambert, DiffuseModel::matte}) {
    for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
      TraceSettings settings;
      settings.diffuse = diffuse;
      settings.light_sampling = sampling;
      settings.max_bounces = 4;
      settings.russian_roulette = true;
      settings.clamp_indirect = 3;
      const SparseFrame plain = posed.trace(room_camera(), 1, map, settings);
      settings.light_groups = true;
      const SparseFrame grouped = posed.trace(room_camera(), 1, map, settings);
      EXPECT_EQ(plain.sum, grouped.sum);
      EXPECT_EQ(plain.sum_square_luminance, grouped.sum_square_luminance);
      EXPECT_TRUE(plain.light_groups.empty());
      ASSERT_EQ(grouped.light_groups.size(), map.sites.size());
      const double worst = worst_difference(
          map.sites.size(), [&](std::size_t g, std::size_t i) { return grouped.light_groups[i].sum[g]; },
          [&](std::size_t i) { return grouped.sum[i]; });
      EXPECT_LT(worst, 1e-5);
    }
  }
}

struct Means {
  std::array<double, kLightGroups> group{};
  double operator[](LightGroup g) const { return group[static_cast<std::size_t>(g)]; }
};

Means means_of(const Scene& scene, const Camera& camera, const TraceSettings& given, std::uint32_t spp = 64) {
  PathTracer tracer(scene, threads(2));
  TraceSettings settings = given;
  settings.light_groups = true;
  const SparseFrame frame = tracer.at_rest().trace(camera, 1, uniform_map(kWidth, kHeight, spp), settings);
  Means means;
  for (std::size_t g = 0; g < kLightGroups; ++g) {
    double sum = 0;
    for (const LightGroupSums& site : frame.light_groups) {
      sum += channel(site.sum[g], 1);
    }
    means.group[g] = sum / (static_cast<double>(spp) * kWidth * kHeight);
  }
  return means;
}

TraceSettings settings_of(DiffuseModel diffuse, int max_bounces = 3) {
  TraceSettings settings;
  settings.diffuse = diffuse;
  settings.max_bounces = max_bounces;
  settings.russian_roulette = false;
  return settings;
}

// A wall that fills the view, under a sky of radiance 1 and nothing else.
Scene wall(float metallic, float roughness) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].base_color = {0.5F, 0.5F, 0.5F, 1};
  scene.materials[0].metallic = metallic;
  scene.materials[0].roughness = roughness;
  scene.environment = constant_environment({1, 1, 1});
  add_mesh(scene, {quad({{{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}}, 0)});
  return scene;
}

TEST(LightGroups, LightGoesWhereItBelongs) {
  const Camera close = camera_at({0, 0, 5}, {0, 0, 0});
  const Means matte = means_of(wall(0, 1), close, settings_of(DiffuseModel::matte));
  EXPECT_NEAR(matte[LightGroup::diffuse_direct], 0.5, 2e-3);
  const Means metal = means_of(wall(1, 0.5F), close, {});
  EXPECT_EQ(metal[LightGroup::diffuse_direct], 0);
  EXPECT_GT(metal[LightGroup::specular_direct], 0.4);
  for (const Means& means : {matte, metal}) {
    for (const LightGroup none :
         {LightGroup::diffuse_indirect, LightGroup::specular_indirect, LightGroup::emission, LightGroup::background}) {
      EXPECT_EQ(means[none], 0);
    }
  }
  EXPECT_EQ(matte[LightGroup::specular_direct], 0);
  const Means sky = means_of(wall(0, 1), camera_at({0, 0, -5}, {0, 0, -9}), {});
  EXPECT_EQ(sky[LightGroup::background], 1);
  EXPECT_EQ(sky[LightGroup::diffuse_direct], 0);

  Scene lamp = wall(0, 1);
  lamp.materials[0].emission = {2, 2, 2};
  EXPECT_EQ(means_of(lamp, close, {})[LightGroup::emission], 2);
  lamp.materials[0].emission = {};
  lamp.materials[0].unlit = true;
  EXPECT_EQ(means_of(lamp, close, {})[LightGroup::emission], 0.5);
}

// In a closed room of albedo a whose walls all emit e, light of k events is e a^k.
TEST(LightGroups, DirectLightMeetsOneSurface) {
  constexpr double kAlbedo = 0.6;
  Scene scene;
  scene.materials = {diffuse_material({0.6F, 0.6F, 0.6F}, {1, 1, 1})};
  add_mesh(scene, box(3, true, 0));
  const Means means = means_of(scene, camera_at({0, 0, 2}, {0, 0, -1}), settings_of(DiffuseModel::matte), 256);
  EXPECT_EQ(means[LightGroup::emission], 1);
  EXPECT_NEAR(means[LightGroup::diffuse_direct], kAlbedo, 4e-3);
  EXPECT_NEAR(means[LightGroup::diffuse_indirect], kAlbedo * kAlbedo + std::pow(kAlbedo, 3), 4e-3);
}

FrameRequest request() {
  FrameRequest request;
  request.width_px = kWidth;
  request.height_px = kHeight;
  request.camera = room_camera();
  request.view = view_of_perspective(50 * kRadPerDeg, kWidth, kHeight);
  request.gaze_direction_render = request.gaze_direction_true = request.view.direction(20, 14);
  return request;
}

TEST(LightGroups, LayersAddUpToThePictureUnderEveryFilter) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  for (const FilterInfo& filter : reconstruction_filters()) {
    if (filter.name == "oidn" && denoiser_library().path.empty()) {
      continue;
    }
    FrameSettings settings;
    DensitySampling density = parse_density("mar");
    density.full_rate_spp = 8;
    settings.foveation.sampling = density;
    settings.reconstruction.filter = filter.name;
    settings.threads = 2;
    const RenderedFrame plain = FrameRenderer(tracer, settings).render(request());
    EXPECT_TRUE(plain.layers.light.empty());
    settings.layers.light = true;
    const RenderedFrame grouped = FrameRenderer(tracer, settings).render(request());
    EXPECT_EQ(plain.frame.radiance, grouped.frame.radiance) << filter.name;
    ASSERT_EQ(grouped.layers.light.size(), kLightGroups);
    const double worst = worst_difference(
        grouped.frame.radiance.pixels.size(),
        [&](std::size_t g, std::size_t i) { return grouped.layers.light[g].pixels[i]; },
        [&](std::size_t i) { return grouped.frame.radiance.pixels[i]; });
    EXPECT_LT(worst, 1e-4) << filter.name;
    RecordProperty("worst_" + filter.name, std::to_string(worst));
  }
}

// The last of three frames of a camera that glides, with what the others saw or without.
RenderedFrame third_frame(PathTracer& tracer, AccumulateMode mode, bool light) {
  FrameSettings settings;
  DensitySampling density = parse_density("mar");
  density.full_rate_spp = 8;
  settings.foveation.sampling = density;
  settings.reconstruction.filter = "linear";
  settings.accumulate.mode = mode;
  settings.layers.light = light;
  settings.threads = 2;
  const FrameRenderer renderer(tracer, settings);
  std::vector<WindowFrame> frames;
  TrainedField guided;
  for (int frame = 1; frame <= 3; ++frame) {
    FrameRequest one = request();
    one.frame = frame;
    one.t_video_ns = one.shutter_open_ns = one.shutter_close_ns = 40'000'000LL * frame;
    one.camera = camera_at({0.02 * (frame - 3), 1, 5}, {0, 0, 0});
    frames.push_back(renderer.window_frame(one, guided));
  }
  return mode == AccumulateMode::window ? renderer.finish({&frames[0], &frames[1], &frames[2]}, 2)
                                        : renderer.finish({&frames[2]}, 0);
}

TEST(LightGroups, LayersAddUpToPicturesThatOtherFramesJoin) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const RenderedFrame plain = third_frame(tracer, AccumulateMode::window, false);
  const RenderedFrame grouped = third_frame(tracer, AccumulateMode::window, true);
  EXPECT_EQ(plain.frame.radiance, grouped.frame.radiance);
  EXPECT_NE(grouped.frame.radiance, third_frame(tracer, AccumulateMode::off, true).frame.radiance);
  ASSERT_EQ(grouped.layers.light.size(), kLightGroups);
  const double worst = worst_difference(
      grouped.frame.radiance.pixels.size(),
      [&](std::size_t g, std::size_t i) { return grouped.layers.light[g].pixels[i]; },
      [&](std::size_t i) { return grouped.frame.radiance.pixels[i]; });
  EXPECT_LT(worst, 1e-4);
}

}  // namespace
}  // namespace gazetrace::light_groups_test
