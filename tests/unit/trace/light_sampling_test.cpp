// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/light_sampling.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/hash.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::light_sampling_test {
namespace {

constexpr SampleKey kKey = make_sample_key(11, 0, 0);
constexpr Vec3f kUp{0, 1, 0};

Material emitter(const Vec3f& emission, bool double_sided = false) {
  Material material;
  material.emission = emission;
  material.double_sided = double_sided;
  return material;
}

Geometry triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, std::int32_t material = 0) {
  Geometry geometry;
  geometry.positions = {a, b, c};
  geometry.triangles = {{0, 1, 2}};
  geometry.material = material;
  return geometry;
}

// A 2 x 2 m square at y = 1 that shines downwards.
Geometry ceiling(std::int32_t material = 0) {
  Geometry geometry;
  geometry.positions = {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  geometry.material = material;
  return geometry;
}

PunctualLight point_light(const Vec3f& position, const Vec3f& intensity) {
  PunctualLight light;
  light.position_m = to_double(position);
  light.intensity = intensity;
  return light;
}

TEST(AliasTable, HasExactlyTheGivenProbabilities) {
  for (const std::vector<double>& weights :
       {std::vector<double>{1}, {1, 1}, {0, 3, 0, 1}, {1e-30, 1e30, 5}, {1e-300, 2e-300}, {7, 1, 2, 3, 1e-3, 0, 40}}) {
    const AliasTable table(weights);
    double sum = 0;
    for (const double w : weights) {
      sum += w;
    }
    const std::vector<double> p = table.probabilities();
    ASSERT_EQ(p.size(), weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_NEAR(p[i], weights[i] / sum, 1e-7);
      if (weights[i] == 0) {
        EXPECT_EQ(p[i], 0) << "what weighs nothing is never chosen";
      }
    }
  }
}

TEST(AliasTable, ChoosesAsOftenAsItSays) {
  const std::vector<double> weights{7, 1, 2, 3, 0, 40};
  const AliasTable table(weights);
  constexpr int kSteps = 530000;
  std::vector<double> chosen(weights.size());
  for (int i = 0; i < kSteps; ++i) {
    chosen[table.choose((i + 0.5) / kSteps)] += 1.0 / kSteps;
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(chosen[i], weights[i] / 53, 1e-5);
  }
}

TEST(AliasTable, IsEmptyWithoutWeight) {
  EXPECT_TRUE(AliasTable().empty());
  EXPECT_TRUE(AliasTable({0, 0}).empty());
}

Environment dot_environment(int x, int y, double rotation_rad) {
  Environment environment;
  environment.radiance = ImageRgb(64, 32);
  environment.radiance(x, y) = {100, 100, 100};
  environment.rotation_rad = rotation_rad;
  return environment;
}

TEST(Environment, FollowsTheDocumentedDirections) {
  // Pixel 32 of 64 begins at the picture's centre, which is -z; row 15 ends at the horizon.
  const double half_pixel = kPi / 64;
  for (const double rotation : {0.0, kPi / 2, -kPi / 2, 3.0, 7.0}) {
    const Environment environment = dot_environment(32, 15, rotation);
    const EnvironmentSampler sampler(environment);
    const double azimuth = half_pixel + rotation;
    const Vec3d towards{std::cos(half_pixel) * std::sin(azimuth), std::sin(half_pixel),
                        -std::cos(half_pixel) * std::cos(azimuth)};
    EXPECT_NEAR(sampler.radiance(to_float(towards)).x, 100, 0.05) << rotation;
    EXPECT_EQ(sampler.radiance(to_float(-towards)).x, 0) << rotation;
    for (std::uint32_t i = 0; i < 100; ++i) {
      const auto chosen = sampler.sample(sample_2d(kKey, i, 0));
      EXPECT_LT(angle_between_rad(to_double(chosen.direction), towards), 5.5 * half_pixel);
    }
  }
  EXPECT_NEAR(EnvironmentSampler(dot_environment(3, 0, 0)).radiance({0, 1, 0}).x, 0, 100) << "finite at the pole";
}

TEST(Environment, WrapsAroundBehindAndStopsAtThePoles) {
  Environment environment;
  environment.radiance = ImageRgb(4, 2, {1, 1, 1});
  environment.radiance(3, 0) = environment.radiance(3, 1) = {3, 3, 3};
  const EnvironmentSampler sampler(environment);
  // Behind (+z) lies the seam, half-way between the centres of pixels 3 and 0.
  EXPECT_NEAR(sampler.radiance({0, 0, 1}).x, 2, 1e-5);
  EXPECT_NEAR(sampler.radiance({1e-4F, 0, 1}).x, 2, 1e-3);
  // u = 7/8, the centre of pixel 3: three eighths of a turn from -z towards +x.
  EXPECT_NEAR(sampler.radiance({std::sqrt(0.5F), 0, std::sqrt(0.5F)}).x, 3, 1e-4);
}

TEST(Environment, SamplesCarryTheirOwnRadianceAndDensity) {
  Environment environment;
  environment.radiance = ImageRgb(50, 20);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const float v = static_cast<float>(hash32(i) >> 8U) * 0x1p-24F;
    environment.radiance.pixels[i] = {v * v, v, 1 - v};
  }
  environment.rotation_rad = 1;
  const EnvironmentSampler sampler(environment);
  int edges = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const auto chosen = sampler.sample(sample_2d(kKey, i, 1));
    EXPECT_NEAR(length(chosen.direction), 1, 1e-6);
    const auto seen = sampler.value(chosen.direction);
    EXPECT_NEAR(seen.radiance.x, chosen.radiance.x, 1e-4);
    EXPECT_NEAR(seen.radiance.z, chosen.radiance.z, 1e-4);
    edges += std::fabs(seen.pdf / chosen.pdf - 1) > 1e-5F ? 1 : 0;
  }
  EXPECT_LE(edges, 4) << "only on the very edge of a cell";
}

