// SPDX-License-Identifier: Apache-2.0
// Objects under the gaze, against a plain loop over all triangles of the shipped scene (Moeller & Trumbore 1997) for
// ten frames of the shipped log, and on a scene whose answer is known by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_objects.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace::gaze_objects_test {
namespace {

struct Ray {
  Vec3d origin, direction;
};

// By the definition of a perspective camera: the middle of the frame lies along -z, its upper edge half a field up.
Ray ray_through(const Camera& camera, int width_px, int height_px, const Vec2d& place) {
  const double up = std::tan(camera.projection.yfov_rad / 2);
  const double across = up * width_px / height_px;
  const Vec3d local{(2 * place.x / width_px - 1) * across, (1 - 2 * place.y / height_px) * up, -1};
  return {camera.pose.position_m, normalize(rotate(camera.pose.orientation, local))};
}

double alpha_of(const Scene& scene, const Material& material, const Geometry& geometry, std::size_t triangle, double u,
                double v) {
  double alpha = material.base_color.w;
  const TextureRef& ref = material.base_color_texture;
  if (ref.texture < 0) {
    return alpha;
  }
  const Texture& texture = scene.textures[static_cast<std::size_t>(ref.texture)];
  const Texture::Level& level = texture.levels.front();
  const auto& corners = geometry.triangles[triangle];
  const auto corner = [&](std::size_t c) { return geometry.uv0[corners[c]]; };
  const double w = 1 - u - v;
  const double s = w * corner(0).x + u * corner(1).x + v * corner(2).x;
  const double t = w * corner(0).y + u * corner(1).y + v * corner(2).y;
  const auto texel = [&](int x, int y) {
    x = (x % level.width_px + level.width_px) % level.width_px;
    y = (y % level.height_px + level.height_px) % level.height_px;
    return level.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width_px) +
                       static_cast<std::size_t>(x)) *
                          4 +
                      3] /
           255.0;
  };
  const double px = s * level.width_px - 0.5;
  const double py = t * level.height_px - 0.5;
  const int x = static_cast<int>(std::floor(px));
  const int y = static_cast<int>(std::floor(py));
  const double fx = px - x;
  const double fy = py - y;
  return alpha * ((texel(x, y) * (1 - fx) + texel(x + 1, y) * fx) * (1 - fy) +
                  (texel(x, y + 1) * (1 - fx) + texel(x + 1, y + 1) * fx) * fy);
}

struct SlowHit {
  double t = std::numeric_limits<double>::infinity();
  std::string node, material;
};

// Every triangle in the world, one after the other.
class SlowScene {
 public:
  explicit SlowScene(const Scene& scene) : scene_(scene) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)];
      for (const Geometry& geometry : mesh.geometries) {
        for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
          std::array<Vec3d, 3> p;
          for (std::size_t c = 0; c < 3; ++c) {
            p[c] =
                transform_point(scene.instances[i].to_world, to_double(geometry.positions[geometry.triangles[t][c]]));
          }
          triangles_.push_back({p[0], p[1] - p[0], p[2] - p[0], &geometry, t, i});
        }
      }
    }
  }
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }

  [[nodiscard]] SlowHit first_hit(const Ray& ray, double near_m) const {
    SlowHit best;
    for (const Triangle& triangle : triangles_) {
      const Vec3d p = cross(ray.direction, triangle.e2);
      const double determinant = dot(triangle.e1, p);
      if (determinant == 0) {
        continue;
      }
      const Vec3d from = ray.origin - triangle.corner;
      const double u = dot(from, p) / determinant;
      if (u < 0 || u > 1) {
        continue;
      }
      const Vec3d q = cross(from, triangle.e1);
      const double v = dot(ray.direction, q) / determinant;
      const double t = dot(triangle.e2, q) / determinant;
      if (v < 0 || u + v > 1 || t <= near_m || t >= best.t) {
        continue;
      }
      const Material& material = scene_.materials[static_cast<std::size_t>(triangle.geometry->material)];
      if (material.alpha_mode == AlphaMode::mask &&
          alpha_of(scene_, material, *triangle.geometry, triangle.index, u, v) < material.alpha_cutoff) {
        continue;
      }
      best = {t, scene_.instances[triangle.instance].node, material.name};
    }
    return best;
  }

 private:
  struct Triangle {
    Vec3d corner, e1, e2;
    const Geometry* geometry;
    std::size_t index, instance;
  };
  const Scene& scene_;
  std::vector<Triangle> triangles_;
};

