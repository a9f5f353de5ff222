// SPDX-License-Identifier: Apache-2.0
// Interference in a thin film on the base (KHR_materials_iridescence): Belcour and Barla, "A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence", SIGGRAPH 2017, for dielectrics as glTF states it: air
// over a film of index n over a base with normal reflectance f0.
//   R(phase) = C0 + 2 sum_m Cm cos(m phase),   C0 = R12 + Rs,  Cm = sqrt(R12 R23)^m (Rs - T121),
//   Rs = T121^2 R23 / (1 - R12 R23)
// R12, R23: reflectances of the film's top (Fresnel) and bottom (Schlick), T121 = 1 - R12, phase = 2 pi (2 n d cos) /
// lambda + phi. The sum over wavelengths has a closed form because the colour matching functions are fitted by
// Gaussians (the paper's eq. 9 and its fit); m runs to 2. Below 30 nm the index of the film fades to that of air. A
// film of air shows the bare base at every angle; with Schlick's formula for the top it would not, since that reflects
// at grazing angles whatever the index.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "gazetrace/math.hpp"
#include "material/lobes/dielectric.hpp"
#include "material/microfacet.hpp"

namespace gazetrace {

namespace thin_film_detail {

inline constexpr float kPiF = static_cast<float>(kPi);

// The Fourier transforms of the XYZ matching functions at an optical path difference in nm, with a phase shift for each
// channel of the base, converted to Rec.709.
inline Vec3f sensitivity(float path_nm, const Vec3f& shift) {
  const float phase = 2.0F * kPiF * path_nm * 1e-9F;
  struct Gaussian {
    float value, position, variance;
  };
  constexpr Gaussian kX{5.4856e-13F, 1.6810e6F, 4.3278e9F};
  constexpr Gaussian kX2{9.7470e-14F, 2.2399e6F, 4.5282e9F};
  constexpr Gaussian kY{4.4201e-13F, 1.7953e6F, 9.3046e9F};
  constexpr Gaussian kZ{5.2481e-13F, 2.2084e6F, 6.6121e9F};
  const auto at = [phase](const Gaussian& g, float s) {
    return g.value * std::sqrt(2.0F * kPiF * g.variance) * std::cos(g.position * phase + s) *
           std::exp(-phase * phase * g.variance) / 1.0685e-7F;
  };
  const float x = at(kX, shift.x) + at(kX2, shift.x);
  const float y = at(kY, shift.y);
  const float z = at(kZ, shift.z);
  return {3.2404542F * x - 1.5371385F * y - 0.4985314F * z, -0.9692660F * x + 1.8760108F * y + 0.0415560F * z,
          0.0556434F * x - 0.2040259F * y + 1.0572252F * z};
}

}  // namespace thin_film_detail

// The reflectance at an angle of `cosine` (in air). `base_f0` is that of the surface below at normal incidence in air.
inline Vec3f thin_film_fresnel(float cosine, float film_ior, float thickness_nm, const Vec3f& base_f0) {
  const float fade = std::clamp(thickness_nm / 30.0F, 0.0F, 1.0F);
  const float smooth = fade * fade * (3.0F - 2.0F * fade);
  const float eta = 1.0F + (film_ior - 1.0F) * smooth;
  const float sin2 = (1.0F - cosine * cosine) / (eta * eta);
  const float inside = std::sqrt(std::max(1.0F - sin2, 0.0F));

  const float r12 = fresnel_dielectric(std::clamp(cosine, 0.0F, 1.0F), eta);
  const float t121 = 1.0F - r12;
  const float phi12 = eta < 1.0F ? thin_film_detail::kPiF : 0.0F;
  const float phi21 = thin_film_detail::kPiF - phi12;
  const float path_nm = 2.0F * eta * thickness_nm * inside;

  struct Bottom {
    float r, phi;
  };
  const auto bottom = [&](float f0) -> Bottom {
    const float root = std::sqrt(std::clamp(f0, 0.0F, 0.9999F));
    const float base = (1.0F + root) / (1.0F - root);  // the index that gives f0 in air
    const float r = (base - eta) / (base + eta);
    return {r * r + (1.0F - r * r) * schlick_weight(inside), base < eta ? thin_film_detail::kPiF : 0.0F};
  };
  const std::array<Bottom, 3> b{bottom(base_f0.x), bottom(base_f0.y), bottom(base_f0.z)};
  const Vec3f phi{phi21 + b[0].phi, phi21 + b[1].phi, phi21 + b[2].phi};
  const Vec3f r23{b[0].r, b[1].r, b[2].r};
  const auto each = [](const Vec3f& v, const auto& f) { return Vec3f{f(v.x), f(v.y), f(v.z)}; };
  const Vec3f r123 = each(r23, [&](float r) { return std::clamp(r12 * r, 0.0F, 0.9999F); });
  const Vec3f root = each(r123, [](float r) { return std::sqrt(r); });
  const Vec3f rs{t121 * t121 * r23.x / (1.0F - r123.x), t121 * t121 * r23.y / (1.0F - r123.y),
                 t121 * t121 * r23.z / (1.0F - r123.z)};
  Vec3f sum = rs + Vec3f{r12, r12, r12};
  Vec3f c = rs - Vec3f{t121, t121, t121};
  for (int m = 1; m <= 2; ++m) {
    c *= root;
    sum += c * thin_film_detail::sensitivity(static_cast<float>(m) * path_nm, phi * static_cast<float>(m)) * 2.0F;
  }
  return each(sum, [](float r) { return std::clamp(r, 0.0F, 1.0F); });
}

}  // namespace gazetrace
