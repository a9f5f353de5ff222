// SPDX-License-Identifier: Apache-2.0
// The surface of bsdf.hpp with glTF's extensions. From the top, its layers are:
//   clearcoat                                                                    lobes/clearcoat.hpp
//   sheen                                                                        lobes/sheen.hpp
//   base = metallic * metal + (1 - metallic) ((1 - t) * opaque + t * clear)      t: transmission
//     metal   facets that reflect the base colour
//     opaque  facets that reflect f0..f90, over diffuse light, a share of which may leave on the other side
//     clear   facets that reflect and transmit: for a solid body as Walter et al. (lobes/dielectric.hpp), for a sheet
//             mirrored through it with the same roughness (KHR_materials_transmission)
// All parts have the same facets (lobes/ggx.hpp). An iridescent film changes their Fresnel term (lobes/thin_film.hpp).
// Every part has its own repeated scattering, so that each is white by itself where its colours are white.
// lobes/layering.hpp says how much light a layer leaves for what is below it. The BSDF is reciprocal:
// f / (index on o's side)^2 is symmetric.
// Energy: layered_albedo_test and layered_furnace_test state the bounds, and what films of high index lose. Anisotropic
// facets have tables of their own (lobes/anisotropic_albedo.hpp), and their diffuse light is Lambertian; the repeated
// scattering of a body (lobes/dielectric_albedo.hpp) remains isotropic, at their mean roughness. White glass of any
// strength returns 0.98 to 1.01 of the light as a sheet, but 0.64 to 1.27 as a body near its horizon. Left out are
// light that a clearcoat reflects back to the base, the absorption of coats, sheen on the inside of bodies, and the
// change of a film's colours under repeated scattering.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "material/layered_surface.hpp"
#include "material/lobes/clearcoat.hpp"
#include "material/lobes/facets.hpp"
#include "material/lobes/layering.hpp"
#include "material/lobes/reflection.hpp"
#include "material/lobes/sheen.hpp"

#include "material/local_frame.hpp"

namespace gazetrace {

class LayeredBsdf {
 public:
  // wo.z > 0. DiffuseModel::matte has no layers.
  LayeredBsdf(const LayeredSurface& surface, const Vec3f& wo, DiffuseModel diffuse = DiffuseModel::burley) noexcept
      : s_(surface),
        wo_(wo),
        facets_(surface),
        lambertian_(diffuse != DiffuseModel::burley || facets_.anisotropic()),
        terms_(facets_.terms()),
        at_o_(terms_at(wo)),
        coat_frame_(surface.clearcoat_normal),
        coat_wo_(coat_frame_.to_local(wo)),
        coat_(surface.clearcoat, surface.clearcoat_roughness, coat_wo_.z),
        sheen_row_(albedo_row(std::clamp(surface.sheen_roughness, 0.0F, 1.0F))),
        sheen_o_(sheen_albedo(sheen_row_, std::clamp(wo.z, 0.0F, 1.0F))) {
    const float sheen = largest_channel(s_.sheen_color);
    has_coat_ = s_.clearcoat > 0;
    has_sheen_ = sheen > 0;
    if (has_coat_) {
      under_coat_ = {s_.inside ? 0.0F : coat_.albedo_o(), coat_.albedo_average()};
    }
    if (has_sheen_) {
      under_sheen_ = {s_.inside ? 0.0F : sheen * sheen_o_.kept,
                      sheen * interpolate_average(kAlbedoTables.sheen_average, sheen_row_)};
    }
    plain_ = s_.f0 == Vec3f{kDielectricF0, kDielectricF0, kDielectricF0} && s_.f90 == 1.0F && !(s_.film > 0) &&
             !facets_.anisotropic();
    film_f0_ = s_.film > 0 ? film_f0(kMiddle) : 0.0F;
    diffuse_o_ = diffuse_scale(wo.z, at_o_);
    if (is_bent()) {
      dielectric_row_ = dielectric_row(facets_.mean_roughness());
      const std::size_t side = s_.inside ? 1 : 0;
      lost_o_ = 1.0F - kept_at(*s_.dielectric, side, dielectric_row_, wo.z);
      lost_average_ = {1.0F - kept_average(*s_.dielectric, 0, dielectric_row_),
                       1.0F - kept_average(*s_.dielectric, 1, dielectric_row_)};
      lost_share_ = repeated_share(std::min(lost_average_[0], lost_average_[1]));
      // Both sides must exchange the same amount of light; see dielectric_albedo.hpp.
      const float square = s_.inside ? s_.ior * s_.ior : 1.0F;
      passed_ = s_.dielectric->passed_average * std::min(lost_average_[0], lost_average_[1]) /
                (std::max(lost_average_[side], 1e-7F) * square);
    }
    choose_probabilities();
  }

