// SPDX-License-Identifier: Apache-2.0
// Materials with extensions in the whole tracer: furnace tests, closed forms, and three ways of finding light that must
// agree.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace::layered_render_test {
namespace {

using namespace test;

Material white(float roughness) {
  Material material;
  material.base_color = {1, 1, 1, 1};
  material.metallic = 0;
  material.roughness = roughness;
  return material;
}

Material glass(float roughness, float ior = 1.5F) {
  Material material = white(roughness);
  material.transmission.factor = 1;
  material.volume.thickness = 1;
  material.ior = ior;
  return material;
}

Geometry unit_sphere(int rings) {
  Geometry geometry;
  const int columns = 2 * rings;
  for (int r = 0; r <= rings; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const double polar = kPi * r / rings;
      const double azimuth = 2 * kPi * c / columns;
      const Vec3f p =
          to_float({std::sin(polar) * std::cos(azimuth), std::cos(polar), -std::sin(polar) * std::sin(azimuth)});
      geometry.positions.push_back(p);
      geometry.normals.push_back(p);
    }
  }
  for (int r = 0; r < rings; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto a = static_cast<std::uint32_t>(r * (columns + 1) + c);
      const auto b = a + static_cast<std::uint32_t>(columns) + 1;
      if (r > 0) {
        geometry.triangles.push_back({a, b, a + 1});
      }
      if (r + 1 < rings) {
        geometry.triangles.push_back({a + 1, b, b + 1});
      }
    }
  }
  return geometry;
}

struct Furnace {
  std::string name;
  Material material;
  double bound;
};

// A white sphere in a white room must be invisible. The bounds that layered_albedo_test states for one event and one
// angle average out over the angles of the sphere, but light passes bodies several times.
TEST(LayeredFurnace, AWhiteSphereIsInvisible) {
  std::vector<Furnace> furnaces;
  for (const float roughness : {0.0F, 0.1F, 0.3F, 0.6F, 1.0F}) {
    furnaces.push_back({"glass " + std::to_string(roughness), glass(roughness), 0.005});
    Material sheet = white(roughness);
    sheet.transmission.factor = 1;
    furnaces.push_back({"sheet " + std::to_string(roughness), sheet, 0.005});
  }
  for (const float ior : {1.05F, 1.33F, 2.42F}) {
    furnaces.push_back({"glass of index " + std::to_string(ior), glass(0.5F, ior), 0.005});
  }
  Material dispersive = glass(0.2F);
  dispersive.dispersion = 1;
  furnaces.push_back({"dispersion", dispersive, 0.005});
  for (const float roughness : {0.05F, 0.5F}) {
    Material coated = white(0.8F);
    coated.clearcoat.factor = 1;
    coated.clearcoat.roughness = roughness;
    furnaces.push_back({"clearcoat " + std::to_string(roughness), coated, 0.005});
    Material cloth = white(0.8F);
    cloth.sheen.color = {1, 1, 1};
    cloth.sheen.roughness = roughness;
    furnaces.push_back({"sheen " + std::to_string(roughness), cloth, 0.01});
  }
  Material paper = white(0.8F);
  paper.diffuse_transmission.factor = 0.5F;
  furnaces.push_back({"diffuse transmission", paper, 0.005});
  paper.volume.thickness = 1;
  furnaces.push_back({"diffuse transmission into a body", paper, 0.01});

  const SamplingMap map = uniform_map(16, 16, 16);
  const double level = sidak(3 * furnaces.size());
  for (const Furnace& furnace : furnaces) {
    Scene scene;
    scene.materials = {furnace.material};
    add_mesh(scene, {unit_sphere(128)});
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(2));
    std::array<std::vector<double>, 3> means;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      TraceSettings settings;
      settings.max_bounces = 128;
      settings.russian_roulette = false;
      settings.seed = seed;
      const SparseFrame frame = tracer.at_rest().trace(camera_at({2, 3, 4}, {0, 0, 0}, 15), 1, map, settings);
      EXPECT_EQ(frame.stats.kernel, "all");
      EXPECT_EQ(frame.stats.non_finite_samples, 0U);
      const Vec3d mean = mean_radiance(frame);
      means[0].push_back(mean.x);
      means[1].push_back(mean.y);
      means[2].push_back(mean.z);
    }
    for (const std::vector<double>& channel : means) {
      const MeanTest result = t_test(channel, 1, furnace.bound);
      RecordProperty(furnace.name, std::to_string(result.mean) + " +- " + std::to_string(result.standard_error));
      EXPECT_GT(result.p_value, level) << furnace.name << ": " << result.mean << " +- " << result.standard_error;
      EXPECT_LT(result.standard_error, 0.01) << furnace.name << ": too noisy to mean anything";
    }
  }
}

