// SPDX-License-Identifier: Apache-2.0
// First hits at full resolution, compared with closed forms and with the path tracer's own first hits.
#include "gazetrace/guides.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "gazetrace/error.hpp"
#include "material/directional_albedo.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::guides_test {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kWidth = 90;
constexpr int kHeight = 70;

// A red floor up to the horizon, an emitter seen from the front, a leaf whose left half is cut out, an unlit sign and a
// mirror.
Scene scene_of_kinds() {
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.2F, 0.1F}), diffuse_material({0.3F, 0.3F, 0.3F}, {4, 5, 6}),
                     diffuse_material({0.1F, 0.8F, 0.1F}), diffuse_material({0.25F, 0.5F, 0.75F}),
                     diffuse_material({0.9F, 0.9F, 0.9F})};
  Texture half;
  half.has_alpha = true;
  half.nearest = true;
  half.levels = {{2, 1, {255, 255, 255, 0, 255, 255, 255, 255}}, {1, 1, {255, 255, 255, 128}}};
  scene.textures = {half};
  scene.materials[2].alpha_mode = AlphaMode::mask;
  scene.materials[2].base_color_texture.texture = 0;
  scene.materials[2].double_sided = true;
  scene.materials[3].unlit = true;
  scene.materials[4].metallic = 1;
  scene.materials[4].roughness = 0.1F;
  add_mesh(scene, {quad({{{-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}}}, 0)});
  add_mesh(scene, {quad({{{-2, 2, -5}, {-1, 2, -5}, {-1, 3, -5}, {-2, 3, -5}}}, 1)});
  add_mesh(scene, {quad({{{-0.5F, 2, -5}, {0.5F, 2, -5}, {0.5F, 3, -5}, {-0.5F, 3, -5}}}, 2)});
  add_mesh(scene, {quad({{{1, 2, -5}, {2, 2, -5}, {2, 3, -5}, {1, 3, -5}}}, 3)});
  add_mesh(scene, {quad({{{-0.5F, 0.5F, -5}, {0.5F, 0.5F, -5}, {0.5F, 1.5F, -5}, {-0.5F, 1.5F, -5}}}, 4)});
  scene.environment = constant_environment({0.5F, 0.6F, 0.7F});
  return scene;
}

const Camera kCamera = camera_at({0, 2, 0}, {0, 2, -1}, 60);

// The pixel that sees a point.
PixelIndex pixel_of(const Vec3d& point) {
  const double scale = 0.5 * kHeight / std::tan(30 * kRadPerDeg);
  const Vec3d v = point - Vec3d{0, 2, 0};
  return {static_cast<std::uint16_t>(0.5 * kWidth - v.x / v.z * scale),
          static_cast<std::uint16_t>(0.5 * kHeight + v.y / v.z * scale)};
}

Guides guides_of(const Scene& scene, const GuideSettings& settings = {}, int thread_count = 1) {
  return PathTracer(scene, threads(thread_count)).at_rest().guides(kCamera, kWidth, kHeight, settings);
}