  // f |cosine| and its density; wi.z < 0 means light from the other side.
  [[nodiscard]] BsdfEval evaluate(const Vec3f& wi) const noexcept {
    BsdfEval result{{0, 0, 0}, 0};
    const bool through = wi.z < 0;
    const float cosine = std::fabs(wi.z);
    if (!(wo_.z > 0) || !(cosine > 0) || (through && !transmits())) {
      return result;
    }
    const Scale scale = layer_scale(wi, through);
    float pdf = 0;
    if (facet_probability_ > 0) {
      result.f_cos = facets_.value(wo_, wi, pdf) * (scale.narrow * cosine);
      result.pdf = facet_probability_ * pdf;
    }
    result.f_cos += broad(wi, through) * (scale.broad * cosine);
    result.pdf += (through ? through_probability_ : diffuse_probability_) * kInvPi * cosine;
    if (!through && !s_.inside) {
      if (has_sheen_) {
        const float raw_i = sheen_albedo(sheen_row_, std::clamp(cosine, 0.0F, 1.0F)).raw;
        const float value = sheen_value(wo_, wi, sheen_alpha(s_.sheen_roughness)) * sheen_gain(sheen_o_.raw, raw_i);
        result.f_cos += s_.sheen_color * (value * scale.coat * cosine);
        result.pdf += sheen_probability_ * 0.5F * kInvPi;
      }
      const Vec3f coat_wi = coat_frame_.to_local(wi);
      if (has_coat_ && coat_wo_.z > 0 && coat_wi.z > 0) {
        const float value = coat_.value(coat_wo_, coat_wi, pdf) * coat_wi.z;
        result.f_cos += Vec3f{value, value, value};
        result.pdf += coat_probability_ * pdf;
      }
    }
    return result;
  }

  // What the diffuse lobe, reflected or transmitted, has of evaluate(wi).f_cos.
  [[nodiscard]] Vec3f diffuse_f_cos(const Vec3f& wi) const noexcept {
    const bool through = wi.z < 0;
    const float cosine = std::fabs(wi.z);
    if (!(wo_.z > 0) || !(cosine > 0) || (through && !transmits()) || !(facets_.opaque() > 0)) {
      return {};
    }
    const Vec3f up{wi.x, wi.y, cosine};
    return diffuse(up, terms_at(up), through) * (layer_scale(wi, through).broad * cosine);
  }

  [[nodiscard]] BsdfSample sample(const Vec2f& u, float u_lobe) const noexcept {
    BsdfSample result;
    float left = u_lobe;
    const auto chosen = [&left](float probability) {
      if (left < probability) {
        left = std::min(left / probability, 0x1.fffffep-1F);
        return true;
      }
      left -= probability;
      return false;
    };
    bool found = wo_.z > 0;
    Vec3f wi;
    if (chosen(facet_probability_)) {
      found = found && facets_.sample(wo_, u, left, wi);
    } else if (chosen(diffuse_probability_)) {
      wi = sample_cosine_hemisphere(u);
    } else if (chosen(through_probability_)) {
      wi = sample_cosine_hemisphere(u);
      wi.z = -wi.z;
    } else if (chosen(sheen_probability_)) {
      wi = sample_uniform_hemisphere(u, cos_sin_2pi(u.x));
    } else if (coat_probability_ > 0) {
      const Vec3f coat_wi = coat_.sample(coat_wo_, u);
      wi = coat_frame_.to_world(coat_wi);
      found = found && wi.z > 0 && coat_wi.z > 0;  // a direction below either surface has no density
    } else {
      found = false;
    }
    if (!found) {
      return result;
    }
    const BsdfEval eval = evaluate(wi);
    result.direction = wi;
    result.pdf = eval.pdf;
    if (eval.pdf > 0 && std::isfinite(eval.pdf)) {
      result.weight = eval.f_cos * (1.0F / eval.pdf);
      result.valid = result.weight.x + result.weight.y + result.weight.z > 0;
    }
    return result;
  }