Job courtyard_job(const std::string& frames) {
  const std::string root = GAZETRACE_SOURCE_DIR;
  Job job;
  job.settings.scene = root + "/scenes/courtyard/courtyard.gltf";
  job.settings.camera = "walk";
  job.settings.gaze.path = root + "/gazelogs/tx300_left.csv";
  job.settings.fps = {10, 1};
  parse_value(frames, "frames", job.settings.frames.emplace());
  job.settings.size = {960, 540};
  return job;
}

TEST(GazeObjects, OfTheCourtyardAreThoseOfASlowRayCast) {
  const Job job = courtyard_job("1-40x4");
  GazeObjectsSettings settings;
  settings.rays = 24;
  settings.uncertainty = {0.5, std::numeric_limits<double>::quiet_NaN()};  // the precision is the log's
  const GazeOnScene seen = look_at_scene(job, settings);
  const Scene scene = load_job_scene(job.settings);
  const SlowScene slow(scene);
  ASSERT_EQ(seen.objects.frames.size(), 10U);
  std::size_t rays = 0;
  std::size_t frames_with_gaze = 0;
  double most_off = 0;
  for (std::size_t k = 0; k < seen.objects.frames.size(); ++k) {
    const FrameRequest& request = seen.resolved.plan.frames[k];
    const FrameObjects& found = seen.objects.frames[k];
    if (found.shares.empty()) {
      continue;
    }
    ++frames_with_gaze;
    std::map<std::pair<std::string, std::string>, double> shares;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Vec3d& direction : gaze_cone(*request.gaze_direction_true, seen.objects.settings.uncertainty, 24)) {
      const Ray ray = ray_through(request.camera, 960, 540, request.view.pixel(direction));
      const SlowHit hit = slow.first_hit(ray, request.camera.projection.near_m);
      shares[{hit.node, hit.material}] += 1.0 / 24;
      nearest_m = std::min(nearest_m, hit.t);
      ++rays;
    }
    for (const ObjectShare& share : found.shares) {
      const SceneObject& object = seen.objects.objects[share.object];
      // Two rays of a frame may fall to the other side of an edge, in single precision.
      EXPECT_NEAR(share.share, (shares[{object.node, object.material}]), 1.01 / 24)
          << "frame " << found.frame << " " << object.node;
      most_off = std::max(most_off, std::abs(share.share - shares[{object.node, object.material}]));
    }
    // The ray in the middle of the cone.
    const Ray middle = ray_through(
        request.camera, 960, 540,
        request.view.pixel(gaze_cone(*request.gaze_direction_true, seen.objects.settings.uncertainty, 24)[0]));
    const SlowHit hit = slow.first_hit(middle, request.camera.projection.near_m);
    for (const ObjectShare& share : found.shares) {
      const SceneObject& object = seen.objects.objects[share.object];
      if (object.node == hit.node && object.material == hit.material && std::isfinite(hit.t)) {
        EXPECT_NEAR(share.distance_m, hit.t, 1e-4 * hit.t) << "frame " << found.frame;
        const Vec3d apart = share.position_m - (middle.origin + middle.direction * hit.t);
        EXPECT_LT(length(apart), 1e-4 * hit.t) << "frame " << found.frame;
      }
    }
  }
  std::printf("%zu frames with gaze, %zu rays, %zu triangles; shares off by %.4f at most\n", frames_with_gaze, rays,
              slow.size(), most_off);
  EXPECT_GE(frames_with_gaze, 8U);
}