TEST(Guides, SayWhatIsSeen) {
  const Scene scene = scene_of_kinds();
  const Guides guides = guides_of(scene);
  const auto at = [&](const auto& image, const Vec3d& point) {
    const PixelIndex pixel = pixel_of(point);
    return image(pixel.x, pixel.y);
  };
  const Vec3d lamp{-1.5, 2.5, -5};
  const Vec3d hole{-0.25, 2.5, -5};
  const Vec3d leaf{0.25, 2.5, -5};
  const Vec3d sign{1.5, 2.5, -5};
  const Vec3d mirror{0, 1, -5};
  const Vec3d floor{1, 0, -4};
  const Vec3d sky{0, 4, -5};
  EXPECT_EQ(at(guides.kind, lamp), SurfaceKind::diffuse);
  EXPECT_EQ(at(guides.emission, lamp), (Vec3f{4, 5, 6}));
  EXPECT_EQ(at(guides.object, lamp), 2U);
  EXPECT_EQ(at(guides.material, lamp), 2U);
  EXPECT_EQ(at(guides.normal, lamp), (Vec3f{0, 0, 1}));
  EXPECT_NEAR(at(guides.depth_m, lamp), 5, 1e-5);
  for (const Vec3d& empty : {hole, sky}) {
    EXPECT_EQ(at(guides.kind, empty), SurfaceKind::miss);
    EXPECT_EQ(at(guides.emission, empty), (Vec3f{0.5F, 0.6F, 0.7F}));
    EXPECT_EQ(at(guides.albedo, empty), (Vec3f{1, 1, 1}));
    EXPECT_EQ(at(guides.normal, empty), Vec3f{});
    EXPECT_EQ(at(guides.depth_m, empty), kInfinity);
    EXPECT_EQ(at(guides.object, empty), 0U);
    EXPECT_EQ(at(guides.material, empty), 0U);
  }
  EXPECT_EQ(at(guides.kind, leaf), SurfaceKind::diffuse);
  EXPECT_EQ(at(guides.material, leaf), 3U);
  EXPECT_EQ(at(guides.emission, leaf), Vec3f{});
  EXPECT_EQ(at(guides.kind, sign), SurfaceKind::unlit);
  EXPECT_EQ(at(guides.emission, sign), (Vec3f{0.25F, 0.5F, 0.75F}));
  EXPECT_EQ(at(guides.albedo, sign), (Vec3f{1, 1, 1}));
  EXPECT_EQ(at(guides.kind, mirror), SurfaceKind::glossy);
  EXPECT_NEAR(at(guides.albedo, mirror).x, 0.9, 0.02);
  EXPECT_EQ(at(guides.object, floor), 1U);
  EXPECT_EQ(at(guides.normal, floor), (Vec3f{0, 1, 0}));
  const PixelIndex below = pixel_of(floor);
  // The centre's ray falls 2 m over its depth.
  const double slope = (below.y + 0.5 - 0.5 * kHeight) / (0.5 * kHeight / std::tan(30 * kRadPerDeg));
  EXPECT_NEAR(at(guides.depth_m, floor), 2 / slope, 1e-4);
}

TEST(Guides, SameBitsForAnyThreadCount) {
  const Scene scene = scene_of_kinds();
  for (const int spp : {1, 3}) {
    const Guides one = guides_of(scene, {.spp = spp}, 1);
    const Guides two = guides_of(scene, {.spp = spp}, 2);
    EXPECT_EQ(one.albedo, two.albedo);
    EXPECT_EQ(one.normal, two.normal);
    EXPECT_EQ(one.depth_m, two.depth_m);
    EXPECT_EQ(one.emission, two.emission);
    EXPECT_EQ(one.object, two.object);
    EXPECT_EQ(one.material, two.material);
    EXPECT_EQ(one.kind, two.kind);
  }
}

// Many rays give the same as the tracer's own first hits: normals, coverage and directly seen light of each pixel.
TEST(Guides, AgreeWithTracedFirstHits) {
  Scene scene = scene_of_kinds();
  PathTracer tracer(scene, threads(2));
  const Guides guides = tracer.at_rest().guides(kCamera, kWidth, kHeight, {.spp = 64});
  TraceSettings settings;
  settings.guides = true;
  settings.max_bounces = 0;  // emission only
  const SamplingMap map = uniform_map(kWidth, kHeight, 256);
  const SparseFrame traced = tracer.at_rest().trace(kCamera, 0, map, settings);
  std::vector<PixelIndex> pixels;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    pixels_of_site(map, map.sites[i], pixels);
    const std::size_t pixel = guides.normal.index(pixels[0].x, pixels[0].y);
    const float n = 256;
    const Vec3f normal = traced.guides[i].normal / n - guides.normal.pixels[pixel];
    const Vec3f emission = traced.sum[i] / n - guides.emission.pixels[pixel];
    // Both estimate a share of the pixel's area with stratified points. The error at an edge is about n^-3/4 of the
    // difference across it, 0.05 for 64 points; the light beyond an edge is at most 6.
    EXPECT_NEAR(dot(normal, normal), 0, 0.1 * 0.1) << pixels[0].x << ',' << pixels[0].y;
    EXPECT_NEAR(emission.z, 0, 6 * 0.1) << pixels[0].x << ',' << pixels[0].y;
    if (traced.guides[i].hits == 256 && std::isfinite(guides.depth_m.pixels[pixel])) {
      const float depth = traced.guides[i].depth_m / n;
      EXPECT_NEAR(guides.depth_m.pixels[pixel] / depth, 1, 0.25) << pixels[0].x << ',' << pixels[0].y;
    }
  }
}

