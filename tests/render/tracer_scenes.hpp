// SPDX-License-Identifier: Apache-2.0
// Scenes built by hand for the tracer's tests, and the small steps every such test takes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace::test {

// Four corners, counter-clockwise as seen from the front.
inline Geometry quad(const std::array<Vec3f, 4>& corners, std::int32_t material) {
  Geometry geometry;
  geometry.positions.assign(corners.begin(), corners.end());
  const Vec3d n =
      normalize(cross(to_double(corners[1]) - to_double(corners[0]), to_double(corners[2]) - to_double(corners[0])));
  geometry.normals.assign(4, to_float(n));
  geometry.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
  geometry.material = material;
  return geometry;
}

// The six faces of [-h, h]^3; `inward`: their fronts face the inside.
inline std::vector<Geometry> box(float h, bool inward, std::int32_t material) {
  std::vector<Geometry> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-h, h}) {
      const auto corner = [&](float a, float b) {
        std::array<float, 3> c{};
        c[static_cast<std::size_t>(axis)] = side;
        c[static_cast<std::size_t>((axis + 1) % 3)] = a;
        c[static_cast<std::size_t>((axis + 2) % 3)] = b;
        return Vec3f{c[0], c[1], c[2]};
      };
      std::array<Vec3f, 4> corners{corner(-h, -h), corner(h, -h), corner(h, h), corner(-h, h)};
      if ((side > 0) == inward) {
        std::swap(corners[1], corners[3]);
      }
      faces.push_back(quad(corners, material));
    }
  }
  return faces;
}

inline Material diffuse_material(const Vec3f& color, const Vec3f& emission = {}) {
  Material material;
  material.base_color = {color.x, color.y, color.z, 1};
  material.metallic = 0;
  material.roughness = 1;
  material.emission = emission;
  return material;
}

inline void add_mesh(Scene& scene, std::vector<Geometry> geometries, const Affine& to_world = {}) {
  scene.meshes.push_back({"", std::move(geometries)});
  scene.instances.push_back({static_cast<std::int32_t>(scene.meshes.size() - 1), to_world});
}

inline Camera camera_at(const Vec3d& eye, const Vec3d& target, double yfov_deg = 50) {
  Camera camera;
  camera.pose = look_at(eye, target, {0, 1, 0});
  camera.projection.yfov_rad = yfov_deg * kRadPerDeg;
  return camera;
}

// A frame of a camera_at() with its default field of view.
inline FrameRequest frame_request(std::int32_t frame, const Camera& camera, int width_px, int height_px) {
  FrameRequest request;
  request.frame = frame;
  request.width_px = width_px;
  request.height_px = height_px;
  request.camera = camera;
  request.view = view_of_perspective(50 * kRadPerDeg, width_px, height_px);
  return request;
}

inline SamplingMap uniform_map(int width_px, int height_px, std::uint32_t spp) {
  FoveationSettings settings;
  settings.spp = spp;
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, width_px, height_px), {});
}

// Mean radiance over all samples of a frame.
inline Vec3d mean_radiance(const SparseFrame& frame) {
  Vec3d sum;
  double count = 0;
  for (std::size_t i = 0; i < frame.sum.size(); ++i) {
    sum += to_double(frame.sum[i]);
    count += frame.count[i];
  }
  return sum / count;
}

inline TracerOptions threads(int count) {
  TracerOptions options;
  options.threads = count;
  return options;
}

}  // namespace gazetrace::test
