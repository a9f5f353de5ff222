// SPDX-License-Identifier: Apache-2.0
// Schlick's Fresnel term with any reflectance at normal and grazing incidence, F = f0 + (f90 - f0) (1 - cos)^5, and the
// total reflectance of a GGX lobe with it, from the tables: single and repeated scattering (Kulla and Conty 2017), as
// in bsdf.hpp for f0 = 0.04, f90 = 1.
#pragma once

#include <algorithm>

#include "material/albedo_tables.hpp"
#include "material/microfacet.hpp"

namespace gazetrace {

struct FacetTerms {
  AlbedoRow row;
  float e_average = 1, b_average = 0, kept = 1;  // kept: e_average times the share of repeated scattering that is kept

  explicit FacetTerms(float roughness) noexcept
      : row(albedo_row(std::clamp(roughness, 0.0F, 1.0F))),
        e_average(albedo_average(row)),
        b_average(interpolate_average(kAlbedoTables.b_average, row)),
        kept(e_average * repeated_share(1.0F - e_average)) {}
  // For facets that are not in the tables; at() must not be used.
  FacetTerms(float roughness, float e_average_of, float b_average_of) noexcept
      : row(albedo_row(std::clamp(roughness, 0.0F, 1.0F))),
        e_average(e_average_of),
        b_average(b_average_of),
        kept(e_average * repeated_share(1.0F - e_average)) {}

  [[nodiscard]] AlbedoTerms at(float cosine) const noexcept {
    return albedo_terms(row, std::clamp(cosine, 0.0F, 1.0F));
  }
  // The share of the light lost to repeated scattering that leaves the surface again.
  [[nodiscard]] float repeated(float f0, float f90) const noexcept {
    const float f = f0 + (f90 - f0) * (1.0F / 21.0F);
    return f * f * kept / (1.0F - f * (1.0F - e_average));
  }
  [[nodiscard]] float albedo(const AlbedoTerms& terms, float f0, float f90) const noexcept {
    return f0 * (terms.e - terms.b) + f90 * terms.b + (1.0F - terms.e) * repeated(f0, f90);
  }
  [[nodiscard]] float albedo_average_of(float f0, float f90) const noexcept {
    return f0 * (e_average - b_average) + f90 * b_average + (1.0F - e_average) * repeated(f0, f90);
  }
  // The repeated-scattering lobe without its reflectance, lost(o) lost(i) / (pi lost_avg).
  [[nodiscard]] float repeated_lobe(float e_o, float e_i) const noexcept {
    return (1.0F - e_o) * (1.0F - e_i) * static_cast<float>(1 / kPi) / std::max(1.0F - e_average, 1e-7F);
  }
};

}  // namespace gazetrace