// A flat box of side 2 and height `height`, fronts outside.
std::vector<Geometry> slab(float half_height) {
  std::vector<Geometry> faces = box(1, false, 0);
  for (Geometry& face : faces) {
    for (Vec3f& p : face.positions) {
      p = {p.x * 50, p.y * half_height, p.z * 50};
    }
  }
  return faces;
}

Camera straight_down(double height) {
  Camera camera;
  camera.pose = look_at({0.1, height, 0.2}, {0.1, height - 1, 0.2}, {0, 0, 1});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 0.1;
  return camera;
}

// Straight through a smooth absorbing plate in a room of radiance 1, all reflections between its faces counted:
// R = 0.04, a = transmittance: seen = R + R (1-R)^2 a^2 / (1 - R^2 a^2) + (1-R)^2 a / (1 - R^2 a^2).
TEST(LayeredLight, AGlassPlateAttenuatesAsBeerAndFresnelSay) {
  Scene scene;
  scene.materials = {glass(0)};
  scene.materials[0].volume.attenuation_color = {0.5F, 0.25F, 1};
  scene.materials[0].volume.attenuation_distance_m = 2;
  add_mesh(scene, slab(0.5F));
  scene.environment = constant_environment({1, 1, 1});
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(8, 8, 1024);
  TraceSettings settings;
  settings.max_bounces = 12;
  settings.russian_roulette = false;
  const auto seen = [](double a) {
    const double r = 0.04;
    const double rest = (1 - r) * (1 - r) / (1 - r * r * a * a);
    return r + r * rest * a * a + rest * a;
  };
  const auto check = [&](const Vec3d& mean, const Vec3d& expected) {
    EXPECT_NEAR(mean.x, expected.x, 3e-3 * expected.x);
    EXPECT_NEAR(mean.y, expected.y, 3e-3 * expected.y);
    EXPECT_NEAR(mean.z, expected.z, 3e-3 * expected.z);
  };
  const double a = std::sqrt(0.5);
  check(mean_radiance(tracer.at_rest().trace(straight_down(3), 1, map, settings)), {seen(a), seen(0.5), seen(1)});

  // From inside, 0.5 m from the face: radiance is n^2 times as large, and what the far face reflects comes back.
  const auto inside = [](double per_m) { return 2.25 * 0.96 * std::sqrt(per_m) / (1 - 0.04 * per_m); };
  check(mean_radiance(tracer.at_rest().trace(straight_down(0), 1, map, settings)), {inside(a), inside(0.5), inside(1)});
}

