// SPDX-License-Identifier: Apache-2.0
// Tests that the sampled directions of materials with extensions follow their density, for lobes of any width.
// Directions above the surface are represented by the half-vector of reflection, directions below by that of refraction
// (or of the mirrored reflection, for sheets). Cells are in coordinates in which the narrowest lobe's distribution of
// normals is uniform or, where surfaces are far smoother in one direction than in the other, in logarithms of slopes,
// which resolve narrow and broad lobes alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/hash.hpp"
#include "material/layered_bsdf.hpp"
#include "support/chi2.hpp"
#include "support/layered_kinds.hpp"
#include "support/reference_bsdf.hpp"

namespace gazetrace::layered_bsdf_chi2_test {
namespace {

using Model = LayeredBsdf;

constexpr int kSide = 12;  // cells along each axis, on either side of the surface
constexpr std::size_t kCells = std::size_t{kSide} * kSide;
constexpr std::uint32_t kSamples = 40000;

// The half-vector distribution of the coordinates, stretched along x as the surface is.
struct Coordinates {
  double ax, ay;
  bool solid;
  double eta;

  [[nodiscard]] Vec3d normal_at(double odds, double turns) const {
    const double r = std::sqrt(odds);
    return normalize(Vec3d{ax * r * std::cos(2 * kPi * turns), ay * r * std::sin(2 * kPi * turns), 1});
  }
  // xi / (1 - xi), and the azimuth in turns, of a normal.
  void place(const Vec3d& h, double& xi, double& turns) const {
    const double x = h.x / (ax * h.z);
    const double y = h.y / (ay * h.z);
    const double odds = x * x + y * y;
    xi = odds / (1 + odds);
    turns = std::atan2(y, x) / (2 * kPi);
    turns -= std::floor(turns);
  }
  // The solid angle of h per area of the unit square: 1 / (D(h) h.z) for this GGX distribution.
  [[nodiscard]] double solid_angle(const Vec3d& h) const {
    const double x = h.x / ax;
    const double y = h.y / ay;
    const double t = x * x + y * y + h.z * h.z;
    return kPi * ax * ay * t * t / h.z;
  }
  // The direction that h represents, and its solid angle relative to that of h; false where there is none.
  [[nodiscard]] bool direction(const Vec3d& o, const Vec3d& h, bool through, Vec3d& wi, double& stretch) const {
    const double oh = dot(o, h);
    if (oh <= 0) {
      return false;
    }
    if (through && solid) {
      const double sin2 = (1 - oh * oh) / (eta * eta);
      if (sin2 >= 1) {
        return false;
      }
      const double ih = -std::sqrt(1 - sin2);
      wi = h * (oh / eta + ih) - o / eta;
      stretch = std::pow(oh + eta * ih, 2) / (eta * eta * -ih);
      return wi.z < 0;
    }
    wi = h * (2 * oh) - o;
    stretch = 4 * oh;
    const bool above = wi.z > 0;
    wi.z = through ? -wi.z : wi.z;
    return above;
  }
  // The normal that represents a direction; false where there is none.
  [[nodiscard]] bool normal(const Vec3d& o, const Vec3d& wi, Vec3d& h) const {
    const bool through = wi.z < 0;
    if (through && solid) {
      h = normalize(o + wi * eta);
      h = h.z < 0 ? -h : h;
      return dot(o, h) > 0 && dot(wi, h) < 0;
    }
    h = normalize(o + Vec3d{wi.x, wi.y, std::fabs(wi.z)});
    return true;
  }
};

// Slopes along x and y relative to the alphas, as asinh(slope / alpha), in cells that widen outwards.
struct SlopeGrid {
  static constexpr std::array<double, kSide + 1> kEdges{-20, -6, -3, -1.6, -0.9, -0.4, 0, 0.4, 0.9, 1.6, 3, 6, 20};
  double ax, ay;

