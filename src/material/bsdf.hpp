// SPDX-License-Identifier: Apache-2.0
// glTF 2.0's metallic-roughness surface as an energy-conserving, reciprocal BSDF.
//   f = GGX lobe with Schlick's Fresnel, f0 = mix(0.04, base colour, metallic)              (glTF 2.0, appendix B)
//     + multiple scattering between its facets: m (1 - e(o)) (1 - e(i)) / (pi (1 - e_avg))  (Kulla and Conty 2017)
//         m = F^2 e_avg / (1 - F (1 - e_avg)),  F = f0 + (1 - f0) / 21, dielectric and metal part each with its own f0,
//         faded out on smooth surfaces (repeated_share)
//     + (1 - metallic) base colour / pi * s(o) s(i) * shape(o, i)                       (albedo_tables.hpp explains s)
//         shape = 1 (Lambert) or (1 + t (1-o.z)^5) (1 + t (1-i.z)^5), t = roughness (1 + o.i) - 0.5
//         (Burley, "Physically Based Shading at Disney", 2012, section 5.3, with 2 cos^2 theta_d = 1 + o.i)
// A white surface reflects exactly the light it receives, up to the interpolation of the tables (bsdf_furnace_test
// states the bound). Burley's own lobe loses light at grazing angles on smooth surfaces and gains light on rough ones;
// s removes both and keeps the angular shape. DiffuseModel::matte is base colour / pi alone. Directions point away from
// the surface; z is the shading normal.
#pragma once

#include "core/luminance.hpp"
#include "gazetrace/material.hpp"
#include "material/albedo_tables.hpp"
#include "material/microfacet.hpp"

namespace gazetrace {

// The material at a hit, with textures applied.
struct Surface {
  Vec3f base_color;
  float metallic = 0;
  float roughness = 0;  // perceptual, 0..1; alpha = roughness^2, at least kAlphaMin
};

struct BsdfEval {
  Vec3f f_cos;    // f times the cosine at wi
  float pdf = 0;  // density of sample_bsdf over solid angle, all lobes together
};

struct BsdfSample {
  Vec3f direction;
  Vec3f weight;  // f cos / pdf
  float pdf = 0;
  bool valid = false;  // false: the path ends here (a direction below the surface, or black)
  bool delta = false;  // always false: no lobe of this model is a delta function
};

// The BSDF of one hit seen from one direction. It is made once, then evaluated for light samples and sampled for the
// next direction.
template <DiffuseModel kDiffuse>
class Bsdf {
 public:
  Bsdf(const Surface& surface, const Vec3f& wo) noexcept
      : Bsdf(surface, wo, table_row(surface), albedo_terms(table_row(surface), std::clamp(wo.z, 0.0F, 1.0F)),
             albedo_average(table_row(surface))) {}

  // For loops over many hits, which read the tables first so that the arithmetic vectorises. `terms` are the table's
  // values at wo.z, `e_average` is that of the row.
  Bsdf(const Surface& surface, const Vec3f& wo, const AlbedoRow& row, const AlbedoTerms& terms,
       float e_average) noexcept
      : wo_(wo),
        row_(row),
        roughness_(surface.roughness),
        alpha_(alpha_of_roughness(surface.roughness)),
        f0_(Vec3f{kDielectricF0, kDielectricF0, kDielectricF0} * (1.0F - surface.metallic) +
            surface.base_color * surface.metallic),
        smith_o_(smith_length(wo.z, alpha_ * alpha_)) {
    if constexpr (kDiffuse == DiffuseModel::matte) {
      diffuse_ = surface.base_color * kInvPi;
      specular_probability_ = 0;
      return;
    }
    const float lost_average = 1.0F - e_average;
    const float kept = e_average * repeated_share(lost_average);
    const auto repeated = [=](float f0) {
      const float f = f0 + (1.0F - f0) * (1.0F / 21.0F);
      return f * f * kept / (1.0F - f * lost_average);
    };
    const float dielectric = repeated(kDielectricF0) * (1.0F - surface.metallic);
    const Vec3f& c = surface.base_color;
    const Vec3f repeats = Vec3f{repeated(c.x), repeated(c.y), repeated(c.z)} * surface.metallic +
                          Vec3f{dielectric, dielectric, dielectric};
    const float lost = 1.0F - terms.e;
    // Where nothing is lost, the lobe is 0/0 with a limit of 0.
    multiple_ = repeats * (lost * kInvPi / std::max(lost_average, 1e-7F));
    const float scale = kDiffuse == DiffuseModel::burley ? terms.burley : terms.lambert;
    diffuse_ = c * ((1.0F - surface.metallic) * scale * kInvPi);
    weight_o_ = schlick_weight(wo.z);

    // A lobe is chosen in proportion to its directional albedo.
    const float specular = luminance(f0_) * (terms.e - terms.b) + terms.b;
    const float diffuse =
        luminance(c) * (1.0F - surface.metallic) * (1.0F - (kDielectricF0 * (terms.e - terms.b) + terms.b)) +
        luminance(repeats) * lost;
    const float sum = specular + diffuse;
    specular_probability_ = sum > 0 ? specular / sum : 1.0F;
  }

  static AlbedoRow table_row(const Surface& surface) noexcept {
    return albedo_row(std::clamp(surface.roughness, 0.0F, 1.0F));
  }

