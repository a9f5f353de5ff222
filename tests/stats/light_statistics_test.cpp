// SPDX-License-Identifier: Apache-2.0
// Tests light samples against their densities, and the light that arrives at a point against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "support/chi2.hpp"
#include "trace/lights/light_sampling.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::light_statistics_test {
namespace {

constexpr std::uint32_t kSamples = 200000;
constexpr int kRepeats = 16;

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(hash64(seed)) {}
  float operator()() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return static_cast<float>(hash64(state_) >> 40U) * 0x1p-24F;
  }

 private:
  std::uint64_t state_;
};

Environment noisy_sky(int width, int height, double rotation_rad) {
  Environment environment;
  environment.radiance = ImageRgb(width, height);
  for (std::uint32_t i = 0; i < environment.radiance.pixels.size(); ++i) {
    const float v = static_cast<float>(hash32(i) >> 8U) * 0x1p-24F;
    environment.radiance.pixels[i] = {v * v * v, v * v, v};
  }
  environment.radiance(width / 3, height / 4) = {500, 500, 500};
  environment.rotation_rad = rotation_rad;
  return environment;
}

// Cells are the picture's pixels, computed from the sampled directions; the density is constant inside each.
TEST(EnvironmentSampling, FollowsItsDensity) {
  const std::vector<Environment> skies{noisy_sky(1, 1, 0), noisy_sky(7, 3, 0.5), noisy_sky(64, 32, 2),
                                       noisy_sky(128, 64, 0), noisy_sky(3001, 5, 1)};
  std::uint64_t seed = 0;
  for (const Environment& sky : skies) {
    const EnvironmentSampler sampler(sky);
    const int w = sky.radiance.width_px;
    const int h = sky.radiance.height_px;
    std::vector<double> expected(sky.radiance.pixels.size());
    double sum = 0;
    for (int y = 0; y < h; ++y) {
      const double solid_angle = (std::cos(kPi * y / h) - std::cos(kPi * (y + 1) / h)) * 2 * kPi / w;
      for (int x = 0; x < w; ++x) {
        const double polar = kPi * (y + 0.5) / h;
        const double azimuth = 2 * kPi * ((x + 0.5) / w - 0.5) + sky.rotation_rad;
        const Vec3f center =
            to_float({std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)});
        const double probability = static_cast<double>(sampler.pdf(center)) * solid_angle;
        expected[sky.radiance.index(x, y)] = probability * kSamples;
        sum += probability;
      }
    }
    EXPECT_NEAR(sum, 1, 1e-5) << "the density integrates to 1";
    EXPECT_EQ(std::count(expected.begin(), expected.end(), 0.0), 0);
    std::vector<double> observed(expected.size());
    Random random(++seed);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const float first = random();
      const Vec3d d = to_double(sampler.sample({first, random()}).direction);
      double turns = 0.5 + (std::atan2(d.x, -d.z) - sky.rotation_rad) / (2 * kPi);
      turns -= std::floor(turns);
      const double polar = std::atan2(std::hypot(d.x, d.z), d.y) / kPi;
      observed[sky.radiance.index(std::min(static_cast<int>(turns * w), w - 1),
                                  std::min(static_cast<int>(polar * h), h - 1))] += 1;
    }
    const test::Chi2 result = test::chi2_test(observed, expected);
    EXPECT_GT(result.p_value, test::sidak(skies.size()))
        << w << " x " << h << ": chi2 " << result.statistic << " of " << result.degrees << " degrees";
  }
}

TEST(TriangleSampling, CoversAnAreaEvenly) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].emission = {1, 1, 1};
  Geometry geometry;
  geometry.positions = {{0, 1, 0}, {3, 1, 0}, {1, 1, 4}};
  geometry.triangles = {{0, 1, 2}};
  scene.meshes = {{"", {geometry}}};
  scene.instances = {{0, {}}};
  const LightSampler lights(scene);
  constexpr int kSide = 12;  // barycentric cells, cut by the diagonal
  std::vector<double> observed(kSide * kSide);
  std::vector<double> expected(kSide * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double share = x + y < kSide - 1 ? 1 : (x + y == kSide - 1 ? 0.5 : 0);
      expected[static_cast<std::size_t>(y * kSide + x)] = share * 2 * kSamples / (kSide * kSide);
    }
  }
  Random random(5);
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const float x = random();
    const float y = random();
    const Vec2f b = lights.sample({1, 0, 1}, {0, 1, 0}, {x, y}, random()).barycentric;
    observed[static_cast<std::size_t>(static_cast<int>(b.y * kSide) * kSide + static_cast<int>(b.x * kSide))] += 1;
  }
  EXPECT_GT(test::chi2_test(observed, expected).p_value, test::kFamilyLevel);
}

TEST(TriangleSampling, ChoosesByPower) {
  Scene scene;
  Geometry geometry;
  std::vector<double> power;
  for (int i = 0; i < 40; ++i) {
    const auto size = static_cast<float>(1 + hash32(static_cast<std::uint32_t>(i)) % 100);
    const auto at = static_cast<float>(i * 200);
    const auto first = static_cast<std::uint32_t>(geometry.positions.size());
    geometry.positions.insert(geometry.positions.end(), {{at, 0, 0}, {at + size, 0, 0}, {at, size, 0}});
    geometry.triangles.push_back({first, first + 1, first + 2});
    power.push_back(size * size);
  }
  scene.materials.emplace_back();
  scene.materials[0].emission = {3, 1, 2};
  scene.meshes = {{"", {geometry}}};
  scene.instances = {{0, {}}};
  const LightSampler lights(scene, LightChoice::power);
  double sum = 0;
  for (const double p : power) {
    sum += p;
  }
  std::vector<double> observed(power.size());
  for (double& p : power) {
    p *= kSamples / sum;
  }
  Random random(6);
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const float x = random();
    const float y = random();
    observed[lights.sample({0, 0, 9}, {0, 0, -1}, {x, y}, random()).emitter] += 1;
  }
  EXPECT_GT(test::chi2_test(observed, power).p_value, test::kFamilyLevel);
}