// An emitter and a sky behind surfaces that transmit light, and another emitter in front of them: MIS, light sampling
// alone and BSDF sampling alone give the same.
TEST(LayeredLight, EveryWayOfFindingLightShowsTheSame) {
  std::vector<Furnace> cases;
  Material sheet = white(0.7F);
  sheet.transmission.factor = 0.8F;
  cases.push_back({"sheet", sheet, 0});
  Material leaf = white(0.6F);
  leaf.base_color = {0.3F, 0.6F, 0.1F, 1};
  leaf.diffuse_transmission.factor = 0.5F;
  cases.push_back({"leaf", leaf, 0});
  Material varnish = white(0.6F);
  varnish.clearcoat.factor = 1;
  varnish.clearcoat.roughness = 0.5F;
  varnish.sheen.color = {0.5F, 0.5F, 0.5F};
  varnish.sheen.roughness = 0.6F;
  cases.push_back({"varnish", varnish, 0});
  cases.push_back({"rough glass", glass(0.8F), 0});
  const double level = sidak(cases.size() * 2);
  for (const Furnace& c : cases) {
    Scene scene;
    scene.materials = {c.material, diffuse_material({0, 0, 0}, {8, 8, 8}), diffuse_material({0, 0, 0}, {4, 2, 1})};
    add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0)});
    add_mesh(scene, {quad({{{-1, -2, -1}, {1, -2, -1}, {1, -2, 1}, {-1, -2, 1}}}, 1)});
    scene.materials[1].double_sided = true;
    scene.materials[2].double_sided = true;
    add_mesh(scene, {quad({{{-2, 2, -2}, {-1, 2, -2}, {-1, 2, -1}, {-2, 2, -1}}}, 2)});
    scene.environment = constant_environment({0.5F, 0.5F, 0.5F});
    PathTracer tracer(scene, threads(2));
    const SamplingMap map = uniform_map(12, 12, 64);
    std::array<std::vector<double>, 3> means;
    constexpr std::array kWays{LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only};
    for (std::size_t way = 0; way < kWays.size(); ++way) {
      for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        TraceSettings settings;
        settings.max_bounces = 1;
        settings.light_sampling = kWays[way];
        settings.seed = seed + 100 * way;
        means[way].push_back(
            mean_radiance(tracer.at_rest().trace(camera_at({1, 3, 4}, {0, 0, 0}, 20), 1, map, settings)).x);
      }
    }
    for (const std::size_t way : {std::size_t{1}, std::size_t{2}}) {
      std::vector<double> difference;
      for (std::size_t i = 0; i < means[0].size(); ++i) {
        difference.push_back(means[way][i] - means[0][i]);
      }
      const MeanTest result = t_test(difference, 0);
      EXPECT_GT(result.p_value, level) << c.name << " way " << way << ": " << result.mean << " +- "
                                       << result.standard_error << " of " << means[0][0];
      EXPECT_LT(result.standard_error, 0.01 * means[0][0]) << c.name << ": too noisy to mean anything";
    }
  }
}

// Opaque bodies in glass: their light passes the glass once on the way out, and paths know which body they are in.
TEST(LayeredLight, ABodyInsideAnotherIsSeenThroughIt) {
  Scene scene;
  scene.materials = {glass(0), diffuse_material({0, 0, 0}, {1, 1, 1})};
  scene.materials[0].volume.attenuation_color = {0.5F, 0.25F, 1};
  scene.materials[0].volume.attenuation_distance_m = 1;
  add_mesh(scene, slab(1));
  add_mesh(scene, {quad({{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}}, 1)});
  PathTracer tracer(scene, threads(1));
  TraceSettings settings;
  settings.max_bounces = 1;
  const Vec3d mean = mean_radiance(tracer.at_rest().trace(straight_down(3), 1, uniform_map(8, 8, 256), settings));
  const double through = 0.96 / 2.25;  // what enters, squeezed by n^2
  EXPECT_NEAR(mean.x, through * 0.5, 3e-3);
  EXPECT_NEAR(mean.y, through * 0.25, 3e-3);
  EXPECT_NEAR(mean.z, through, 3e-3);
}