  [[nodiscard]] BsdfEval evaluate(const Vec3f& wi) const noexcept {
    return evaluate(wi, albedo_terms(row_, std::clamp(wi.z, 0.0F, 1.0F)));
  }
  [[nodiscard]] BsdfEval evaluate(const Vec3f& wi, const AlbedoTerms& terms) const noexcept {
    const Vec3f half = wo_ + wi;
    const BsdfEval above = evaluate_half(wi, half * (1.0F / std::sqrt(std::max(dot(half, half), 1e-20F))), terms);
    const bool valid = (static_cast<int>(wo_.z > 0) & static_cast<int>(wi.z > 0)) != 0;
    return {{valid ? above.f_cos.x : 0.0F, valid ? above.f_cos.y : 0.0F, valid ? above.f_cos.z : 0.0F},
            valid ? above.pdf : 0.0F};
  }

  // What the diffuse lobe has of evaluate(wi).f_cos.
  [[nodiscard]] Vec3f diffuse_f_cos(const Vec3f& wi) const noexcept {
    if (!(wo_.z > 0) || !(wi.z > 0)) {
      return {};
    }
    if constexpr (kDiffuse == DiffuseModel::matte) {
      return diffuse_ * wi.z;
    }
    return diffuse_ * (shape(wi, albedo_terms(row_, std::clamp(wi.z, 0.0F, 1.0F))) * wi.z);
  }

  // How often a direction is drawn from the specular lobe.
  [[nodiscard]] float specular_probability() const noexcept { return specular_probability_; }

  struct Direction {
    Vec3f direction, half;
  };
  // Both lobes are sampled and one result is selected, which avoids branches.
  [[nodiscard]] Direction sample_direction(const Vec2f& u, float u_lobe) const noexcept {
    const bool specular = u_lobe < specular_probability_;
    const Vec3f facet = sample_visible_normal(wo_, alpha_, u);
    const Vec3f mirrored = reflect(wo_, facet);
    const Vec3f diffuse = sample_cosine_hemisphere(u);
    const Vec3f middle = wo_ + diffuse;
    const float scale = 1.0F / std::sqrt(std::max(dot(middle, middle), 1e-20F));
    const auto choose = [specular](const Vec3f& a, const Vec3f& b) {
      return Vec3f{specular ? a.x : b.x, specular ? a.y : b.y, specular ? a.z : b.z};
    };
    return {choose(mirrored, diffuse), choose(facet, middle * scale)};
  }
  [[nodiscard]] BsdfSample weigh(const Direction& chosen, const AlbedoTerms& terms) const noexcept {
    const BsdfEval eval = evaluate_half(chosen.direction, chosen.half, terms);
    BsdfSample result;
    result.direction = chosen.direction;
    result.pdf = eval.pdf;
    result.weight = eval.f_cos * (1.0F / eval.pdf);
    result.valid =
        (static_cast<int>(wo_.z > 0) & static_cast<int>(chosen.direction.z > 0) & static_cast<int>(eval.pdf > 0) &
         static_cast<int>(result.weight.x + result.weight.y + result.weight.z > 0)) != 0;
    return result;
  }
  [[nodiscard]] BsdfSample sample(const Vec2f& u, float u_lobe) const noexcept {
    const Direction chosen = sample_direction(u, u_lobe);
    return weigh(chosen, albedo_terms(row_, std::clamp(chosen.direction.z, 0.0F, 1.0F)));
  }

 private:
  static constexpr float kInvPi = static_cast<float>(1 / kPi);

  // The factor s(i) shape of the diffuse lobe.
  [[nodiscard]] float shape(const Vec3f& wi, const AlbedoTerms& terms) const noexcept {
    if constexpr (kDiffuse == DiffuseModel::burley) {
      const float t = roughness_ * (1.0F + dot(wo_, wi)) - 0.5F;
      return terms.burley * (1.0F + t * weight_o_) * (1.0F + t * schlick_weight(wi.z));
    }
    return terms.lambert;
  }

  [[nodiscard]] BsdfEval evaluate_half(const Vec3f& wi, const Vec3f& half, const AlbedoTerms& terms) const noexcept {
    if constexpr (kDiffuse == DiffuseModel::matte) {
      return {diffuse_ * wi.z, kInvPi * wi.z};
    }
    const float distribution = ggx_distribution(half, alpha_);
    const float smith_i = smith_length(wi.z, alpha_ * alpha_);
    const float visible = 0.5F / (wo_.z * smith_i + wi.z * smith_o_);
    const float fresnel = schlick_weight(dot(wo_, half));
    const Vec3f reflectance = f0_ + (Vec3f{1, 1, 1} - f0_) * fresnel;

    BsdfEval result;
    result.f_cos =
        (reflectance * (distribution * visible) + multiple_ * (1.0F - terms.e) + diffuse_ * shape(wi, terms)) * wi.z;
    result.pdf = specular_probability_ * visible_reflection_pdf(wo_.z, smith_o_, distribution) +
                 (1.0F - specular_probability_) * kInvPi * wi.z;
    return result;
  }

  Vec3f wo_;
  AlbedoRow row_;
  float roughness_;
  float alpha_;
  Vec3f f0_;
  float smith_o_;
  Vec3f multiple_;  // the multiple-scattering lobe without its factor (1 - e(i))
  Vec3f diffuse_;   // the diffuse lobe without its factor s(i) shape
  float weight_o_ = 0;
  float specular_probability_ = 1;
};

template <DiffuseModel kDiffuse>
BsdfEval evaluate_bsdf(const Surface& surface, const Vec3f& wo, const Vec3f& wi) noexcept {
  return Bsdf<kDiffuse>(surface, wo).evaluate(wi);
}

template <DiffuseModel kDiffuse>
BsdfSample sample_bsdf(const Surface& surface, const Vec3f& wo, const Vec2f& u, float u_lobe) noexcept {
  return Bsdf<kDiffuse>(surface, wo).sample(u, u_lobe);
}

}  // namespace gazetrace