// Irradiance at the origin facing up, by one light sample at a time, no occlusion.
std::vector<double> irradiance(const Scene& scene, std::uint32_t samples, LightChoice choice) {
  const LightSampler lights(scene, choice);
  std::vector<double> repeats;
  for (std::uint64_t repeat = 0; repeat < kRepeats; ++repeat) {
    const SampleKey key = make_sample_key(100 + repeat, 0, 0);
    double sum = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const LightSample light = lights.sample({0, 0, 0}, {0, 1, 0}, sample_2d(key, i, 0), sample_1d(key, i, 1));
      sum += light.valid ? static_cast<double>(light.radiance.y * light.direction.y / light.pdf) : 0;
    }
    repeats.push_back(sum / samples);
  }
  return repeats;
}

// Lambert's formula: half the sum over edges of the angle they subtend times the cosine of their plane's normal.
double polygon_irradiance(const std::vector<Vec3d>& corners, const Vec3d& normal) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d& a = corners[i];
    const Vec3d& b = corners[(i + 1) % corners.size()];
    sum += angle_between_rad(a, b) * dot(normalize(cross(a, b)), normal);
  }
  return std::fabs(0.5 * sum);
}

Geometry ceiling() {
  Geometry geometry;
  geometry.positions = {{-1, 1, -1}, {2, 1, -1}, {2, 1, 1}, {-1, 1, 1}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  return geometry;
}

TEST(Irradiance, EqualsClosedForms) {
  Scene lamp;
  lamp.materials.emplace_back();
  lamp.materials[0].emission = {2, 2, 2};
  lamp.meshes = {{"", {ceiling()}}};
  lamp.instances = {{0, {}}};
  const double from_lamp = 2 * polygon_irradiance({{-1, 1, -1}, {2, 1, -1}, {2, 1, 1}, {-1, 1, 1}}, {0, 1, 0});

  Scene sky;
  sky.environment = constant_environment({0.7F, 0.7F, 0.7F});
  const double from_sky = 0.7 * kPi;

  Scene point;
  point.lights.emplace_back();
  point.lights[0].position_m = {0, 3, 4};
  point.lights[0].intensity = {10, 10, 10};
  const double from_point = 10.0 / 25 * 0.6;

  Scene all = lamp;
  all.environment = sky.environment;
  all.lights = point.lights;
  all.lights.push_back(point.lights[0]);
  all.lights.back().kind = LightKind::directional;
  all.lights.back().direction = {0, -1, 0};
  const double from_all = from_lamp + from_sky + from_point + 10;

  // A picture whose radiance is a function of height only, linear in the polar angle between rows.
  Scene gradient;
  gradient.environment.radiance = ImageRgb(8, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 8; ++x) {
      const auto v = static_cast<float>(64 - y);
      gradient.environment.radiance(x, y) = {v, v, v};
    }
  }
  double from_gradient = 0;
  for (int i = 0; i < 20000; ++i) {
    const double theta = (i + 0.5) / 20000 * kPi / 2;
    const double rows = std::max(theta / kPi * 64 - 0.5, 0.0);
    from_gradient += (64 - rows) * std::cos(theta) * std::sin(theta) * 2 * kPi * (kPi / 2 / 20000);
  }

  // Emission at the ends of what loading lets through; weights are ratios, powers are double.
  Scene blinding = lamp;
  blinding.materials[0].emission = {1e30F, 1e30F, 1e30F};
  Scene faint = lamp;
  faint.materials[0].emission = {1e-30F, 1e-30F, 1e-30F};
  const auto emission_of = [](const Scene& scene) { return static_cast<double>(scene.materials[0].emission.y); };

  struct Case {
    const char* name;
    const Scene* scene;
    double expected;
    LightChoice choice = LightChoice::power;
  };
  const std::vector<Case> cases{{"lamp", &lamp, from_lamp},
                                {"sky", &sky, from_sky},
                                {"point", &point, from_point},
                                {"all", &all, from_all},
                                {"gradient", &gradient, from_gradient},
                                {"lamp, tree", &lamp, from_lamp, LightChoice::tree},
                                {"point, tree", &point, from_point, LightChoice::tree},
                                {"all, tree", &all, from_all, LightChoice::tree},
                                {"blinding", &blinding, from_lamp / 2 * emission_of(blinding)},
                                {"blinding, tree", &blinding, from_lamp / 2 * emission_of(blinding), LightChoice::tree},
                                {"faint", &faint, from_lamp / 2 * emission_of(faint)},
                                {"faint, tree", &faint, from_lamp / 2 * emission_of(faint), LightChoice::tree}};
  for (const Case& c : cases) {
    // Float arithmetic is good for a few 1e-6, which counts where the estimator has no variance.
    const test::MeanTest result =
        test::t_test(irradiance(*c.scene, 1U << 14U, c.choice), c.expected, 5e-6 * c.expected);
    EXPECT_GT(result.p_value, test::sidak(cases.size()))
        << c.name << ": " << result.mean << " +- " << result.standard_error << ", expected " << c.expected;
    EXPECT_LT(result.standard_error, 0.01 * c.expected) << c.name;
  }
}

}  // namespace
}  // namespace gazetrace::light_statistics_test
