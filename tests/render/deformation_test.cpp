// SPDX-License-Identifier: Apache-2.0
// Meshes that change their shape from frame to frame and while the shutter is open, as the tracer renders them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/chi2.hpp"
#include "support/picture_evidence.hpp"

namespace gazetrace::deformation_test {
namespace {

using namespace test;

constexpr int kWidth = 64, kHeight = 8, kSeeds = 16;
constexpr std::int64_t kSecond = 1'000'000'000;

// Shows x from -4 to 4 and y from -0.5 to 0.5 at any depth.
Camera flat_camera(double ymag_m = 0.5) {
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = ymag_m;
  return camera;
}

TraceSettings emission_only() {
  TraceSettings settings;
  settings.max_bounces = 0;
  return settings;
}

template <class Pose>
void deform_instance(Scene& scene, std::size_t instance, const Pose& pose_at) {
  Deformation deformation;
  deformation.pose_at = pose_at;
  deformation.rest = pose_at(0);
  scene.instances[instance].deformation = static_cast<std::int32_t>(scene.deformations.size());
  scene.deformations.push_back(deformation);
}

double seconds(std::int64_t t_ns) {
  return static_cast<double>(t_ns) * 1e-9;
}

// An emissive square of half width 1, whose right edge moves out by the first weight of its only target.
Scene widening_square(double weight_per_s) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  Geometry square = quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0);
  MorphTarget wider;
  wider.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  square.morph_targets.push_back(wider);
  add_mesh(scene, {square});
  deform_instance(scene, 0, [=](std::int64_t t) { return MeshPose{{weight_per_s * seconds(t)}, {}}; });
  return scene;
}

std::vector<double> column_means(const SparseFrame& frame, const SamplingMap& map) {
  std::vector<double> sums(static_cast<std::size_t>(map.width_px), 0);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    sums[static_cast<std::size_t>(map.sites[i].block_x)] += static_cast<double>(frame.sum[i].y) / frame.count[i];
  }
  for (double& sum : sums) {
    sum /= map.height_px;
  }
  return sums;
}

TEST(Deformation, AnInstantIsSharpAndWhereItShouldBe) {
  const Scene scene = widening_square(1);
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kWidth, kHeight, 4);
  for (const double t_s : {2.0, 0.0, 0.5, 2.5, 0.5}) {
    const auto t = static_cast<std::int64_t>(t_s * 1e9);
    const PosedScene posed = tracer.at({t, t});
    const auto lit = column_means(posed.trace(flat_camera(), 1, map, emission_only()), map);
    for (int c = 0; c < kWidth; ++c) {
      const double x = (c + 0.5 - kWidth / 2.0) / 8.0;
      EXPECT_EQ(lit[static_cast<std::size_t>(c)], x > -1 && x < 1 + t_s ? 1.0 : 0.0) << t_s << ' ' << x;
    }
  }
}

// Two squares whose fronts shine towards the camera, at x < 0 and x > 0, with a joint each. A joint that mirrors along
// the view keeps the front in front: glTF 2.0, section 3.7.4.
TEST(Deformation, MirroringIsOfEachJoint) {
  const Affine plain;
  const Affine mirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  for (const bool first : {false, true}) {
    Scene scene;
    scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
    const float side = first ? 1.0F : -1.0F;  // of the square whose joint mirrors it, before it does
    Geometry left = quad({{{-3, -1, 0}, {-1, -1, 0}, {-1, 1, 0}, {-3, 1, 0}}}, 0);
    Geometry right = quad({{{side - 1, -1, 0}, {side + 1, -1, 0}, {side + 1, 1, 0}, {side - 1, 1, 0}}}, 0);
    left.influences = {1, {0, 0, 0, 0}, {1, 1, 1, 1}};
    right.influences = {1, {1, 1, 1, 1}, {1, 1, 1, 1}};
    add_mesh(scene, {left, right});
    deform_instance(scene, 0, [=](std::int64_t t) {
      return seconds(t) < 0.5 ? MeshPose{{}, {plain, mirror}} : MeshPose{{}, {mirror, plain}};
    });
    PathTracer tracer(scene, threads(2));
    const SamplingMap map = uniform_map(kWidth, kHeight, 4);
    for (const std::int64_t t : {std::int64_t{0}, kSecond}) {
      const auto lit = column_means(tracer.at({t, t}).trace(flat_camera(), 1, map, emission_only()), map);
      const double turned_left = t == 0 ? 1 : -1;
      const double turned_right = t == 0 ? -side : side;
      for (int c = 0; c < kWidth; ++c) {
        const double x = (c + 0.5 - kWidth / 2.0) / 8.0;
        const bool on_left = std::fabs(x + 2 * turned_left) < 1;
        const bool on_right = std::fabs(x - turned_right) < 1;
        EXPECT_EQ(lit[static_cast<std::size_t>(c)], on_left || on_right ? 1.0 : 0.0) << t << ' ' << x;
      }
    }
  }
}

