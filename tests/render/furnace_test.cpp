// SPDX-License-Identifier: Apache-2.0
// Convex objects in a uniform environment of radiance 1 show the directional albedo of their BRDF, which is computed
// here by an independent quadrature in double precision. One bounce is exact, since nothing is hit twice.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/reference_bsdf.hpp"

namespace gazetrace::furnace_test {
namespace {

using namespace test;

constexpr int kSeeds = 16;
constexpr std::array kModels{DiffuseModel::burley, DiffuseModel::lambert};
constexpr Vec3f kColor{0.9F, 0.5F, 0.1F};
// The library's tables are floats from a quadrature of their own, so the difference to the reference is not noise only.
constexpr double kTableError = 2e-4;

Material surface_material(float metallic, float roughness, const Vec3f& color = kColor) {
  Material material;
  material.base_color = {color.x, color.y, color.z, 1};
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

// A large square at the origin that faces +y, seen at one angle by an orthographic camera.
Scene square_scene(const Material& material) {
  Scene scene;
  scene.materials = {material};
  add_mesh(scene, {quad({{{-90, 0, 90}, {90, 0, 90}, {90, 0, -90}, {-90, 0, -90}}}, 0)});
  scene.environment = constant_environment({1, 1, 1});
  return scene;
}

Camera camera_under(double mu) {
  Camera camera;
  const double sine = std::sqrt(1 - mu * mu);
  camera.pose = look_at(Vec3d{0.6 * sine, mu, 0.8 * sine} * 5.0, {0, 0, 0}, {0, 1, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 0.5;
  return camera;
}

struct Case {
  float roughness, metallic, mu;
  DiffuseModel diffuse;
  LightSampling sampling;
  double expected;
};

void expect_albedos(const std::vector<Case>& cases) {
  const SamplingMap map = uniform_map(8, 8, 64);
  const double level = sidak(cases.size());
  for (const Case& c : cases) {
    const Scene scene = square_scene(surface_material(c.metallic, c.roughness));
    PathTracer tracer(scene, threads(1));
    const Camera camera = camera_under(c.mu);
    TraceSettings settings;
    settings.max_bounces = 1;
    settings.diffuse = c.diffuse;
    settings.light_sampling = c.sampling;
    std::vector<double> means;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      settings.seed = seed;
      const Vec3d mean = mean_radiance(tracer.at_rest().trace(camera, 1, map, settings));
      means.push_back((mean.x + mean.y + mean.z) / 3);
    }
    const MeanTest result = t_test(means, c.expected, kTableError);
    EXPECT_GT(result.p_value, level) << "roughness " << c.roughness << " metallic " << c.metallic << " cosine " << c.mu
                                     << " model " << static_cast<int>(c.diffuse) << " sampling "
                                     << static_cast<int>(c.sampling) << ": " << result.mean << " +- "
                                     << result.standard_error << ", expected " << c.expected;
    if (c.sampling != LightSampling::light_only) {
      EXPECT_LT(result.standard_error, 2e-3) << "too noisy to mean anything";
    }
  }
}

double channel_mean(const Vec3d& v) {
  return (v.x + v.y + v.z) / 3;
}

TEST(Furnace, ASquareShowsItsDirectionalAlbedo) {
  std::vector<Case> cases;
  for (const float roughness : {0.0F, 0.15F, 0.4F, 0.7F, 1.0F}) {
    for (const float metallic : {0.0F, 0.5F, 1.0F}) {
      for (const DiffuseModel diffuse : kModels) {
        const ReferenceBsdf reference({to_double(kColor), metallic, roughness, diffuse});
        for (const float mu : {0.1F, 0.5F, 0.98F}) {
          cases.push_back({roughness, metallic, mu, diffuse, LightSampling::mis, channel_mean(reference.albedo(mu))});
        }
      }
    }
  }
  expect_albedos(cases);
}

TEST(Furnace, EveryWayOfFindingLightShowsTheSame) {
  std::vector<Case> cases;
  for (const float roughness : {0.4F, 1.0F}) {
    for (const float metallic : {0.0F, 1.0F}) {
      const ReferenceBsdf reference({to_double(kColor), metallic, roughness, DiffuseModel::burley});
      for (const LightSampling sampling : {LightSampling::light_only, LightSampling::bsdf_only}) {
        cases.push_back(
            {roughness, metallic, 0.6F, DiffuseModel::burley, sampling, channel_mean(reference.albedo(0.6))});
      }
    }
  }
  expect_albedos(cases);
}

// A unit sphere of `rings` x 2 `rings` quadrilaterals with exact normals at its vertices.
Geometry sphere(int rings) {
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
      geometry.uv0.push_back({});
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

// The pixels of a sphere's picture inside 0.9 of its radius: r = sin of the view angle, seen orthographically.
TEST(Furnace, ASphereShowsTheAlbedoUnderEveryAngle) {
  constexpr int kPixels = 40;
  constexpr std::size_t kAngles = 24;
  struct Kind {
    float roughness, metallic;
  };
  const std::vector<Kind> kinds{{0.1F, 0}, {0.1F, 1}, {0.35F, 0.5F}, {0.6F, 0}, {0.6F, 1}, {1, 0}, {1, 1}};
  Camera camera;
  camera.pose = look_at({2, 3, 4}, {0, 0, 0}, {0, 1, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 1;
  const SamplingMap map = uniform_map(kPixels, kPixels, 16);
  for (const Kind& kind : kinds) {
    Scene scene;
    scene.materials = {surface_material(kind.metallic, kind.roughness)};
    add_mesh(scene, {sphere(256)});
    scene.environment = constant_environment({1, 1, 1});
    PathTracer tracer(scene, threads(1));

    const ReferenceBsdf reference({to_double(kColor), kind.metallic, kind.roughness, DiffuseModel::burley});
    std::vector<double> albedo;  // at radius 0, 1/n ... 1 of 0.95
    for (std::size_t i = 0; i <= kAngles; ++i) {
      const double radius = 0.95 * static_cast<double>(i) / kAngles;
      albedo.push_back(channel_mean(reference.albedo(std::sqrt(1 - radius * radius))));
    }
    // Mean over the same pixels, each over a 4 x 4 grid of points inside it.
    double expected = 0;
    int pixels = 0;
    const auto inside = [](const Site& site) {
      return std::hypot((site.block_x + 0.5) / kPixels * 2 - 1, (site.block_y + 0.5) / kPixels * 2 - 1) < 0.9;
    };
    for (const Site& site : map.sites) {
      if (!inside(site)) {
        continue;
      }
      ++pixels;
      for (int k = 0; k < 16; ++k) {
        const double x = (site.block_x + (k % 4 + 0.5) / 4) / kPixels * 2 - 1;
        const double y = (site.block_y + (static_cast<double>(k / 4) + 0.5) / 4) / kPixels * 2 - 1;
        const double at = std::hypot(x, y) / 0.95 * kAngles;
        const auto i = static_cast<std::size_t>(at);
        expected += (albedo[i] + (albedo[i + 1] - albedo[i]) * (at - static_cast<double>(i))) / 16;
      }
    }
    expected /= pixels;

    std::vector<double> means;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      TraceSettings settings;
      settings.max_bounces = 1;
      settings.seed = seed;
      const SparseFrame frame = tracer.at_rest().trace(camera, 1, map, settings);
      double sum = 0;
      for (std::size_t i = 0; i < map.sites.size(); ++i) {
        if (inside(map.sites[i])) {
          sum += channel_mean(to_double(frame.sum[i])) / frame.count[i];
        }
      }
      means.push_back(sum / pixels);
    }
    // Angles are interpolated linearly on both sides: second-order terms of the same size as the tables' error.
    const MeanTest result = t_test(means, expected, 2 * kTableError);
    EXPECT_GT(result.p_value, sidak(kinds.size()))
        << "roughness " << kind.roughness << " metallic " << kind.metallic << ": " << result.mean << " +- "
        << result.standard_error << ", expected " << expected;
    EXPECT_LT(result.standard_error, 1e-3) << "too noisy to mean anything";
  }
}

// A white sphere in a white room is invisible, whatever its material and however often light may scatter.
TEST(Furnace, AWhiteSphereIsInvisible) {
  const SamplingMap map = uniform_map(32, 32, 64);
  for (const float roughness : {0.25F, 0.5F, 1.0F}) {
    for (const float metallic : {0.0F, 1.0F}) {
      for (const DiffuseModel diffuse : kModels) {
        Scene scene;
        scene.materials = {surface_material(metallic, roughness, {1, 1, 1})};
        add_mesh(scene, {sphere(128)});
        scene.environment = constant_environment({1, 1, 1});
        PathTracer tracer(scene, threads(1));
        TraceSettings settings;
        settings.diffuse = diffuse;
        const Vec3d mean = mean_radiance(tracer.at_rest().trace(camera_at({2, 3, 4}, {0, 0, 0}, 15), 1, map, settings));
        // The tables' interpolation error (bsdf_furnace_test states 5e-3 for one angle; over all angles it averages
        // out).
        EXPECT_NEAR(mean.y, 1, 2e-3) << roughness << ' ' << metallic << ' ' << static_cast<int>(diffuse);
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::furnace_test