TEST(LayeredDeterminism, OneAndTwoThreadsGiveTheSameBits) {
  Scene scene;
  scene.materials = {glass(0.2F), diffuse_material({0.7F, 0.5F, 0.3F}), white(0.3F)};
  scene.materials[0].dispersion = 1;
  scene.materials[2].clearcoat.factor = 1;
  scene.materials[2].anisotropy.strength = 0.7F;
  scene.materials[2].iridescence.factor = 0.5F;
  add_mesh(scene, {unit_sphere(32)});
  add_mesh(scene, {quad({{{-3, -1, 3}, {3, -1, 3}, {3, -1, -3}, {-3, -1, -3}}}, 1)});
  add_mesh(scene, box(0.4F, false, 2), make_affine({1.5, 0, 0}, {0, 0.2, 0, 0.98}, {1, 1, 1}));
  scene.environment = constant_environment({1, 0.8F, 0.6F});
  const SamplingMap map = uniform_map(64, 48, 8);
  TraceSettings settings;
  settings.max_bounces = 6;
  settings.russian_roulette = false;
  const Camera camera = camera_at({2, 2, 5}, {0, 0, 0});
  const SparseFrame one = PathTracer(scene, threads(1)).at_rest().trace(camera, 1, map, settings);
  const SparseFrame two = PathTracer(scene, threads(2)).at_rest().trace(camera, 1, map, settings);
  EXPECT_TRUE(same_samples(one, two, map));
  EXPECT_EQ(one.stats.non_finite_samples, 0U);
  EXPECT_EQ(one.stats.rejected_rays, 0U);
}

// KHR_materials_clearcoat, "Emission": 1 - coat (0.04 + 0.96 (1 - cos)^5) of it passes the coat.
TEST(LayeredRender, ACoatDimsWhatShinesUnderIt) {
  for (const float coat : {0.0F, 0.5F, 1.0F}) {
    for (const double cosine : {1.0, 0.5, 0.1}) {
      Scene scene;
      scene.materials = {diffuse_material({0, 0, 0}, {3, 2, 1})};
      scene.materials[0].clearcoat.factor = coat;
      add_mesh(scene, {quad({{{-90, 0, 90}, {90, 0, 90}, {90, 0, -90}, {-90, 0, -90}}}, 0)});
      PathTracer tracer(scene, threads(1));
      Camera camera;
      camera.pose = look_at(Vec3d{std::sqrt(1 - cosine * cosine), cosine, 0} * 5.0, {0, 0, 0}, {0, 0, 1});
      camera.projection.kind = ProjectionKind::orthographic;
      camera.projection.ymag_m = 0.1;
      TraceSettings settings;
      settings.max_bounces = 0;
      const double passes = 1 - static_cast<double>(coat) * (0.04 + 0.96 * std::pow(1 - cosine, 5));
      const Vec3d mean = mean_radiance(tracer.at_rest().trace(camera, 1, uniform_map(4, 4, 4), settings));
      EXPECT_NEAR(mean.x, 3 * passes, 1e-4) << coat << ' ' << cosine;
      EXPECT_NEAR(mean.z, 1 * passes, 1e-4) << coat << ' ' << cosine;
    }
  }
}

// A coated emitter over a floor: rays that find it and light samples of it give the same.
TEST(LayeredRender, ACoatedLampIsTheSameHoweverItIsFound) {
  Scene scene;
  scene.materials = {white(1), diffuse_material({0, 0, 0}, {3, 3, 3})};
  scene.materials[1].clearcoat.factor = 1;
  add_mesh(scene, {quad({{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}}, 0)});
  add_mesh(scene, {quad({{{-2, 1, -2}, {2, 1, -2}, {2, 1, 2}, {-2, 1, 2}}}, 1)});
  PathTracer tracer(scene, threads(2));
  std::array<Repeats, 3> found;
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    for (const LightSampling sampling : {LightSampling::mis, LightSampling::light_only, LightSampling::bsdf_only}) {
      TraceSettings settings;
      settings.seed = seed;
      settings.light_sampling = sampling;
      settings.max_bounces = 1;
      found[static_cast<std::size_t>(sampling)].means.push_back(
          mean_radiance(tracer.at_rest().trace(camera_at({4, 0.5, 0}, {0, 0, 0}), 1, uniform_map(16, 16, 64), settings))
              .y);
    }
  }
  EXPECT_LT(std::fabs(welch_t(found[0], found[1])), kCriticalT);
  EXPECT_LT(std::fabs(welch_t(found[0], found[2])), kCriticalT);
}

}  // namespace
}  // namespace gazetrace::layered_render_test
