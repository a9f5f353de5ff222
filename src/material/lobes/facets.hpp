// SPDX-License-Identifier: Apache-2.0
// The facets of the base: what they reflect and transmit, depending on the angle to the facet. A visible normal is
// sampled first, then reflection or transmission is chosen in proportion to the light of each.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/luminance.hpp"
#include "material/layered_surface.hpp"
#include "material/lobes/dielectric.hpp"
#include "material/lobes/ggx.hpp"
#include "material/lobes/reflection.hpp"
#include "material/lobes/thin_film.hpp"

namespace gazetrace {

inline float largest_channel(const Vec3f& c) noexcept {
  return std::max(c.x, std::max(c.y, c.z));
}

class Facets {
 public:
  explicit Facets(const LayeredSurface& s) noexcept
      : s_(s),
        alpha_(anisotropic_alpha(s.base.roughness, s.anisotropy)),
        eta_(s.solid ? (s.inside ? 1.0F / s.ior : s.ior) : 1.0F),
        metal_(s.base.metallic),
        opaque_((1.0F - s.base.metallic) * (1.0F - s.transmission)),
        clear_((1.0F - s.base.metallic) * s.transmission) {}

  [[nodiscard]] float metal() const noexcept { return metal_; }
  [[nodiscard]] float opaque() const noexcept { return opaque_; }
  [[nodiscard]] float clear() const noexcept { return clear_; }
  // The index beyond the surface divided by that on the viewer's side.
  [[nodiscard]] float eta() const noexcept { return eta_; }
  // The roughness of the isotropic surface whose slopes have the same mean square.
  [[nodiscard]] float mean_roughness() const noexcept {
    return anisotropic() ? std::sqrt(std::sqrt(0.5F * (alpha_.x * alpha_.x + alpha_.y * alpha_.y))) : s_.base.roughness;
  }
  [[nodiscard]] bool anisotropic() const noexcept { return s_.anisotropy > 0; }
  [[nodiscard]] FacetTerms terms() const noexcept {
    if (!anisotropic()) {
      return FacetTerms(s_.base.roughness);
    }
    const AnisotropicTerms::Averages average = AnisotropicTerms(*s_.anisotropic, alpha_).averages();
    return {mean_roughness(), average.e, average.b};
  }
  [[nodiscard]] AlbedoTerms terms_at(const FacetTerms& terms, const Vec3f& v) const noexcept {
    return anisotropic() ? AnisotropicTerms(*s_.anisotropic, alpha_).at(v) : terms.at(v.z);
  }

  // Reflectances of the three parts, where `cosine` >= 0 is that of the angle to the facet.
  [[nodiscard]] Vec3f metal_fresnel(float cosine) const noexcept {
    return with_film(schlick(s_.base.base_color, 1.0F, cosine), s_.base.base_color, cosine);
  }
  [[nodiscard]] Vec3f opaque_fresnel(float cosine) const noexcept {
    return with_film(schlick(s_.f0, s_.f90, cosine), s_.f0, cosine);
  }
  [[nodiscard]] Vec3f clear_fresnel(float cosine) const noexcept {
    if (!s_.solid) {
      return opaque_fresnel(cosine);
    }
    const float exact = fresnel_dielectric(std::min(cosine, 1.0F), eta_);
    if (exact >= 1.0F) {
      return {1, 1, 1};
    }
    const float normal = f0_of_ior(s_.ior);
    const float rise = (exact - normal) / (1.0F - normal);
    const Vec3f f = s_.f0 + (Vec3f{s_.f90, s_.f90, s_.f90} - s_.f0) * rise;
    // The film's formula needs the angle in air, whichever side light comes from.
    const float sin2 = (1.0F - cosine * cosine) / (eta_ * eta_);
    const Vec3f shown = with_film(f, s_.f0, s_.inside ? std::sqrt(std::max(1.0F - sin2, 0.0F)) : cosine);
    return {std::max(shown.x, 0.0F), std::max(shown.y, 0.0F), std::max(shown.z, 0.0F)};
  }

