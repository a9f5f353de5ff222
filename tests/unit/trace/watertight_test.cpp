// SPDX-License-Identifier: Apache-2.0
// No ray slips between triangles that share an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "trace/rays/embree.hpp"

namespace gazetrace::watertight_test {
namespace {

constexpr int kSpokes = 97;
constexpr std::array<double, 3> kRadii{1, 7, 31};

Vec3f on_ring(int spoke, double radius) {
  const double angle = 2 * 3.14159265358979323846 * spoke / kSpokes;
  return {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), 0};
}

// A ring in two bands of two triangles a spoke: every inner edge belongs to two triangles.
RayGeometry ring() {
  RayGeometry ring;
  for (const double radius : kRadii) {
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      ring.positions.push_back(on_ring(spoke, radius));
    }
  }
  for (std::uint32_t band = 0; band + 1 < kRadii.size(); ++band) {
    for (std::uint32_t spoke = 0; spoke < kSpokes; ++spoke) {
      const std::uint32_t next = (spoke + 1) % kSpokes;
      const std::uint32_t inner = band * kSpokes;
      const std::uint32_t outer = inner + kSpokes;
      ring.triangles.push_back({inner + spoke, outer + spoke, outer + next});
      ring.triangles.push_back({inner + spoke, outer + next, inner + next});
    }
  }
  return ring;
}

// Points of all edges but the ring's borders, as near as float tells them.
std::vector<Vec3f> points_of_edges(const RayGeometry& of) {
  std::vector<Vec3f> points;
  const auto along = [&](std::uint32_t from, std::uint32_t to) {
    constexpr int kPoints = 64;
    for (int i = 1; i < kPoints; ++i) {
      const float share = static_cast<float>(i) / kPoints;
      points.push_back((1 - share) * of.positions[from] + share * of.positions[to]);
    }
  };
  for (std::uint32_t spoke = 0; spoke < kSpokes; ++spoke) {
    const std::uint32_t next = (spoke + 1) % kSpokes;
    along(spoke, kSpokes + spoke);                // radial
    along(kSpokes + spoke, 2 * kSpokes + spoke);  // radial
    along(kSpokes + spoke, kSpokes + next);       // between the bands
    along(spoke, kSpokes + next);                 // diagonal
    along(kSpokes + spoke, 2 * kSpokes + next);   // diagonal
  }
  return points;
}

int rays_that_miss(const RayScene& scene, const std::vector<Vec3f>& targets, const Vec3f& eye, RayShape shape) {
  const auto rays = std::make_unique<RayBatch>();
  const auto hits = std::make_unique<HitBatch>();
  int missed = 0;
  for (std::size_t begin = 0; begin < targets.size(); begin += kBatchSize) {
    const std::size_t count = std::min<std::size_t>(kBatchSize, targets.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f direction = normalize(targets[begin + i] - eye);
      rays->ox[i] = eye.x;
      rays->oy[i] = eye.y;
      rays->oz[i] = eye.z;
      rays->dx[i] = direction.x;
      rays->dy[i] = direction.y;
      rays->dz[i] = direction.z;
      rays->tnear[i] = 0;
      rays->tfar[i] = 1000;
      rays->alpha_key[i] = 0;
      rays->time[i] = 0;
    }
    scene.intersect(*rays, static_cast<int>(count), shape, *hits);
    for (std::size_t i = 0; i < count; ++i) {
      missed += hits->t[i] < 1000 ? 0 : 1;
    }
  }
  return missed;
}

TEST(RayScene, RaysThroughSharedEdgesHit) {
  RayScene scene(1, nullptr);
  const RayGeometry geometry = ring();
  scene.add_geometry(geometry);
  scene.commit();
  const std::vector<Vec3f> targets = points_of_edges(geometry);
  for (const RayShape shape : {RayShape::single, RayShape::packet, RayShape::coherent_packet}) {
    EXPECT_EQ(rays_that_miss(scene, targets, {0.3F, -0.7F, 40}, shape), 0) << static_cast<int>(shape);
    EXPECT_EQ(rays_that_miss(scene, targets, {-90, 13, 2}, shape), 0) << static_cast<int>(shape);
  }
}

TEST(RayScene, RaysThroughSharedEdgesOfInstancesHit) {
  const RayGeometry geometry = ring();
  const std::vector<Vec3f> targets = points_of_edges(geometry);
  const RayTransform as_it_is{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  for (const MeshUpdate update : {MeshUpdate::refit, MeshUpdate::rebuild_low, MeshUpdate::rebuild_high}) {
    RayScene scene(1, nullptr);
    scene.add_instance(scene.add_deforming_mesh({geometry}, update), as_it_is);
    scene.commit();
    for (const RayShape shape : {RayShape::single, RayShape::packet, RayShape::coherent_packet}) {
      EXPECT_EQ(rays_that_miss(scene, targets, {0.3F, -0.7F, 40}, shape), 0) << static_cast<int>(shape);
    }
  }
}

}  // namespace
}  // namespace gazetrace::watertight_test