// Unlit, so that the radiance is the colour of the vertices times that of the texture, of two texels side by side.
TEST(Deformation, ColoursAndTextureCoordinatesMorph) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  scene.materials[0].unlit = true;
  scene.materials[0].base_color_texture.texture = 0;
  Texture texture;
  texture.nearest = true;
  texture.levels = {{2, 1, {255, 255, 255, 255, 0, 255, 255, 255}}};
  scene.textures = {texture};
  Geometry square = quad({{{-4, -1, 0}, {4, -1, 0}, {4, 1, 0}, {-4, 1, 0}}}, 0);
  square.uv0.assign(4, {0.25F, 0.5F});
  square.colors.assign(4, {1, 1, 0.5F, 1});
  MorphTarget darker;
  darker.colors.assign(4, {0, -1, 0, 0});
  MorphTarget beside;
  beside.uv0.assign(4, {0.5F, 0});
  square.morph_targets = {darker, beside};
  add_mesh(scene, {square});
  deform_instance(scene, 0, [](std::int64_t t) {
    return MeshPose{{std::min(seconds(t), 0.75), seconds(t) < 1 ? 0.0 : 1.0}, {}};
  });
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kWidth, kHeight, 1);
  for (const double t_s : {0.25, 2.0, 0.0, 0.5}) {
    const auto t = static_cast<std::int64_t>(t_s * 1e9);
    const Vec3d mean = mean_radiance(tracer.at({t, t}).trace(flat_camera(), 1, map, emission_only()));
    EXPECT_NEAR(mean.x, t_s < 1 ? 1 : 0, 1e-6) << t_s;
    EXPECT_NEAR(mean.y, 1 - std::min(t_s, 0.75), 1e-6) << t_s;
    EXPECT_NEAR(mean.z, 0.5, 1e-6) << t_s;
  }
}

TEST(Deformation, AnEdgeThatMovesWhileTheShutterIsOpenBecomesARamp) {
  const Scene scene = widening_square(2);
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({kSecond / 4, kSecond});  // the edge goes from x = 1.5 to x = 3
  const SamplingMap map = uniform_map(kWidth, kHeight, 64);
  std::vector<std::vector<double>> columns(kWidth);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TraceSettings settings = emission_only();
    settings.seed = seed;
    const auto means = column_means(posed.trace(flat_camera(), 1, map, settings), map);
    for (std::size_t c = 0; c < kWidth; ++c) {
      columns[c].push_back(means[c]);
    }
  }
  for (std::size_t c = 0; c < kWidth; ++c) {
    const double x = (static_cast<double>(c) + 0.5 - kWidth / 2.0) / 8.0;
    const double expected = x < -1 || x > 3 ? 0 : x < 1.5 ? 1 : (3 - x) / 1.5;
    const MeanTest result = t_test(columns[c], expected, 1e-4);
    EXPECT_GT(result.p_value, sidak(kWidth)) << x << ": " << result.mean << " for " << expected;
  }
}

// A small emissive square at 3 m from a joint that turns by 120 degrees, so that its path is not straight.
TEST(Deformation, AJointTurnsItsVerticesOnACircle) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  Geometry spot = quad({{{-0.05F, 2.95F, 0}, {0.05F, 2.95F, 0}, {0.05F, 3.05F, 0}, {-0.05F, 3.05F, 0}}}, 0);
  spot.influences = {1, {0, 0, 0, 0}, {1, 1, 1, 1}};
  add_mesh(scene, {spot});
  deform_instance(scene, 0, [](std::int64_t t) {
    const double angle = 120 * kRadPerDeg * (0.5 - seconds(t));
    return MeshPose{{}, {make_affine({}, {0, 0, std::sin(angle / 2), std::cos(angle / 2)}, {1, 1, 1})}};
  });
  PathTracer tracer(scene, threads(2));
  const PosedScene posed = tracer.at({0, kSecond});
  const SamplingMap map = uniform_map(128, 128, 256);
  const SparseFrame frame = posed.trace(flat_camera(4), 1, map, emission_only());
  double sum = 0, radius = 0, least = 9, most = -9, left = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const double value = static_cast<double>(frame.sum[i].y);
    const double x = (map.sites[i].block_x + 0.5) / 16 - 4;
    const double y = 4 - (map.sites[i].block_y + 0.5) / 16;
    sum += value;
    radius += value * std::hypot(x, y);
    left += x < 0 ? value : 0;
    if (value > 0) {
      least = std::min(least, std::atan2(x, y));
      most = std::max(most, std::atan2(x, y));
    }
  }
  EXPECT_NEAR(radius / sum, 3.0, 0.01);
  EXPECT_NEAR(left / sum, 0.5, 4 * 0.5 / std::sqrt(sum));  // four standard errors of so many samples
  EXPECT_NEAR(most, 60 * kRadPerDeg, 0.03);
  EXPECT_NEAR(least, -60 * kRadPerDeg, 0.03);
}