  [[nodiscard]] bool transmits() const noexcept {
    return facets_.clear() > 0 || (facets_.opaque() > 0 && s_.diffuse_transmission > 0);
  }

 private:
  static constexpr float kInvPi = static_cast<float>(1 / kPi);
  static constexpr float kMiddle = 0.7F;  // cosine of the angle at which a film's reflectance stands for its average

  struct Scale {
    float broad = 1, narrow = 1, coat = 1;  // for the base's broad and narrow lobes; for the sheen lobe
  };
  [[nodiscard]] bool is_bent() const noexcept { return s_.solid && facets_.clear() > 0 && s_.dielectric != nullptr; }

  // The layers of a body are on its outside, so light that stays inside does not meet them. A sheet has them on both
  // sides.
  [[nodiscard]] Scale layer_scale(const Vec3f& wi, bool through) const noexcept {
    Scale scale;
    if (!has_coat_ && !has_sheen_) {
      return scale;
    }
    const bool o_outside = !s_.solid || !s_.inside;
    const bool i_outside = !s_.solid || through == s_.inside;
    const auto apply = [&](const LayerAlbedo& layer, float albedo_i, float& broad, float& narrow) {
      if (o_outside && i_outside) {
        broad *= layer.broad(albedo_i);
        narrow *= layer.narrow(albedo_i);
      } else if (o_outside || i_outside) {
        const float left = 1.0F - (o_outside ? layer.o : albedo_i);
        broad *= left;
        narrow *= left;
      }
    };
    if (has_coat_) {
      float narrow = 1;
      apply(under_coat_, coat_.albedo(std::fabs(dot(wi, s_.clearcoat_normal))), scale.coat, narrow);
      scale.broad *= scale.coat;
      scale.narrow *= narrow;
    }
    if (has_sheen_) {
      const float albedo = sheen_albedo(sheen_row_, std::clamp(std::fabs(wi.z), 0.0F, 1.0F)).kept;
      apply(under_sheen_, largest_channel(s_.sheen_color) * albedo, scale.broad, scale.narrow);
    }
    return scale;
  }

  [[nodiscard]] AlbedoTerms terms_at(const Vec3f& v) const noexcept { return facets_.terms_at(terms_, v); }

  // The reflectance at normal incidence with which Schlick's formula gives what the film reflects at this angle; for
  // the strongest channel.
  [[nodiscard]] float film_f0(float cosine) const noexcept {
    const float at = std::clamp(cosine, 0.0F, 1.0F);
    const float rise = schlick_weight(at);
    const float f = largest_channel(facets_.opaque_fresnel(at));
    return std::clamp((f - rise) / std::max(1.0F - rise, 1e-3F), 0.0F, 1.0F);
  }
  // The total reflectance of the opaque part's facets, for the strongest channel.
  [[nodiscard]] float opaque_albedo(float cosine, const AlbedoTerms& terms) const noexcept {
    if (s_.film > 0) {
      // Approximated by Schlick's formula at the angle at which facets of this roughness are mostly seen.
      const float f0 = film_f0(cosine + (kMiddle - cosine) * std::min(s_.base.roughness, 1.0F));
      return terms_.albedo(terms, f0, 1.0F);
    }
    return terms_.albedo(terms, largest_channel(s_.f0), s_.f90);
  }
  // s of bsdf.hpp. For reflectances other than 0.04, the Lambertian form with Burley's correction for 0.04.
  [[nodiscard]] float diffuse_scale(float cosine, const AlbedoTerms& terms) const noexcept {
    if (plain_) {
      return lambertian_ ? terms.lambert : terms.burley;
    }
    const float average = s_.film > 0 ? terms_.albedo_average_of(film_f0_, 1.0F)
                                      : terms_.albedo_average_of(largest_channel(s_.f0), s_.f90);
    const float left = std::max(1.0F - opaque_albedo(cosine, terms), 0.0F) / std::sqrt(std::max(1.0F - average, 0.02F));
    return lambertian_ || terms.lambert < 1e-6F ? left : left * terms.burley / terms.lambert;
  }

