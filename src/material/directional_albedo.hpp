// SPDX-License-Identifier: Apache-2.0
// The share of uniform light from all around that a metallic-roughness surface reflects towards the viewer: the
// integral of f cos over the hemisphere, from the tables by which the BSDF conserves energy (bsdf.hpp,
// albedo_tables.hpp).
#pragma once

#include "material/bsdf.hpp"

namespace gazetrace {

// `f0`: reflectance of the dielectric part at normal incidence. `cosine`: between view and shading normal, 0..1.
inline Vec3f directional_albedo(const Surface& surface, float f0, float cosine) noexcept {
  const AlbedoRow row = albedo_row(std::clamp(surface.roughness, 0.0F, 1.0F));
  const AlbedoTerms terms = albedo_terms(row, cosine);
  const float e_average = albedo_average(row);
  const float lost_average = 1.0F - e_average;
  const float kept = e_average * repeated_share(lost_average);
  const auto specular = [&](float at_normal) {
    const float f = at_normal + (1.0F - at_normal) * (1.0F / 21.0F);
    const float repeated = f * f * kept / (1.0F - f * lost_average);
    return at_normal * (terms.e - terms.b) + terms.b + repeated * (1.0F - terms.e);
  };
  const float dielectric = specular(f0);
  const Vec3f& c = surface.base_color;
  if (surface.metallic == 0) {  // the usual case; the same result at less cost
    const float left = 1.0F - dielectric;
    return {dielectric + c.x * left, dielectric + c.y * left, dielectric + c.z * left};
  }
  const auto mixed = [&](float base) {
    return surface.metallic * specular(base) + (1.0F - surface.metallic) * (dielectric + base * (1.0F - dielectric));
  };
  return {mixed(c.x), mixed(c.y), mixed(c.z)};
}

}  // namespace gazetrace