// A white Lambertian square that a joint turns about y under a sun along -z. Its radiance is cos(angle) / pi, whatever
// normal it has at rest.
TEST(Deformation, NormalsTurnWithTheJoints) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  Geometry square = quad({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 0);
  square.influences = {1, {0, 0, 0, 0}, {1, 1, 1, 1}};
  add_mesh(scene, {square});
  PunctualLight sun;
  sun.kind = LightKind::directional;
  scene.lights = {sun};
  deform_instance(scene, 0, [](std::int64_t t) {
    const double angle = seconds(t);
    return MeshPose{{}, {make_affine({}, {0, std::sin(angle / 2), 0, std::cos(angle / 2)}, {1, 1, 1})}};
  });
  PathTracer tracer(scene, threads(2));
  TraceSettings settings;
  settings.max_bounces = 1;
  settings.diffuse = DiffuseModel::matte;
  const SamplingMap map = uniform_map(8, 8, 16);
  const auto radiance = [&](double open_rad, double close_rad) {
    const PosedScene posed =
        tracer.at({static_cast<std::int64_t>(open_rad * 1e9), static_cast<std::int64_t>(close_rad * 1e9)});
    return mean_radiance(posed.trace(flat_camera(0.25), 1, map, settings)).y;
  };
  for (const double angle : {0.0, 0.5, 1.0}) {
    EXPECT_NEAR(radiance(angle, angle), std::cos(angle) / kPi, 1e-4) << angle;
  }
  // While the shutter is open: the mean of the cosine.
  EXPECT_NEAR(radiance(0.2, 1.0), (std::sin(1.0) - std::sin(0.2)) / 0.8 / kPi, 2e-3);
}

// The picture of a wavy sheet in a shape other than that at rest.
Scene wavy_sheet() {
  constexpr int kSide = 24;
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.5F, 0.3F}), diffuse_material({0.2F, 0.6F, 0.8F})};
  scene.environment = constant_environment({1, 1, 1});
  Geometry sheet;
  MorphTarget wave;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) {
      sheet.positions.push_back(
          {4.0F * static_cast<float>(x) / kSide - 2, 4.0F * static_cast<float>(y) / kSide - 2, 0});
      sheet.normals.push_back({0, 0, 1});
      wave.positions.push_back({0, 0, std::sin(static_cast<float>(x)) * std::cos(0.7F * static_cast<float>(y))});
    }
  }
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = y * (kSide + 1) + x;
      sheet.triangles.push_back({a, a + 1, a + kSide + 2});
      sheet.triangles.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  }
  sheet.morph_targets = {wave};
  add_mesh(scene, {sheet});
  add_mesh(scene, box(0.4F, false, 1), make_affine({0, 0, 1.5}, {}, {1, 1, 1}));
  deform_instance(scene, 0, [](std::int64_t t) { return MeshPose{{seconds(t)}, {}}; });
  return scene;
}

const SamplingMap& sheet_map() {
  static const SamplingMap map = uniform_map(96, 96, 4);
  return map;
}

SparseFrame picture(PathTracer& tracer, const ShutterTimes& times) {
  return tracer.at(times).trace(camera_at({2, 3, 6}, {0, 0, 0}, 40), 1, sheet_map(), TraceSettings{});
}