  struct Split {
    Vec3f reflected, through;  // weighted sums over all parts
    float reflect_probability = 1;
  };
  [[nodiscard]] Split split(float cosine) const noexcept {
    Split result;
    if (metal_ > 0) {
      result.reflected += metal_fresnel(cosine) * metal_;
    }
    if (opaque_ > 0) {
      result.reflected += opaque_fresnel(cosine) * opaque_;
    }
    if (clear_ > 0) {
      const Vec3f f = clear_fresnel(cosine);
      result.reflected += f * clear_;
      result.through = s_.base.base_color * (clear_ * std::max(1.0F - largest_channel(f), 0.0F));
      const float up = luminance(result.reflected);
      const float down = luminance(result.through);
      result.reflect_probability = up + down > 0 ? up / (up + down) : 1.0F;
    }
    return result;
  }

  // f without the cosine, and in `pdf` the density of sampling wi. wi.z < 0 means transmission.
  [[nodiscard]] Vec3f value(const Vec3f& wo, const Vec3f& wi, float& pdf) const noexcept {
    pdf = 0;
    const bool through = wi.z < 0;
    const bool bends = through && s_.solid;
    const Vec3f up{wi.x, wi.y, std::fabs(wi.z)};
    const Vec3f h = bends ? refraction_half_vector(wo, wi, eta_) : normalize(wo + up);
    const float o_dot_h = dot(wo, h);
    const float i_dot_h = dot(wi, h);
    if (!(o_dot_h > 0) || (bends && !(i_dot_h < 0))) {
      return {};
    }
    const float distribution = ggx_distribution(h, alpha_);
    const float smith_o = smith_length(wo, alpha_);
    const float masking = 1.0F / (wo.z * smith_length(wi, alpha_) + up.z * smith_o);  // G2 / (2 o.z i.z)
    const Split parts = split(o_dot_h);
    const float normal_pdf = visible_normal_pdf(o_dot_h, wo.z, smith_o, distribution);
    if (!through) {
      pdf = parts.reflect_probability * normal_pdf / (4.0F * o_dot_h);
      return parts.reflected * (0.5F * distribution * masking);
    }
    if (!bends) {
      pdf = (1.0F - parts.reflect_probability) * normal_pdf / (4.0F * o_dot_h);
      return parts.through * (0.5F * distribution * masking);
    }
    const float s = o_dot_h + eta_ * i_dot_h;
    pdf = (1.0F - parts.reflect_probability) * normal_pdf * refraction_jacobian(o_dot_h, i_dot_h, eta_);
    return parts.through * (-2.0F * i_dot_h * o_dot_h * distribution * masking / (s * s));
  }

  // False where there is no direction, because light leaves the facet towards other facets.
  [[nodiscard]] bool sample(const Vec3f& wo, const Vec2f& u, float choice, Vec3f& wi) const noexcept {
    const Vec3f h = sample_visible_normal(wo, alpha_, u);
    const float o_dot_h = dot(wo, h);
    if (choice < split(o_dot_h).reflect_probability) {
      wi = reflect(wo, h);
      return wi.z > 0;
    }
    if (!s_.solid) {
      wi = reflect(wo, h);
      wi.z = -wi.z;
      return wi.z < 0;
    }
    return refract(wo, h, eta_, wi) && wi.z < 0;
  }

 private:
  [[nodiscard]] static Vec3f schlick(const Vec3f& f0, float f90, float cosine) noexcept {
    return f0 + (Vec3f{f90, f90, f90} - f0) * schlick_weight(cosine);
  }
  [[nodiscard]] Vec3f with_film(const Vec3f& bare, const Vec3f& f0, float cosine) const noexcept {
    if (!(s_.film > 0)) {
      return bare;
    }
    return bare + (thin_film_fresnel(cosine, s_.film_ior, s_.film_thickness_nm, f0) - bare) * s_.film;
  }

  LayeredSurface s_;
  GgxAlpha<float> alpha_;
  float eta_, metal_, opaque_, clear_;
};

}  // namespace gazetrace