TEST(Environment, AConstantIsUniform) {
  const Environment environment = constant_environment({2, 2, 2});
  const EnvironmentSampler sampler(environment);
  EXPECT_NEAR(sampler.total(), 8 * kPi, 1e-6);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto chosen = sampler.sample(sample_2d(kKey, i, 1));
    EXPECT_NEAR(chosen.pdf, 1 / (4 * kPi), 1e-7);
    EXPECT_FLOAT_EQ(chosen.radiance.x, 2);
  }
}

TEST(Environment, BlackIsNeverChosen) {
  Scene scene;
  scene.environment = constant_environment({0, 0, 0});
  const LightSampler lights(scene);
  EXPECT_FALSE(lights.any());
  EXPECT_FALSE(lights.sample({0, 0, 0}, kUp, {0.5F, 0.5F}, 0.5F).valid);
  EXPECT_EQ(lights.environment(kUp).pdf, 0);
  EXPECT_EQ(lights.environment(kUp).radiance, Vec3f{});
  const LightSampler nothing{Scene{}};
  EXPECT_FALSE(nothing.any());
  EXPECT_EQ(nothing.environment(kUp).radiance, Vec3f{});
  EXPECT_EQ(nothing.pdf_environment(kUp), 0);
}

TEST(Environment, ASunOnBlackIsAllThatIsSampled) {
  Scene scene;
  scene.environment.radiance = ImageRgb(1024, 512);
  scene.environment.radiance(700, 100) = {1e6F, 1e6F, 1e6F};
  const LightSampler lights(scene);
  double sum = 0;
  constexpr std::uint32_t kCount = 1U << 14U;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const LightSample chosen = lights.sample({}, kUp, sample_2d(kKey, i, 4), 0.5F);
    ASSERT_TRUE(chosen.valid && std::isfinite(chosen.pdf));
    sum += static_cast<double>(chosen.radiance.x / chosen.pdf);
  }
  // The integral of one bilinear tent over solid angle, nearly its pixel's solid angle.
  const double expected = 1e6 * 2 * kPi / 1024 * kPi / 512 * std::sin(kPi * 100.5 / 512);
  EXPECT_NEAR(sum / kCount / expected, 1, 0.01);
}

