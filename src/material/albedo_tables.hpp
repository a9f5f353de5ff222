// SPDX-License-Identifier: Apache-2.0
// Directional albedos over (cosine, roughness), by which the BSDF conserves energy. generate_albedo_tables.cpp computes
// them at build time in double precision.
//   e      of the GGX lobe with Fresnel 1, single scattering
//   b      the same, weighted with Schlick's (1 - v.h)^5, so that a lobe with Schlick's Fresnel has f0 (e - b) + b
//   lambert, burley   s(mu): the diffuse lobe is  c / pi  s(o) s(i) shape(o, i)  with  s(o) * integral of
//          s(i) shape(o, i) cos_i / pi  =  1 - (albedo of the whole dielectric specular lobe at o),
//          so that a white dielectric reflects everything, and the lobe is reciprocal. For shape = 1 this is the
//          diffuse term of Kulla and Conty ("Revisiting Physically Based Shading at Imageworks", 2017).
//   e_average, b_average  2 * integral of e(mu) mu dmu, of b(mu) mu dmu
//   sheen  {raw, kept}: directional albedo of the lobe of lobes/sheen.hpp for colour 1, as its authors state it, and
//          after sheen_gain has removed what exceeds 1;  sheen_average: the average of `kept`, like e_average
// Nodes: mu = (k / (n - 1))^2, roughness = j / (n - 1); interpolated bilinearly in (sqrt(mu), roughness).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gazetrace {

inline constexpr int kAlbedoNodes = 32;
inline constexpr float kDielectricF0 = 0.04F;

// The share of the multiple-scattering lobe that is kept. On smooth surfaces that lobe consists of grazing directions
// only, which its cosine sampling finds once in a million samples with an accordingly large weight. Fading it out
// avoids those fireflies, and loses light within 3 degrees of grazing at roughness below 0.2.
template <class T>
constexpr T repeated_share(T lost_average) noexcept {
  return lost_average * lost_average / (lost_average * lost_average + T(1e-6));
}

struct AlbedoTerms {
  float e, b, lambert, burley;
};

struct SheenAlbedo {
  float raw, kept;
};

struct AlbedoTables {
  std::array<std::array<AlbedoTerms, kAlbedoNodes>, kAlbedoNodes> terms;  // [roughness][mu]
  std::array<float, kAlbedoNodes> e_average, b_average;
  std::array<std::array<SheenAlbedo, kAlbedoNodes>, kAlbedoNodes> sheen;  // [roughness][mu]
  std::array<float, kAlbedoNodes> sheen_average;
};

extern const AlbedoTables kAlbedoTables;

// The position of a roughness between two rows of the tables.
struct AlbedoRow {
  int row;
  float fraction;
};

inline AlbedoRow albedo_row(float roughness) noexcept {
  const float y = roughness * static_cast<float>(kAlbedoNodes - 1);
  const int row = std::min(static_cast<int>(y), kAlbedoNodes - 2);
  return {row, y - static_cast<float>(row)};
}

inline AlbedoTerms albedo_terms(const AlbedoRow& at, float mu) noexcept {
  const float x = std::sqrt(mu) * static_cast<float>(kAlbedoNodes - 1);
  const int column = std::min(static_cast<int>(x), kAlbedoNodes - 2);
  const float fx = x - static_cast<float>(column);
  const float w11 = fx * at.fraction;
  const float w10 = fx - w11;
  const float w01 = at.fraction - w11;
  const float w00 = 1.0F - fx - w01;
  const auto row = static_cast<std::size_t>(at.row);
  const auto k = static_cast<std::size_t>(column);
  const AlbedoTerms& t00 = kAlbedoTables.terms[row][k];
  const AlbedoTerms& t10 = kAlbedoTables.terms[row][k + 1];
  const AlbedoTerms& t01 = kAlbedoTables.terms[row + 1][k];
  const AlbedoTerms& t11 = kAlbedoTables.terms[row + 1][k + 1];
  return {w00 * t00.e + w10 * t10.e + w01 * t01.e + w11 * t11.e, w00 * t00.b + w10 * t10.b + w01 * t01.b + w11 * t11.b,
          w00 * t00.lambert + w10 * t10.lambert + w01 * t01.lambert + w11 * t11.lambert,
          w00 * t00.burley + w10 * t10.burley + w01 * t01.burley + w11 * t11.burley};
}

inline float albedo_average(const AlbedoRow& at) noexcept {
  const auto row = static_cast<std::size_t>(at.row);
  const float a = kAlbedoTables.e_average[row];
  return a + (kAlbedoTables.e_average[row + 1] - a) * at.fraction;
}

inline float interpolate_average(const std::array<float, kAlbedoNodes>& averages, const AlbedoRow& at) noexcept {
  const auto row = static_cast<std::size_t>(at.row);
  return averages[row] + (averages[row + 1] - averages[row]) * at.fraction;
}

inline SheenAlbedo sheen_albedo(const AlbedoRow& at, float mu) noexcept {
  const float x = std::sqrt(mu) * static_cast<float>(kAlbedoNodes - 1);
  const auto k = static_cast<std::size_t>(std::min(static_cast<int>(x), kAlbedoNodes - 2));
  const float f = x - static_cast<float>(k);
  const auto& low = kAlbedoTables.sheen[static_cast<std::size_t>(at.row)];
  const auto& high = kAlbedoTables.sheen[static_cast<std::size_t>(at.row) + 1];
  const auto blend = [&](float a, float b, float c, float d) {
    const float first = a + (b - a) * f;
    return first + (c + (d - c) * f - first) * at.fraction;
  };
  return {blend(low[k].raw, low[k + 1].raw, high[k].raw, high[k + 1].raw),
          blend(low[k].kept, low[k + 1].kept, high[k].kept, high[k + 1].kept)};
}

}  // namespace gazetrace
