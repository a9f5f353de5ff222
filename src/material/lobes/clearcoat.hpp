// SPDX-License-Identifier: Apache-2.0
// KHR_materials_clearcoat: a dielectric coat of index 1.5 (f0 = 0.04) with its own roughness and normal. Its lobe is
// isotropic GGX with Schlick's Fresnel and repeated scattering; layering.hpp says how much light it leaves for the
// base.
#pragma once

#include <algorithm>
#include <cmath>

#include "material/lobes/ggx.hpp"
#include "material/lobes/reflection.hpp"

namespace gazetrace {

// The share of the base's emission that passes the coat (KHR_materials_clearcoat, "Emission"). `cosine` is that to the
// geometric normal, so that a light sample and a ray that hits the emitter agree.
inline float passes_coat(float coat, float cosine) noexcept {
  return 1.0F - coat * (kDielectricF0 + (1.0F - kDielectricF0) * schlick_weight(std::min(std::fabs(cosine), 1.0F)));
}

class ClearcoatLobe {
 public:
  // `cos_o` > 0 is the cosine between the view and the coat's normal.
  ClearcoatLobe(float factor, float roughness, float cos_o) noexcept
      : factor_(factor),
        alpha_(alpha_of_roughness(roughness)),
        terms_(roughness),
        at_o_(terms_.at(cos_o)),
        repeated_(terms_.repeated(kDielectricF0, 1.0F)) {}

  [[nodiscard]] float albedo(float cosine) const noexcept {
    return factor_ * terms_.albedo(terms_.at(cosine), kDielectricF0, 1.0F);
  }
  [[nodiscard]] float albedo_o() const noexcept { return factor_ * terms_.albedo(at_o_, kDielectricF0, 1.0F); }
  [[nodiscard]] float albedo_average() const noexcept {
    return factor_ * terms_.albedo_average_of(kDielectricF0, 1.0F);
  }

  // f without the cosine, and in `pdf` the density of `sample`. Both directions are in the coat's own frame and above
  // it.
  [[nodiscard]] float value(const Vec3f& wo, const Vec3f& wi, float& pdf) const noexcept {
    const Vec3f h = normalize(wo + wi);
    const float distribution = ggx_distribution(h, alpha_);
    const float smith_o = smith_length(wo.z, alpha_ * alpha_);
    const float smith_i = smith_length(wi.z, alpha_ * alpha_);
    pdf = visible_reflection_pdf(wo.z, smith_o, distribution);
    const float fresnel = kDielectricF0 + (1.0F - kDielectricF0) * schlick_weight(dot(wo, h));
    return factor_ * (fresnel * distribution * 0.5F / (wo.z * smith_i + wi.z * smith_o) +
                      terms_.repeated_lobe(at_o_.e, terms_.at(wi.z).e) * repeated_);
  }
  [[nodiscard]] Vec3f sample(const Vec3f& wo, const Vec2f& u) const noexcept {
    return reflect(wo, sample_visible_normal(wo, alpha_, u));
  }

 private:
  float factor_, alpha_;
  FacetTerms terms_;
  AlbedoTerms at_o_;
  float repeated_;
};

}  // namespace gazetrace