TEST(Triangles, SampledDensityEqualsTheDensityOfAHit) {
  Scene scene;
  scene.materials = {emitter({5, 4, 3})};
  scene.meshes = {{"", {ceiling()}}};
  scene.instances = {{0, make_affine({0.3, 1, -0.2}, normalize(Quatd{0.1, 0.2, 0.3, 1}), {1, 2, 0.5})}};
  const LightSampler lights(scene);
  const Vec3f from{0.4F, -0.5F, 0.1F};
  int valid = 0;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const LightSample chosen = lights.sample(from, kUp, sample_2d(kKey, i, 5), sample_1d(kKey, i, 6));
    if (!chosen.valid) {
      continue;
    }
    ++valid;
    const EmissiveTriangle& t = lights.triangle(chosen.emitter);
    const Vec3f hit = t.origin + t.edge1 * chosen.barycentric.x + t.edge2 * chosen.barycentric.y;
    EXPECT_NEAR(length(hit - (from + chosen.direction * chosen.distance)), 0, 1e-5);
    EXPECT_TRUE(chosen.barycentric.x >= 0 && chosen.barycentric.y >= 0 &&
                chosen.barycentric.x + chosen.barycentric.y <= 1);
    const float pdf = lights.pdf_triangle(chosen.emitter, -dot(t.normal, chosen.direction),
                                          chosen.distance * chosen.distance, from, kUp);
    EXPECT_NEAR(pdf / chosen.pdf, 1, 1e-5);
    EXPECT_EQ(chosen.radiance, (Vec3f{5, 4, 3}));
  }
  EXPECT_GT(valid, 900);
}

TEST(Triangles, ShineFromTheFrontUnlessDoubleSided) {
  for (const bool double_sided : {false, true}) {
    for (const double mirror : {1.0, -1.0}) {
      Scene scene;
      scene.materials = {emitter({1, 1, 1}, double_sided)};
      scene.meshes = {{"", {ceiling()}}};
      scene.instances = {{0, make_affine({}, {}, {mirror, 1, 1})}};  // a mirrored instance keeps its front
      const LightSampler lights(scene);
      const LightSample below = lights.sample({0, 0, 0}, kUp, {0.3F, 0.6F}, 0.2F);
      const LightSample above = lights.sample({0, 2, 0}, -kUp, {0.3F, 0.6F}, 0.2F);
      EXPECT_TRUE(below.valid) << mirror;
      EXPECT_EQ(above.valid, double_sided) << mirror;
    }
  }
}

TEST(Triangles, AreFoundByInstanceGeometryAndPrimitive) {
  Scene scene;
  scene.materials = {Material{}, emitter({1, 1, 1}), emitter({0, 0, 2})};
  scene.materials.push_back(emitter({9, 9, 9}));
  scene.materials.back().unlit = true;
  scene.meshes = {{"dark", {ceiling(0)}},
                  {"lamp", {ceiling(0), ceiling(1), ceiling(3), triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2)}}};
  scene.instances = {{0, {}}, {1, {}}, {0, {}}, {1, make_affine({5, 0, 0}, {}, {1, 1, 1})}};
  const LightSampler lights(scene);
  EXPECT_EQ(lights.triangle_count(), 6U);
  for (const std::uint32_t instance : {0U, 1U, 2U, 3U}) {
    for (std::uint32_t geometry = 0; geometry < scene.meshes[instance % 2].geometries.size(); ++geometry) {
      const std::uint32_t primitives = geometry == 3 ? 1 : 2;
      for (std::uint32_t primitive = 0; primitive < primitives; ++primitive) {
        const std::uint32_t found = lights.emitter_of(instance, geometry, primitive);
        if (instance % 2 == 0 || geometry == 0 || geometry == 2) {
          EXPECT_EQ(found, kNoEmitter);
          continue;
        }
        const EmissiveTriangle& t = lights.triangle(found);
        EXPECT_EQ(t.instance, static_cast<std::int32_t>(instance));
        EXPECT_EQ(t.geometry, static_cast<std::int32_t>(geometry));
        EXPECT_EQ(t.primitive, static_cast<std::int32_t>(primitive));
      }
    }
  }
}