  // The diffuse lobe, of an opaque part that is not nothing: f without the cosine. `up` is the direction, turned to the
  // side of the view.
  [[nodiscard]] Vec3f diffuse(const Vec3f& up, const AlbedoTerms& at_i, bool through) const noexcept {
    float shape = 1;
    if (!lambertian_) {
      const float t = s_.base.roughness * (1.0F + dot(wo_, up)) - 0.5F;
      shape = (1.0F + t * schlick_weight(wo_.z)) * (1.0F + t * schlick_weight(up.z));
    }
    return diffuse_color(through) * (facets_.opaque() * diffuse_o_ * diffuse_scale(up.z, at_i) * shape * kInvPi);
  }

  // The lobes over the whole hemisphere, diffuse light and repeated scattering: f without the cosine.
  [[nodiscard]] Vec3f broad(const Vec3f& wi, bool through) const noexcept {
    const Vec3f up{wi.x, wi.y, std::fabs(wi.z)};
    const AlbedoTerms at_i = terms_at(up);
    Vec3f f{0, 0, 0};
    if (facets_.opaque() > 0) {
      f += diffuse(up, at_i, through);
    }
    const float repeated = terms_.repeated_lobe(at_o_.e, at_i.e);
    if (!through) {
      f += repeated_color() * repeated;
    } else if (facets_.clear() > 0 && !s_.solid) {
      f += s_.base.base_color * (facets_.clear() * sheet_passed() * repeated);
    }
    if (is_bent()) {
      const std::size_t side = s_.inside != through ? 1 : 0;  // the side of wi
      const float average = lost_average_[side];
      const float lost_i = 1.0F - kept_at(*s_.dielectric, side, dielectric_row_, up.z);
      const float lobe = facets_.clear() * lost_o_ * lost_i * lost_share_ * kInvPi / std::max(average, 1e-7F);
      if (through) {
        f += s_.base.base_color * (lobe * passed_ / (facets_.eta() * facets_.eta()));
      } else {
        const float kept = lobe * (1.0F - passed_);
        f += Vec3f{kept, kept, kept};
      }
    }
    return f;
  }

  // The colour of diffuse light into a denser body, and of the smaller share that gets out again, which keeps f
  // reciprocal.
  [[nodiscard]] Vec3f diffuse_color(bool through) const noexcept {
    const float share = s_.diffuse_transmission;
    const Vec3f passed = s_.diffuse_transmission_color * share;
    const float n2 = s_.solid ? s_.ior * s_.ior : 1.0F;
    if (through) {
      return s_.inside ? passed : passed * (1.0F / n2);
    }
    const Vec3f reflected = s_.base.base_color * (1.0F - share);
    return s_.inside ? reflected + passed * (1.0F - 1.0F / n2) : reflected;
  }

  // The reflectance of the repeated-scattering lobe, without the clear part of a body.
  [[nodiscard]] Vec3f repeated_color() const noexcept {
    Vec3f color{0, 0, 0};
    const auto repeated = [&](const Vec3f& f0, float f90) {
      return Vec3f{terms_.repeated(f0.x, f90), terms_.repeated(f0.y, f90), terms_.repeated(f0.z, f90)};
    };
    const bool film = s_.film > 0;
    if (facets_.metal() > 0) {
      color += (film ? repeated(facets_.metal_fresnel(kMiddle), 1.0F) : repeated(s_.base.base_color, 1.0F)) *
               facets_.metal();
    }
    const float sheets = facets_.opaque() + (s_.solid ? 0.0F : facets_.clear());
    if (sheets > 0) {
      color += (film ? repeated(facets_.opaque_fresnel(kMiddle), 1.0F) : repeated(s_.f0, s_.f90)) * sheets;
    }
    return color;
  }
  // For the clear part of a sheet: what repeated scattering does not reflect is transmitted.
  [[nodiscard]] float sheet_passed() const noexcept {
    const float lost_average = 1.0F - terms_.e_average;
    return std::max(repeated_share(lost_average) - terms_.repeated(largest_channel(s_.f0), s_.f90), 0.0F);
  }

