// SPDX-License-Identifier: Apache-2.0
// Directional albedos of GGX facets whose slopes differ along x and y: e and b of albedo_tables.hpp for a view from any
// side, and their cosine averages over the whole hemisphere. With these, Kulla and Conty's lobe,
//   (1 - e(o)) (1 - e(i)) / (pi (1 - e_average)),
// is reciprocal and conserves energy also where e depends on the azimuth. They are made for scenes that have such
// facets.
//   The table is over (alpha.x, alpha.y, direction). The direction is taken in the space where the facets have unit
// roughness, s = (alpha.x v.x, alpha.y v.y, v.z) / L(v), with Smith's L: there e changes slowly, and hardly at all with
// the alphas once these are small. It is stored as (lost - lost at the normal) / sqrt(1 - s.z), with lost = 1 - e,
// since smooth facets lose next to nothing, in proportion to 1 - s.z. The mean of v.h / L(v), from which b follows,
// behaves in the same way; it is stored as the cosine at which Schlick's weight is that of all facets together, divided
// by L(v). Where the alphas differ much, L changes abruptly with the azimuth of s, so the nodes of b are uniform in the
// logarithm of L.
//   Within 0.005 (e), 0.01 (b) and 0.003 (averages) of the integrals: anisotropic_albedo_test.
//   The nodes are uniform in sqrt(alpha), from kAlphaMin to 1; in the elevation sqrt(m) / (sqrt(m) + sqrt(1 - m)) with
// m = s.z; and in the azimuth w = s.y^2 / (s.x^2 + s.y^2) for e, in log L along it for b. Averages are over
// sqrt(alpha).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "material/albedo_tables.hpp"
#include "material/lobes/ggx.hpp"

namespace gazetrace {

struct AnisotropicAlbedo {
  static constexpr std::size_t kAlphas = 14, kElevations = 20, kAzimuths = 4, kLengths = 7, kAverages = 32;
  struct Entry {
    std::array<float, kAzimuths> loss;
    std::array<float, kLengths> cosine;
  };
  using Elevations = std::array<Entry, kElevations>;
  std::array<std::array<Elevations, kAlphas>, kAlphas> entries;  // [alpha.x][alpha.y]
  std::array<std::array<float, kAlphas>, kAlphas> lost_at_normal;
  struct Average {
    float lost_root, b;  // sqrt(1 - e_average), which is close to linear; b_average
  };
  std::array<std::array<Average, kAverages>, kAverages> averages;
};

// How much 1 / L(v)^2 grows from w = 0 to w = 1, relative to its value at w = 0, for directions whose s.z is m:
// 1 / L^2 = (1 - m^2) ((1 - w) / alpha.x^2 + w / alpha.y^2) + m^2.
template <class T>
T length_growth(const GgxAlpha<T>& alpha, T m) noexcept {
  const T across = (T(1) - m) * (T(1) + m);
  const T ratio = alpha.x / alpha.y;
  return across * (ratio - T(1)) * (ratio + T(1)) / (across + m * m * alpha.x * alpha.x);
}

// Computed by quadrature in double precision, in about 0.1 s.
AnisotropicAlbedo make_anisotropic_albedo();

// The part of the table for one pair of alphas.
class AnisotropicTerms {
 public:
  AnisotropicTerms(const AnisotropicAlbedo& table, const GgxAlpha<float>& alpha) noexcept
      : table_(&table),
        alpha_(alpha),
        x_(node(alpha_place(alpha.x), AnisotropicAlbedo::kAlphas)),
        y_(node(alpha_place(alpha.y), AnisotropicAlbedo::kAlphas)) {}

  // e and b; v.z >= 0.
  [[nodiscard]] AlbedoTerms at(const Vec3f& v) const noexcept {
    const float x = alpha_.x * v.x;
    const float y = alpha_.y * v.y;
    const float across = x * x + y * y;
    const float z = std::max(v.z, 0.0F);
    const float len = std::max(std::sqrt(across + z * z), 1e-20F);
    const float root = std::sqrt(z / len);
    const float rest = std::sqrt(across / (len * (len + z)));
    const float w = across > 1e-30F ? y * y / across : 0.0F;
    const float growth = length_growth(alpha_, std::min(z / len, 1.0F));
    const float q = std::fabs(growth) > 1e-3F ? std::log1p(growth * w) / std::log1p(growth) : w;
    const Node elevation = node(root / (root + rest), AnisotropicAlbedo::kElevations);
    const Node azimuth = node(w, AnisotropicAlbedo::kAzimuths);
    const Node length = node(q, AnisotropicAlbedo::kLengths);
    float loss = 0;
    float lost_at_normal = 0;
    float cosine = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const auto [i, wi] = x_.corner(corner & 1U);
      const auto [j, wj] = y_.corner((corner >> 1U) & 1U);
      const auto [k, wk] = elevation.corner((corner >> 2U) & 1U);
      const AnisotropicAlbedo::Entry& entry = table_->entries[i][j][k];
      loss += wi * wj * wk * azimuth.between(entry.loss);
      lost_at_normal += wi * wj * wk * table_->lost_at_normal[i][j];
      cosine += wi * wj * wk * length.between(entry.cosine);
    }
    const float e = 1.0F - std::clamp(lost_at_normal + rest * loss, 0.0F, 1.0F);
    return {e, e * schlick_weight(cosine * len), 0, 0};
  }

  struct Averages {
    float e, b;
  };
  [[nodiscard]] Averages averages() const noexcept {
    const Node x = node(alpha_place(alpha_.x), AnisotropicAlbedo::kAverages);
    const Node y = node(alpha_place(alpha_.y), AnisotropicAlbedo::kAverages);
    float lost_root = 0;
    float b = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto [i, wi] = x.corner(corner & 1U);
      const auto [j, wj] = y.corner(corner >> 1U);
      lost_root += wi * wj * table_->averages[i][j].lost_root;
      b += wi * wj * table_->averages[i][j].b;
    }
    return {1.0F - lost_root * lost_root, b};
  }

 private:
  struct Node {
    std::size_t at;
    float fraction;
    struct Corner {
      std::size_t at;
      float weight;
    };
    [[nodiscard]] Corner corner(std::size_t upper) const noexcept {
      return {at + upper, upper == 0 ? 1.0F - fraction : fraction};
    }
    template <class Values>
    [[nodiscard]] float between(const Values& values) const noexcept {
      return values[at] + (values[at + 1] - values[at]) * fraction;
    }
  };
  // The position of an alpha among the nodes, 0 at kAlphaMin; linear in sqrt(alpha).
  [[nodiscard]] static float alpha_place(float alpha) noexcept {
    constexpr float kLeast = 0.0223607F;
    return (std::sqrt(alpha) - kLeast) / (1.0F - kLeast);
  }
  // The position of x in 0..1 among `count` uniform nodes.
  [[nodiscard]] static Node node(float x, std::size_t count) noexcept {
    const float y = std::clamp(x, 0.0F, 1.0F) * static_cast<float>(count - 1);
    const auto at = std::min(static_cast<std::size_t>(y), count - 2);
    return {at, y - static_cast<float>(at)};
  }

  const AnisotropicAlbedo* table_;
  GgxAlpha<float> alpha_;
  Node x_, y_;
};

}  // namespace gazetrace