TEST(Triangles, ExtremesOfEmissionAndShapeStayFinite) {
  Scene scene;
  scene.materials = {emitter({1e30F, 1e30F, 1e30F}), emitter({1e-30F, 1e-30F, 1e-30F})};
  Geometry flat = triangle({0, 1, 0}, {1, 1, 0}, {2, 1, 0}, 0);  // no area
  flat.positions.push_back({0, 1, 1});
  flat.triangles.push_back({0, 3, 1});
  scene.meshes = {{"", {flat, ceiling(1)}}};
  scene.instances = {{0, {}}};
  for (const float scale : {1e-6F, 1.0F, 1e6F}) {
    scene.instances[0].to_world = make_affine({}, {}, {scale, scale, scale});
    const LightSampler lights(scene);
    ASSERT_TRUE(lights.any());
    EXPECT_EQ(lights.triangle(lights.emitter_of(0, 0, 0)).pdf_area, 0) << "a line is never chosen";
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const LightSample chosen =
          lights.sample(Vec3f{0.1F, 0, 0.1F} * scale, kUp, sample_2d(kKey, i, 7), sample_1d(kKey, i, 8));
      EXPECT_NE(chosen.emitter, lights.emitter_of(0, 0, 0));
      if (chosen.valid) {
        EXPECT_TRUE(std::isfinite(chosen.pdf) && chosen.pdf > 0 && is_finite(chosen.direction));
      }
    }
  }
}

// The left half of the texture is bright, the right half black: only the triangles there are worth a sample.
TEST(Triangles, WeighTexturesByTheirOwnCorner) {
  Scene scene;
  Texture texture;
  for (int size = 64; size >= 1; size /= 2) {
    Texture::Level level{size, size, std::vector<std::uint8_t>(static_cast<std::size_t>(4 * size * size))};
    for (int i = 0; i < size * size; ++i) {
      for (int c = 0; c < 3; ++c) {
        level.rgba[static_cast<std::size_t>(4 * i + c)] = size == 1 ? 64 : (i % size < size / 2 ? 128 : 0);
      }
    }
    texture.levels.push_back(level);
  }
  texture.wrap_u = texture.wrap_v = TextureWrap::clamp;
  scene.textures = {texture};
  scene.materials = {emitter({2, 2, 2})};
  scene.materials[0].emissive_texture.texture = 0;
  Geometry bright = ceiling();
  bright.uv0 = {{0, 0}, {0.4F, 0}, {0.4F, 1}, {0, 1}};
  Geometry black = ceiling();
  black.uv0 = {{0.6F, 0}, {1, 0}, {1, 1}, {0.6F, 1}};
  scene.meshes = {{"", {bright, black}}};
  scene.instances = {{0, {}}};
  const LightSampler lights(scene);
  EXPECT_NEAR(lights.triangle(0).pdf_area, 1.0 / 4, 1e-6) << "half of the samples on half of 4 m^2";
  EXPECT_NEAR(lights.triangle(1).pdf_area, 1.0 / 4, 1e-6);
  EXPECT_EQ(lights.triangle(2).pdf_area, 0);
  EXPECT_EQ(lights.triangle(3).pdf_area, 0);
  EXPECT_EQ(lights.sample({}, kUp, {0.4F, 0.4F}, 0.3F).radiance, (Vec3f{2, 2, 2})) << "the texture is the tracer's";
}

