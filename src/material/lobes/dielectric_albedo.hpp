// SPDX-License-Identifier: Apache-2.0
// How much light single scattering loses at a rough surface between two media, where light meets facets more than once.
// The table holds the share that it keeps, reflected and transmitted together, over (side, roughness, cosine), for one
// index of refraction:
//   kept_s(mu) = integral of f_flux cos over both sides, for light from side s
// The rest goes into a lobe like Kulla and Conty's (2017) over both sides. With lost = 1 - kept and its cosine average
// it is
//   same side   r_s lost_s(o) lost_s(i) / (pi lost_s_avg)
//   other side  (1 - r_s) lost_s(o) lost_t(i) / (pi lost_t_avg)
// which is reciprocal where (1 - r_s) lost_s_avg n_s^2 is the same for both sides. LayeredBsdf takes for it
// passed_average times the smaller of the two lost_s_avg.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gazetrace {

struct DielectricAlbedo {
  static constexpr std::size_t kNodes = 24;  // mu = (k / (n - 1))^2, roughness = j / (n - 1)
  using Row = std::array<float, kNodes>;
  std::array<std::array<Row, kNodes>, 2> kept;  // [0: light comes from outside, 1: from inside][roughness][mu]
  std::array<Row, 2> kept_average;
  float ior = 1.5F;
  float passed_average = 0;  // cosine average of 1 - F from outside, for a smooth surface
};

// Computed by quadrature in double precision, in some ten milliseconds. ior >= kLeastIor.
DielectricAlbedo make_dielectric_albedo(double ior);

struct DielectricRow {
  std::size_t row;
  float fraction;
};
inline DielectricRow dielectric_row(float roughness) noexcept {
  const float y = std::clamp(roughness, 0.0F, 1.0F) * static_cast<float>(DielectricAlbedo::kNodes - 1);
  const auto row = std::min(static_cast<std::size_t>(y), DielectricAlbedo::kNodes - 2);
  return {row, y - static_cast<float>(row)};
}

inline float kept_at(const DielectricAlbedo& table, std::size_t side, const DielectricRow& at, float mu) noexcept {
  const float x = std::sqrt(std::clamp(mu, 0.0F, 1.0F)) * static_cast<float>(DielectricAlbedo::kNodes - 1);
  const auto k = std::min(static_cast<std::size_t>(x), DielectricAlbedo::kNodes - 2);
  const float f = x - static_cast<float>(k);
  const auto& low = table.kept[side][at.row];
  const auto& high = table.kept[side][at.row + 1];
  const float a = low[k] + (low[k + 1] - low[k]) * f;
  const float b = high[k] + (high[k + 1] - high[k]) * f;
  return a + (b - a) * at.fraction;
}

inline float kept_average(const DielectricAlbedo& table, std::size_t side, const DielectricRow& at) noexcept {
  const auto& row = table.kept_average[side];
  return row[at.row] + (row[at.row + 1] - row[at.row]) * at.fraction;
}

}  // namespace gazetrace
