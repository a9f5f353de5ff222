// SPDX-License-Identifier: Apache-2.0
// A made scene of blocks under any number of small lights.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hash.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace::benchmark {

class Random {
 public:
  float operator()(float low, float high) {
    state_ += 0x9e3779b97f4a7c15ULL;
    return low + (high - low) * static_cast<float>(hash64(state_) >> 40U) * 0x1p-24F;
  }

 private:
  std::uint64_t state_ = 1;
};

inline void add_box(Geometry& geometry, const Vec3f& low, const Vec3f& high) {
  const auto first = static_cast<std::uint32_t>(geometry.positions.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    geometry.positions.push_back({(corner & 1U) != 0 ? high.x : low.x, (corner & 2U) != 0 ? high.y : low.y,
                                  (corner & 4U) != 0 ? high.z : low.z});
  }
  constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : kFaces) {
    geometry.triangles.push_back({first + face[0], first + face[1], first + face[2]});
    geometry.triangles.push_back({first + face[0], first + face[2], first + face[3]});
  }
}

// 40 x 40 m with 60 blocks; the lights hang between 0.3 and 6 m, all of them together of the same power whatever their
// number.
inline Scene city(int lights, bool punctual) {
  Scene scene;
  Material gray;
  gray.base_color = {0.6F, 0.6F, 0.6F, 1};
  gray.metallic = 0;
  gray.roughness = 0.7F;
  scene.materials.push_back(gray);
  Geometry blocks;
  add_box(blocks, {-20, -0.1F, -20}, {20, 0, 20});
  Random random;
  for (int i = 0; i < 60; ++i) {
    const Vec3f at{random(-19, 19), 0, random(-19, 19)};
    add_box(blocks, at, at + Vec3f{random(0.5F, 2), random(0.5F, 4), random(0.5F, 2)});
  }
  scene.meshes.push_back({"", {blocks}});
  for (int i = 0; i < lights; ++i) {
    const Vec3f at{random(-20, 20), random(0.3F, 6), random(-20, 20)};
    const float strength = 3000.0F / static_cast<float>(lights) * std::pow(100.0F, random(-0.5F, 0.5F));
    const Vec3f color{strength * random(0.5F, 1), strength * random(0.5F, 1), strength * random(0.5F, 1)};
    if (punctual) {
      PunctualLight light;
      light.kind = i % 2 == 0 ? LightKind::point : LightKind::spot;
      light.position_m = to_double(at);
      light.intensity = color * 0.02F;
      light.direction = {random(-1, 1), -1, random(-1, 1)};
      scene.lights.push_back(light);
      continue;
    }
    // One of 16 materials, so that a light is a triangle and not a mesh with a material of its own.
    if (i < 16) {
      Material shining = gray;
      shining.emission = color * 40.0F;
      scene.materials.push_back(shining);
      scene.meshes[0].geometries.emplace_back().material = i + 1;
    }
    Geometry& geometry = scene.meshes[0].geometries[1 + static_cast<std::size_t>(i % 16)];
    const auto first = static_cast<std::uint32_t>(geometry.positions.size());
    const auto side = [&] { return Vec3f{random(-0.1F, 0.1F), random(-0.1F, 0.1F), random(-0.1F, 0.1F)}; };
    geometry.positions.insert(geometry.positions.end(), {at, at + side(), at + side()});
    geometry.triangles.push_back({first, first + 1, first + 2});
  }
  scene.instances = {{0, {}}};
  return scene;
}

}  // namespace gazetrace::benchmark