// KHR_lights_punctual's formulas, by hand.
TEST(Punctual, PointFallsOffWithDistanceAndRange) {
  Scene scene;
  scene.lights = {point_light({0, 4, 3}, {50, 100, 25})};
  LightSample got = LightSampler(scene).sample({0, 0, 0}, kUp, {0.5F, 0.5F}, 0.5F);
  ASSERT_TRUE(got.valid);
  EXPECT_TRUE(got.delta);
  EXPECT_FLOAT_EQ(got.pdf, 1);
  EXPECT_FLOAT_EQ(got.distance, 5);
  EXPECT_NEAR(got.direction.y, 0.8, 1e-6);
  EXPECT_NEAR(got.radiance.y, 4, 1e-5);
  scene.lights[0].range_m = 10;
  got = LightSampler(scene).sample({0, 0, 0}, kUp, {0.5F, 0.5F}, 0.5F);
  EXPECT_NEAR(got.radiance.y, 4 * (1 - 1.0 / 16), 1e-5);
  scene.lights[0].range_m = 4.9F;
  EXPECT_FALSE(LightSampler(scene).sample({0, 0, 0}, kUp, {0.5F, 0.5F}, 0.5F).valid);
  EXPECT_FALSE(LightSampler(scene).sample({0, 4, 3}, kUp, {0.5F, 0.5F}, 0.5F).valid) << "in the light itself";
  EXPECT_FALSE(LightSampler(scene).sample({0, 0, 0}, -kUp, {0.5F, 0.5F}, 0.5F).valid) << "from behind";
}

TEST(Punctual, SpotFadesBetweenItsCones) {
  Scene scene;
  scene.lights = {point_light({0, 2, 0}, {40, 40, 40})};
  scene.lights[0].kind = LightKind::spot;
  scene.lights[0].direction = {0, -3, 0};  // any length
  scene.lights[0].cos_inner = static_cast<float>(std::cos(20 * kRadPerDeg));
  scene.lights[0].cos_outer = static_cast<float>(std::cos(40 * kRadPerDeg));
  const LightSampler lights(scene);
  for (const double angle_deg : {0.0, 10.0, 19.0, 25.0, 35.0, 39.0, 41.0, 60.0}) {
    const double x = 2 * std::tan(angle_deg * kRadPerDeg);
    const LightSample got = lights.sample({static_cast<float>(x), 0, 0}, kUp, {0.5F, 0.5F}, 0.5F);
    const double inner = std::cos(20 * kRadPerDeg);
    const double outer = std::cos(40 * kRadPerDeg);
    const double t = std::clamp((std::cos(angle_deg * kRadPerDeg) - outer) / (inner - outer), 0.0, 1.0);
    EXPECT_EQ(got.valid, angle_deg < 40);
    EXPECT_NEAR(got.radiance.x, 40 / (4 + x * x) * t * t, 1e-4) << angle_deg;
  }
}

TEST(Punctual, DirectionalComesFromInfinity) {
  Scene scene;
  scene.lights = {point_light({}, {3, 2, 1})};
  scene.lights[0].kind = LightKind::directional;
  scene.lights[0].direction = {0, -4, -3};
  const LightSample got = LightSampler(scene).sample({100, 0, 0}, kUp, {0.5F, 0.5F}, 0.5F);
  ASSERT_TRUE(got.valid);
  EXPECT_TRUE(std::isinf(got.distance));
  EXPECT_NEAR(got.direction.y, 0.8, 1e-6);
  EXPECT_NEAR(got.direction.z, 0.6, 1e-6);
  EXPECT_EQ(got.radiance, (Vec3f{3, 2, 1}));
}

TEST(LightChoice, GivesEveryPresentClassItsFloor) {
  Scene scene;
  scene.materials = {emitter({1e-9F, 1e-9F, 1e-9F})};
  scene.meshes = {{"", {ceiling()}}};
  scene.instances = {{0, {}}};
  scene.environment = constant_environment({1e6F, 1e6F, 1e6F});
  scene.lights = {point_light({0, 1, 0}, {1, 1, 1}), point_light({0, 2, 0}, {0, 0, 0})};
  const LightSampler lights(scene);
  EXPECT_NEAR(lights.triangle_probability(), 0.1, 1e-6);
  EXPECT_NEAR(lights.punctual_probability(), 0.1, 1e-6);
  EXPECT_NEAR(lights.environment_probability(), 0.8, 1e-6);
}

}  // namespace
}  // namespace gazetrace::light_sampling_test