  // In proportion to the light of each lobe, as far as it is known from the view direction alone.
  void choose_probabilities() noexcept {
    const float coat = has_coat_ ? under_coat_.o : 0.0F;
    const float sheen = has_sheen_ ? under_sheen_.o : 0.0F;
    const float base = std::max((1.0F - coat) * (1.0F - sheen), 1e-3F);
    const Vec3f ones{1, 1, 1};
    const float f_metal = luminance(s_.base.base_color * (at_o_.e - at_o_.b) + ones * at_o_.b);
    const float f_opaque = luminance(s_.f0) * (at_o_.e - at_o_.b) + s_.f90 * at_o_.b;
    float facets = facets_.metal() * f_metal + facets_.opaque() * f_opaque;
    if (s_.film > 0) {
      facets = (facets_.metal() * luminance(facets_.metal_fresnel(wo_.z)) +
                facets_.opaque() * luminance(facets_.opaque_fresnel(wo_.z))) *
               at_o_.e;
    }
    facets += facets_.clear() * (is_bent() ? 1.0F - lost_o_ : at_o_.e);
    const float left = facets_.opaque() * (1.0F - std::min(opaque_albedo(wo_.z, at_o_), 1.0F));
    const float lost = 1.0F - at_o_.e;
    float diffuse = left * luminance(diffuse_color(false)) + lost * luminance(repeated_color());
    float through = left * luminance(s_.diffuse_transmission_color) * s_.diffuse_transmission;
    if (facets_.clear() > 0 && !s_.solid) {
      through += facets_.clear() * luminance(s_.base.base_color) * lost * sheet_passed();
    }
    if (is_bent()) {
      diffuse += facets_.clear() * lost_o_ * (1.0F - passed_);
      through += facets_.clear() * lost_o_ * passed_ * luminance(s_.base.base_color);
    }
    coat_probability_ = s_.inside ? 0.0F : coat;
    sheen_probability_ = s_.inside ? 0.0F : (1.0F - coat) * luminance(s_.sheen_color) * sheen_o_.kept;
    facet_probability_ = base * facets;
    // The repeated scattering of a coat is sampled by the diffuse lobe.
    diffuse_probability_ = base * diffuse + 0.05F * coat_probability_ * s_.clearcoat_roughness;
    through_probability_ = base * through;
    const float sum =
        coat_probability_ + sheen_probability_ + facet_probability_ + diffuse_probability_ + through_probability_;
    const float scale = sum > 0 ? 1.0F / sum : 0.0F;
    coat_probability_ *= scale;
    sheen_probability_ *= scale;
    facet_probability_ *= scale;
    diffuse_probability_ *= scale;
    through_probability_ *= scale;
  }

  LayeredSurface s_;
  Vec3f wo_;
  Facets facets_;
  bool lambertian_;  // Burley's shape needs a single roughness, so anisotropic surfaces are Lambertian
  FacetTerms terms_;
  AlbedoTerms at_o_;
  LocalFrame coat_frame_;
  Vec3f coat_wo_;
  ClearcoatLobe coat_;
  AlbedoRow sheen_row_;
  SheenAlbedo sheen_o_;
  bool has_coat_ = false, has_sheen_ = false, plain_ = true;
  LayerAlbedo under_coat_, under_sheen_;
  float diffuse_o_ = 0, film_f0_ = 0;
  DielectricRow dielectric_row_{0, 0};
  float lost_o_ = 0, lost_share_ = 0, passed_ = 0;
  std::array<float, 2> lost_average_{};
  float coat_probability_ = 0, sheen_probability_ = 0, facet_probability_ = 0, diffuse_probability_ = 0,
        through_probability_ = 0;
};

}  // namespace gazetrace