// What the edge rays see, by a surface of their own or by a nearby pixel, is what many rays through the pixel see.
TEST(Guides, EdgeRaysSeeWhatManyRaysSee) {
  const Scene scene = scene_of_kinds();
  constexpr int kRays = 63;
  const Guides guides = guides_of(scene, {.edge_rays = kRays}, 2);
  const Guides many = guides_of(scene, {.spp = 64}, 2);
  std::size_t pixels = 0;
  std::size_t own = 0;
  for (std::size_t k = 0; k < guides.edge_rays.size(); k += kRays) {
    const std::size_t pixel = guides.edge_rays[k].pixel;
    Vec3f emission = guides.emission.pixels[pixel];
    Vec3f normal = guides.normal.pixels[pixel];
    for (std::size_t r = k; r < k + kRays; ++r) {
      const EdgeRay& ray = guides.edge_rays[r];
      ASSERT_EQ(ray.pixel, pixel);
      own += ray.own_surface ? 1 : 0;
      emission += ray.own_surface ? guides.edge_surfaces[ray.seen_by].emission : guides.emission.pixels[ray.seen_by];
      normal += ray.own_surface ? guides.edge_surfaces[ray.seen_by].normal : guides.normal.pixels[ray.seen_by];
    }
    ++pixels;
    // Within the difference of two nets of 64 points across an edge (above), for light of at most 6.
    EXPECT_NEAR(emission.z / 64, many.emission.pixels[pixel].z, 6 * 0.1F) << pixel;
    const Vec3f off = normal / 64 - many.normal.pixels[pixel];
    EXPECT_LT(dot(off, off), 0.15F * 0.15F) << pixel;
  }
  EXPECT_GT(pixels, 100U);
  EXPECT_LT(own, guides.edge_rays.size() / 2);
  EXPECT_EQ(guides.edge_surfaces.size(), own);
  // In pixels without edge rays, hardly any ray sees across an edge.
  std::vector<bool> has(guides.kind.pixels.size());
  for (const EdgeRay& ray : guides.edge_rays) {
    has[ray.pixel] = true;
  }
  for (std::size_t i = 0; i < has.size(); ++i) {
    if (!has[i]) {
      EXPECT_NEAR(guides.emission.pixels[i].z, many.emission.pixels[i].z, 0.3F) << i;
    }
  }
}

TEST(Guides, RaysOutOfRangeAreRefused) {
  const Scene scene = scene_of_kinds();
  EXPECT_THROW(guides_of(scene, {.spp = 0}), Error);
  EXPECT_THROW(guides_of(scene, {.spp = 65}), Error);
}

// The mean weight of many BSDF samples is the integral that the tables give.
TEST(DirectionalAlbedo, IsTheMeanWeightOfBsdfSamples) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const float metallic : {0.0F, 0.4F, 1.0F}) {
    for (const float roughness : {0.2F, 0.6F, 1.0F}) {
      for (const float cosine : {0.15F, 0.5F, 0.95F}) {
        const Surface surface{{0.8F, 0.3F, 0.05F}, metallic, roughness};
        const Vec3f view{std::sqrt(1 - cosine * cosine), 0, cosine};
        Vec3d sum;
        Vec3d squares;
        constexpr int kSamples = 40000;
        for (int k = 0; k < kSamples; ++k) {
          const BsdfSample sample =
              sample_bsdf<DiffuseModel::burley>(surface, view, {uniform(random), uniform(random)}, uniform(random));
          const Vec3d weight = sample.valid ? to_double(sample.weight) : Vec3d{};
          sum += weight;
          squares += weight * weight;
        }
        const Vec3d mean = sum / static_cast<double>(kSamples);
        const Vec3f expected = directional_albedo(surface, kDielectricF0, cosine);
        const auto bound = [&](double square, double m) {
          // Five standard errors and the interpolation of the tables.
          return 5 * std::sqrt(std::max(square / kSamples - m * m, 0.0) / kSamples) + 0.01;
        };
        EXPECT_NEAR(expected.x, mean.x, bound(squares.x, mean.x)) << metallic << ' ' << roughness << ' ' << cosine;
        EXPECT_NEAR(expected.y, mean.y, bound(squares.y, mean.y)) << metallic << ' ' << roughness << ' ' << cosine;
        EXPECT_NEAR(expected.z, mean.z, bound(squares.z, mean.z)) << metallic << ' ' << roughness << ' ' << cosine;
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::guides_test
