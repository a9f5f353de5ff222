// SPDX-License-Identifier: Apache-2.0
// Chooses one light among many by a bound on what each can contribute to a point: a tree of bounds on position,
// direction and power, traversed from the root with one random number. After Conty Estevez and Kulla, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting" (2018): the bound is that of section 4.1 (their figure 5),
// nodes are split as in section 4.2 (surface area orientation heuristic). Their splitting at run time is not used,
// since one light is taken per point. Nodes have eight children instead of two, so that eight bounds are computed at
// once and there are fewer levels.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Bounds of one light or of several.
struct LightBounds {
  Vec3d low, high;                                           // bounding box, m
  Vec3d axis{0, 0, 1};                                       // unit axis of a cone that contains all normals
  double normals_rad = 0;                                    // half angle of that cone
  double emission_rad = kPi / 2;                             // largest angle from its normal at which a light emits
  double intensity = 0;                                      // W/sr at the brightest; 0: never chosen
  double reach_m = std::numeric_limits<double>::infinity();  // no light arrives beyond this distance
  bool two_sided = false;                                    // emits along -axis, too
};

// The smallest bounds that are known to contain both.
LightBounds join(const LightBounds& a, const LightBounds& b);

class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(const std::vector<LightBounds>& lights);

  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }

  struct Choice {
    std::uint32_t light = 0;
    float probability = 0;  // 0: no light was found that can reach the point
  };
  // With a `normal` only lights above its horizon count; with a zero normal all do. u is in [0, 1).
  [[nodiscard]] Choice choose(const Vec3f& position, const Vec3f& normal, double u) const noexcept;
  // The probability with which choose() returns this light.
  [[nodiscard]] float probability(std::uint32_t light, const Vec3f& position, const Vec3f& normal) const noexcept;

 private:
  static constexpr std::size_t kWidth = 8;
  static constexpr std::uint32_t kLeaf = 0x80000000U;
  static constexpr std::uint32_t kNone = 0xffffffffU;
  struct alignas(32) Lanes {
    float data[kWidth];
    float& operator[](std::size_t i) { return data[i]; }
    const float& operator[](std::size_t i) const { return data[i]; }
  };

  // The values of all children are stored as arrays. Positions are relative to the root's centre in units of its
  // radius, and intensities relative to the total, so that nothing overflows or underflows at any scale of scene or
  // light.
  struct alignas(64) Node {
    Lanes x, y, z, radius_squared;
    Lanes axis_x, axis_y, axis_z, two_sided;
    Lanes cos_normals, sin_normals, cos_emission;
    Lanes intensity, reach;
    std::array<std::uint32_t, kWidth> child;  // index of a node, or light | kLeaf
    std::uint32_t parent = kNone;             // parent node * kWidth + lane in it
  };
  struct Point {
    float x, y, z;
    Vec3f normal;
    float least_received;  // 1 without a normal, else 0
  };
  struct Builder;

  [[nodiscard]] Point point_of(const Vec3f& position, const Vec3f& normal) const noexcept;
  static Lanes importance(const Node& node, const Point& point) noexcept;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> place_;  // node * kWidth + lane of each light, or kNone
  Vec3f center_;
  float scale_ = 1;
};

}  // namespace gazetrace
