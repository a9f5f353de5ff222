// SPDX-License-Identifier: Apache-2.0
// Choice of one light among many by what each may do to a point: a tree of bounds on position, direction and power,
// walked from the root by one random number. Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive
// Tree Splitting" (2018): the bound of section 4.1 (their figure 5), the split by section 4.2 (surface area orientation
// heuristic). One light is taken per point, so their splitting at run time has no place here. Nodes have eight children
// instead of two: the bounds of eight are computed together, and fewer levels stand between a point and a light.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// One light, or several.
struct LightBounds {
  Vec3d low, high;                                           // box of its points, m
  Vec3d axis{0, 0, 1};                                       // unit; of a cone that holds all normals
  double normals_rad = 0;                                    // that cone's half angle
  double emission_rad = kPi / 2;                             // how far from its normal a light still shines
  double intensity = 0;                                      // W/sr at the brightest; 0: never chosen
  double reach_m = std::numeric_limits<double>::infinity();  // black from there on
  bool two_sided = false;                                    // shines along -axis, too
};

// The smallest bounds known to hold both.
LightBounds join(const LightBounds& a, const LightBounds& b);

class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(const std::vector<LightBounds>& lights);

  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }

  struct Choice {
    std::uint32_t light = 0;
    float probability = 0;  // 0: no light was found that may reach the point
  };
  // `normal`: only what lies above its horizon counts; zero: everything counts. u in [0, 1).
  [[nodiscard]] Choice choose(const Vec3f& position, const Vec3f& normal, double u) const noexcept;
  // That choose() returns this light.
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

  // Children side by side. Lengths are in units of the root's radius, from its centre, and intensities in shares of the
  // whole: nothing over- or underflows at any scale of scene or light.
  struct alignas(64) Node {
    Lanes x, y, z, radius_squared;
    Lanes axis_x, axis_y, axis_z, two_sided;
    Lanes cos_normals, sin_normals, cos_emission;
    Lanes intensity, reach;
    std::array<std::uint32_t, kWidth> child;  // node, or light | kLeaf
    std::uint32_t parent = kNone;             // parent node * kWidth + lane
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
  std::vector<std::uint32_t> place_;  // of each light: node * kWidth + lane; kNone
  Vec3f center_;
  float scale_ = 1;
};

}  // namespace gazetrace
