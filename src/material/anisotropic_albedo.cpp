// SPDX-License-Identifier: Apache-2.0
#include "material/lobes/anisotropic_albedo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gazetrace/math.hpp"

namespace gazetrace {
namespace {

using Table = AnisotropicAlbedo;

double fraction_of(std::size_t k, std::size_t count) {
  return static_cast<double>(k) / static_cast<double>(count - 1);
}

double alpha_at(std::size_t k, std::size_t count) {
  const double least = std::sqrt(kAlphaMin);
  const double root = least + (1 - least) * fraction_of(k, count);
  return root * root;
}

struct FacetMeans {
  double e, cosine;
};

// Midpoint rule over the sample square of visible normals, as in generate_albedo_tables.cpp.
class FacetQuadrature {
 public:
  FacetQuadrature() {
    for (std::size_t i = 0; i < kTurns; ++i) {
      circle_[i] = cos_sin_2pi((static_cast<double>(i) + 0.5) / kTurns);
    }
    for (std::size_t j = 0; j < kRings; ++j) {
      const double t = (static_cast<double>(j) + 0.5) / kRings;
      ring_[j] = t * t * t * (10 - 15 * t + 6 * t * t);
      weight_[j] = 30 * t * t * (1 - t) * (1 - t) / (kTurns * kRings);
    }
  }

  // m and w give the direction, see the header. This is sample_visible_normal(), written out for many normals of one
  // view.
  [[nodiscard]] FacetMeans means(const GgxAlpha<double>& alpha, double m, double w) const {
    const double sine = std::sqrt(1 - m * m);
    const Vec3d s{sine * std::sqrt(1 - w), sine * std::sqrt(w), m};
    const Vec3d wo = normalize(Vec3d{s.x / alpha.x, s.y / alpha.y, s.z});
    const double smith_o = smith_length(wo, alpha);
    double e = 0;
    double b = 0;
    for (std::size_t j = 0; j < kRings; ++j) {
      const double rise = (1 - ring_[j]) * (1 + m);
      const double z = rise - m;
      const double radius = std::sqrt(std::max((1 - z) * (1 + z), 0.0));
      for (const Vec2d& circle : circle_) {
        const Vec3d h{(radius * circle.x + s.x) * alpha.x, (radius * circle.y + s.y) * alpha.y, rise};
        const double o_dot_h = dot(wo, h);
        const double scale = 1 / dot(h, h);
        const Vec3d wi = h * (2 * o_dot_h * scale) - wo;
        if (wi.z > 0) {
          const double kept = weight_[j] * wi.z * (wo.z + smith_o) / (wo.z * smith_length(wi, alpha) + wi.z * smith_o);
          e += kept;
          b += kept * schlick_weight(o_dot_h * std::sqrt(scale));
        }
      }
    }
    return {std::min(e, 1.0), (1 - std::pow(b / e, 0.2)) / smith_o};
  }

 private:
  static constexpr std::size_t kTurns = 24;
  static constexpr std::size_t kRings = 32;
  std::array<Vec2d, kTurns> circle_;
  std::array<double, kRings> ring_, weight_;
};

Table::Elevations over_directions(const FacetQuadrature& facets, const GgxAlpha<double>& alpha, double at_normal) {
  Table::Elevations out{};
  for (std::size_t k = 0; k < Table::kElevations; ++k) {
    const double root = fraction_of(k, Table::kElevations);
    // Clamped, since v may be far from the normal while s is near it, where facets are smooth in one direction only.
    const double m = std::clamp(root * root / (root * root + (1 - root) * (1 - root)), 1e-4, 1 - 3e-6);
    Table::Entry& entry = out[k];
    const auto loss = [&](const FacetMeans& means) {
      return k + 1 == Table::kElevations ? 0.0F : static_cast<float>((at_normal - means.e) / std::sqrt(1 - m));
    };
    // The nodes of e and of b both begin and end at the axes.
    const FacetMeans first = facets.means(alpha, m, 0);
    const FacetMeans last = alpha.x == alpha.y ? first : facets.means(alpha, m, 1);
    entry.loss.fill(loss(first));
    entry.cosine.fill(static_cast<float>(first.cosine));
    entry.loss.back() = loss(last);
    entry.cosine.back() = static_cast<float>(last.cosine);
    if (alpha.x == alpha.y) {
      continue;
    }
    for (std::size_t l = 1; l + 1 < Table::kAzimuths; ++l) {
      entry.loss[l] = loss(facets.means(alpha, m, fraction_of(l, Table::kAzimuths)));
    }
    const double growth = length_growth(alpha, m);
    for (std::size_t l = 1; l + 1 < Table::kLengths; ++l) {
      const double q = fraction_of(l, Table::kLengths);
      const double w = std::fabs(growth) > 1e-3 ? std::expm1(q * std::log1p(growth)) / growth : q;
      entry.cosine[l] = static_cast<float>(facets.means(alpha, m, std::clamp(w, 0.0, 1.0)).cosine);
    }
  }
  return out;
}

// 1 / pi * integral of f(v) v.z over the hemisphere, by midpoints that are denser near the horizon.
Table::Average average_of(const Table& table, const GgxAlpha<float>& alpha) {
  constexpr int kCosines = 32;
  constexpr int kTurns = 8;  // steps of azimuth in a quadrant
  const AnisotropicTerms terms(table, alpha);
  double lost = 0;
  double b = 0;
  for (int j = 0; j < kCosines; ++j) {
    const double t = (j + 0.5) / kCosines;
    const double mu = t * t * t;
    const double weight = 6 * mu * t * t / (kCosines * kTurns);
    for (int i = 0; i < kTurns; ++i) {
      const double phi = 0.5 * kPi * (i + 0.5) / kTurns;
      const double sine = std::sqrt(1 - mu * mu);
      const AlbedoTerms at = terms.at(to_float(Vec3d{sine * std::cos(phi), sine * std::sin(phi), mu}));
      lost += weight * (1 - static_cast<double>(at.e));
      b += weight * static_cast<double>(at.b);
    }
  }
  return {static_cast<float>(std::sqrt(std::max(lost, 0.0))), static_cast<float>(b)};
}

}  // namespace

AnisotropicAlbedo make_anisotropic_albedo() {
  Table table{};
  const FacetQuadrature facets;
  for (std::size_t i = 0; i < Table::kAlphas; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const auto alpha = [](std::size_t k) { return alpha_at(k, Table::kAlphas); };
      const GgxAlpha<double> alphas{alpha(i), alpha(j)};
      const double at_normal = facets.means(alphas, 1, 0).e;
      table.lost_at_normal[i][j] = static_cast<float>(1 - at_normal);
      table.lost_at_normal[j][i] = table.lost_at_normal[i][j];
      table.entries[i][j] = over_directions(facets, alphas, at_normal);
      // By symmetry, the same with x and y exchanged.
      for (std::size_t k = 0; k < Table::kElevations; ++k) {
        const Table::Entry& from = table.entries[i][j][k];
        Table::Entry& to = table.entries[j][i][k];
        if (i != j) {
          std::reverse_copy(from.loss.begin(), from.loss.end(), to.loss.begin());
          std::reverse_copy(from.cosine.begin(), from.cosine.end(), to.cosine.begin());
        }
      }
    }
  }
  for (std::size_t i = 0; i < Table::kAverages; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const auto alpha = [](std::size_t k) { return static_cast<float>(alpha_at(k, Table::kAverages)); };
      table.averages[i][j] = average_of(table, {alpha(i), alpha(j)});
      table.averages[j][i] = table.averages[i][j];
    }
  }
  return table;
}

}  // namespace gazetrace