  [[nodiscard]] static std::size_t cell(double at) {
    const auto above = std::upper_bound(kEdges.begin() + 1, kEdges.end() - 1, at);
    return static_cast<std::size_t>(above - kEdges.begin()) - 1;
  }
  // The cells of a normal along x and y.
  void place(const Vec3d& h, std::size_t& x, std::size_t& y) const {
    x = cell(std::asinh(h.x / (ax * h.z)));
    y = cell(std::asinh(h.y / (ay * h.z)));
  }
  [[nodiscard]] double probability(const Model& bsdf, const Coordinates& map, const Vec3d& o, bool through,
                                   std::size_t x, std::size_t y, double fineness, bool& whole) const {
    const double wide = kEdges[x + 1] - kEdges[x];
    const double high = kEdges[y + 1] - kEdges[y];
    const int columns = static_cast<int>(std::ceil(std::max(8.0, wide * fineness)));
    const int rows = static_cast<int>(std::ceil(std::max(8.0, high * fineness)));
    double sum = 0;
    for (int j = 0; j < columns; ++j) {
      const double slope_x = ax * std::sinh(kEdges[x] + wide * (j + 0.5) / columns);
      for (int k = 0; k < rows; ++k) {
        const double slope_y = ay * std::sinh(kEdges[y] + high * (k + 0.5) / rows);
        const Vec3d h = normalize(Vec3d{slope_x, slope_y, 1});
        Vec3d wi;
        double stretch = 0;
        if (!map.direction(o, h, through, wi, stretch)) {
          whole = false;
          continue;
        }
        const double solid_angle = h.z * h.z * h.z * std::hypot(ax, slope_x) * std::hypot(ay, slope_y);
        sum += static_cast<double>(bsdf.evaluate(to_float(wi)).pdf) * stretch * solid_angle;
      }
    }
    return sum * wide * high / (static_cast<double>(columns) * rows);
  }
};

// By the midpoint rule with `n` points in azimuth. `whole` becomes false where part of the cell is no possible
// direction.
double cell_probability(const Model& bsdf, const Coordinates& map, const Vec3d& o, bool through, int x, int y, int n,
                        bool& whole) {
  // Broad lobes crowd at xi = 1, more closely the narrower the coordinates are, so the last column is integrated over
  // log(1 - xi), in 192 steps. A step is made of shorter ones only where its ends say that the horizon passes through.
  const bool last = x == kSide - 1;
  const int steps = last ? 24 * 8 : n;
  const int shorter = last ? n / 8 : 1;
  const auto rest_at = [&](double at) { return last ? std::exp(-40 * at) / kSide : 1 - (x + at) / kSide; };
  const auto find = [&](double rest, double turns, Vec3d& h, Vec3d& wi, double& stretch) {
    h = map.normal_at((1 - rest) / rest, turns);
    return map.direction(o, h, through, wi, stretch);
  };
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double turns = (y + (k + 0.5) / n) / kSide;
    const auto density = [&](double at) {
      const double rest = rest_at(at);
      Vec3d h;
      Vec3d wi;
      double stretch = 0;
      if (!find(rest, turns, h, wi, stretch)) {
        whole = false;
        return 0.0;
      }
      const double weight = last ? 40 * rest : 1.0 / kSide;
      return static_cast<double>(bsdf.evaluate(to_float(wi)).pdf) * stretch * map.solid_angle(h) * weight;
    };
    const auto is_possible = [&](double at) {
      Vec3d h;
      Vec3d wi;
      double stretch = 0;
      return find(rest_at(at), turns, h, wi, stretch);
    };
    bool possible = shorter > 1 && is_possible(0);
    for (int j = 0; j < steps; ++j) {
      const bool before = possible;
      possible = shorter > 1 && is_possible((j + 1.0) / steps);
      const int parts = possible == before ? 1 : shorter;
      for (int i = 0; i < parts; ++i) {
        sum += density((j + (i + 0.5) / parts) / steps) / parts;
      }
    }
  }
  return sum / (static_cast<double>(n) * steps * kSide);
}

test::Chi2 run(const LayeredSurface& s, double mu, std::uint64_t seed) {
  const double sine = std::sqrt(1 - mu * mu);
  const Vec3d o{0.8 * sine, 0.6 * sine, mu};
  const Model bsdf(s, to_float(o));
  Coordinates map{};
  const double alpha = std::max(double{s.base.roughness} * double{s.base.roughness}, test::kReferenceAlphaMin);
  map.ax = alpha + (1 - alpha) * double{s.anisotropy} * double{s.anisotropy};
  map.ay = alpha;
  if (s.clearcoat > 0 && s.clearcoat_roughness < s.base.roughness) {
    map.ax = map.ay = std::max(double{s.clearcoat_roughness} * double{s.clearcoat_roughness}, test::kReferenceAlphaMin);
  }
  // Coordinates stretched a thousandfold cannot resolve a broad lobe beside the narrow one.
  const bool by_slopes = s.anisotropy > 0 && s.base.roughness < 0.1F;
  SlopeGrid grid{map.ax, map.ay};
  if (s.clearcoat > 0) {
    const double coat =
        std::max(double{s.clearcoat_roughness} * double{s.clearcoat_roughness}, test::kReferenceAlphaMin);
    grid = {std::min(grid.ax, coat), std::min(grid.ay, coat)};
  }
  map.solid = s.solid;
  map.eta = s.solid ? (s.inside ? 1 / double{s.ior} : double{s.ior}) : 1;

  std::vector<double> observed(2 * kCells + 1);
  std::uint64_t state = hash64(seed);
  const auto random = [&state] {
    state += 0x9e3779b97f4a7c15ULL;
    return static_cast<float>(hash64(state) >> 40U) * 0x1p-24F;
  };
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const Vec2f u{random(), random()};
    const BsdfSample chosen = bsdf.sample(u, random());
    Vec3d h;
    if (!chosen.valid || !map.normal(o, to_double(chosen.direction), h)) {
      observed.back() += 1;
      continue;
    }
    std::size_t x = 0;
    std::size_t y = 0;
    if (by_slopes) {
      grid.place(h, x, y);
    } else {
      double xi = 0;
      double turns = 0;
      map.place(h, xi, turns);
      x = std::min(static_cast<std::size_t>(xi * kSide), std::size_t{kSide - 1});
      y = std::min(static_cast<std::size_t>(turns * kSide), std::size_t{kSide - 1});
    }
    observed[(chosen.direction.z < 0 ? kCells : 0) + y * kSide + x] += 1;
  }
  std::vector<double> expected(observed.size());
  double sum = 0;
  for (const bool through : {false, true}) {
    if (through && !bsdf.transmits()) {
      continue;
    }
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        bool whole = true;
        double cell = 0;
        if (by_slopes) {
          const auto cell_x = static_cast<std::size_t>(x);
          const auto cell_y = static_cast<std::size_t>(y);
          cell = grid.probability(bsdf, map, o, through, cell_x, cell_y, 5, whole);
          if (!whole) {
            cell = grid.probability(bsdf, map, o, through, cell_x, cell_y, 32, whole);
          }
        } else {
          cell = cell_probability(bsdf, map, o, through, x, y, 8, whole);
        }
        if (!by_slopes && !whole) {  // the horizon or, from inside, the critical angle passes through the cell
          cell = cell_probability(bsdf, map, o, through, x, y, s.inside ? 96 : 32, whole);
        }
        expected[(through ? kCells : 0) + static_cast<std::size_t>(y * kSide + x)] = cell * kSamples;
        sum += cell;
      }
    }
  }
  EXPECT_LE(sum, 1.01);
  expected.back() = std::max(1 - sum, 0.0) * kSamples;
  return test::chi2_test(observed, expected);
}

// All comparisons share a family-wise level of 1e-3.
TEST(LayeredBsdfSampling, FollowsItsDensity) {
  constexpr std::array kRoughness{0.0F, 1e-4F, 0.01F, 0.3F, 1.0F};
  constexpr std::array kMetalness{0.0F, 0.5F, 1.0F};
  constexpr std::array kCosines{0.02, 0.4, 0.98};
  const std::size_t kinds = test::layered_kinds(0.5F, 0).size();
  const double level = test::sidak(kinds * kRoughness.size() * kMetalness.size() * kCosines.size());
  std::uint64_t seed = 5000;
  for (const float roughness : kRoughness) {
    for (const float metallic : kMetalness) {
      for (const test::LayeredKind& kind : test::layered_kinds(roughness, metallic)) {
        for (const double mu : kCosines) {
          const test::Chi2 result = run(kind.surface, mu, ++seed);
          EXPECT_GT(result.p_value, level)
              << kind.name << " roughness " << roughness << " metallic " << metallic << " cosine " << mu << ": chi2 "
              << result.statistic << " of " << result.degrees << " degrees";
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::layered_bsdf_chi2_test