TEST(Deformation, EveryWayToUpdateTheTreeShowsTheSamePicture) {
  const Scene scene = wavy_sheet();
  TracerOptions options = threads(2);
  for (const ShutterTimes& times : {ShutterTimes{kSecond, kSecond}, ShutterTimes{kSecond / 2, kSecond}}) {
    options.mesh_update = MeshUpdate::rebuild_high;
    PathTracer reference(scene, options);
    const SparseFrame expected = picture(reference, times);
    for (const MeshUpdate update : {MeshUpdate::refit, MeshUpdate::rebuild_low, MeshUpdate::rebuild_medium}) {
      options.mesh_update = update;
      PathTracer tracer(scene, options);
      EXPECT_TRUE(same_samples(picture(tracer, times), expected, sheet_map())) << static_cast<int>(update);
    }
  }
}

TEST(Deformation, APictureDependsOnItsTimeAlone) {
  const Scene scene = wavy_sheet();
  PathTracer tracer(scene, threads(2));
  const SparseFrame first = picture(tracer, {kSecond, kSecond});
  const SparseFrame other = picture(tracer, {kSecond / 3, kSecond / 2});
  EXPECT_NE(first.sum, other.sum);
  EXPECT_TRUE(same_samples(picture(tracer, {kSecond, kSecond}), first, sheet_map()));
  EXPECT_TRUE(same_samples(picture(tracer, {kSecond / 3, kSecond / 2}), other, sheet_map()));
  (void)tracer.at_rest();
  EXPECT_TRUE(same_samples(picture(tracer, {kSecond, kSecond}), first, sheet_map()));
  PathTracer single(scene, threads(1));
  EXPECT_TRUE(same_samples(picture(single, {kSecond / 3, kSecond / 2}), other, sheet_map()));
}

// A mesh that is deformed into a shape gives the same picture as a mesh that was made in that shape.
TEST(Deformation, AShapeLooksLikeAMeshMadeSo) {
  const Scene scene = wavy_sheet();
  PathTracer tracer(scene, threads(2));
  const SparseFrame deformed = picture(tracer, {kSecond, kSecond});
  Scene still = wavy_sheet();
  Geometry& sheet = still.meshes[0].geometries[0];
  sheet.positions = deform(sheet, MeshPose{{1.0}, {}}, {}).positions;
  still.instances[0].deformation = -1;
  still.deformations.clear();
  PathTracer static_tracer(still, threads(2));
  const SparseFrame expected = picture(static_tracer, {0, 0});
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < expected.sum.size(); ++i) {
    difference += std::fabs(static_cast<double>(expected.sum[i].y - deformed.sum[i].y));
    sum += static_cast<double>(expected.sum[i].y);
  }
  EXPECT_LT(difference, 1e-3 * sum);
}

TEST(Deformation, AShapeBeyondNumbersIsAnErrorWithItsPlace) {
  Scene scene = widening_square(1e30);
  PathTracer tracer(scene, threads(1));
  try {
    (void)tracer.at({kSecond, kSecond});
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("vertex 1 is not finite, or beyond 1e18 m"), std::string::npos)
        << error.what();
  }
}

// Two squares under a sun: at one second the first has turned, and the second is nowhere. The normals of the first must
// not stay as they were made before the second was found to be wrong.
TEST(Deformation, AnErrorLeavesNothingOfItsPose) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  std::vector<Geometry> squares;
  for (const std::uint16_t joint : {std::uint16_t{0}, std::uint16_t{1}}) {
    const float x = joint == 0 ? 0.0F : 3.0F;
    squares.push_back(quad({{{x - 1, -1, 0}, {x + 1, -1, 0}, {x + 1, 1, 0}, {x - 1, 1, 0}}}, 0));
    squares.back().influences = {1, {joint, joint, joint, joint}, {1, 1, 1, 1}};
  }
  add_mesh(scene, squares);
  PunctualLight sun;
  sun.kind = LightKind::directional;
  scene.lights = {sun};
  deform_instance(scene, 0, [](std::int64_t t) {
    const double angle = seconds(t);
    return MeshPose{{},
                    {make_affine({}, {0, std::sin(angle / 2), 0, std::cos(angle / 2)}, {1, 1, 1}),
                     make_affine({1e30 * seconds(t), 0, 0}, {}, {1, 1, 1})}};
  });
  TraceSettings settings;
  settings.max_bounces = 1;
  settings.diffuse = DiffuseModel::matte;
  const SamplingMap map = uniform_map(8, 8, 16);
  PathTracer tracer(scene, threads(2));
  EXPECT_THROW((void)tracer.at({kSecond, kSecond}), Error);
  const SparseFrame frame = tracer.at({0, 0}).trace(flat_camera(0.25), 1, map, settings);
  EXPECT_NEAR(mean_radiance(frame).y, 1 / kPi, 1e-4);
}

}  // namespace
}  // namespace gazetrace::deformation_test