TEST(GazeObjects, TheConeHasTheStatedErrors) {
  const GazeUncertainty uncertainty{0.6, 0.0};
  const Vec3d gaze = normalize(Vec3d{0.3, -0.2, -1});
  const std::vector<Vec3d> cone = gaze_cone(gaze, uncertainty, 4096);
  double mean_deg = 0;
  Vec3d middle;
  int inside = 0;
  for (const Vec3d& direction : cone) {
    const double deg = angle_between_rad(direction, gaze) * kDegPerRad;
    mean_deg += deg / 4096;
    middle += direction * (1.0 / 4096);
    inside += deg <= gaze_cone_95_deg(uncertainty) ? 1 : 0;
  }
  EXPECT_NEAR(mean_deg, 0.6, 0.002);  // accuracy is the mean distance
  EXPECT_NEAR(inside / 4096.0, 0.95, 0.001);
  EXPECT_LT(angle_between_rad(middle, gaze) * kDegPerRad, 0.005);
  // Precision alone is a root mean square distance.
  double squares = 0;
  for (const Vec3d& direction : gaze_cone(gaze, {0, 0.4}, 4096)) {
    const double deg = angle_between_rad(direction, gaze) * kDegPerRad;
    squares += deg * deg / 4096;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.4, 0.002);
}

TEST(GazeObjects, ABorderInTheMiddleHalvesTheCone) {
  // Two walls 2 m ahead that meet at x = 0, and a small board far to the right.
  Scene scene;
  const auto add = [&](const std::string& name, float left, float right, float z) {
    Geometry geometry;
    geometry.positions = {{left, -5, z}, {right, -5, z}, {right, 5, z}, {left, 5, z}};
    geometry.normals.assign(4, {0, 0, 1});
    geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
    geometry.material = static_cast<std::int32_t>(scene.materials.size());
    scene.meshes.push_back({name, {geometry}});
    scene.materials.emplace_back();
    scene.materials.back().name = name + " paint";
    scene.instances.push_back({static_cast<std::int32_t>(scene.meshes.size()) - 1, {}, -1, -1, name});
  };
  add("left", -5, 0, -2);
  add("right", 0, 5, -2);
  add("board", 0.5F, 0.6F, -1.5F);
  GazeLog log;
  log.kind = GazeKind::direction;
  log.samples.resize(1);
  log.samples[0].direction = {0, 0, -1};
  log.source = "hand";
  PlanSettings plan;
  plan.frames = {1};
  plan.find_events = false;
  Projection projection;
  projection.yfov_rad = 60 * kRadPerDeg;
  const FramePlan frames = plan_frames(static_camera({}, projection), &log, plan);
  PathTracer tracer(scene, {});
  GazeObjectsSettings settings;
  settings.uncertainty = {1, 0.2};
  const GazeObjects objects = gaze_objects(tracer, scene, frames, settings);
  ASSERT_EQ(objects.frames.size(), 1U);
  const FrameObjects& found = objects.frames[0];
  ASSERT_EQ(found.shares.size(), 2U);
  EXPECT_NEAR(found.shares[0].share, 0.5, 0.02);
  EXPECT_NEAR(found.shares[0].distance_m, 2, 0.01);
  ASSERT_EQ(found.nearest.size(), 3U);
  EXPECT_EQ(objects.objects[found.nearest[2].object].node, "board");
  EXPECT_EQ(objects.objects[found.nearest[2].object].material, "board paint");
  EXPECT_NEAR(found.nearest[2].eccentricity_deg, std::atan(0.5 / 1.5) * kDegPerRad, objects.grid_deg);
  EXPECT_NE(objects_as_tsv(objects).find("replayed"), std::string::npos);

  // As AOIs: neither wall holds more than half of the cone, the two together do.
  EyeEvents events;
  events.events.resize(1);
  events.events[0].movement = EyeMovement::fixation;
  events.events[0].end_ns = 1'000'000'000;
  const AoiAnalysis apart =
      analyse_aois(log, events, {{"l", AoiShape::object, {}, "left", ""}}, std::nullopt, &objects);
  EXPECT_FALSE(apart.fixations[0].aoi);
  const AoiAnalysis walls =
      analyse_aois(log, events, {{"walls", AoiShape::object, {}, "*t", ""}}, std::nullopt, &objects);
  ASSERT_TRUE(walls.fixations[0].aoi);
  EXPECT_NEAR(walls.fixations[0].share, 1, 1e-9);
}

}  // namespace
}  // namespace gazetrace::gaze_objects_test
