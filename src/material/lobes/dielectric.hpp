// SPDX-License-Identifier: Apache-2.0
// Refraction through the rough surface of a solid body.
//   f = |i.h| |o.h| / (|i.z| |o.z|) (1 - F) G2 D(h) / (o.h + eta i.h)^2,   h = +-normalize(o + eta i)
// (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eqs. 16, 17 and 21), with eta =
// index on i's side / index on o's side. This is f for radiance: light that enters a denser medium is squeezed into a
// smaller angle, so that f eta^2 conserves flux and f / (index on o's side)^2 is symmetric in o and i.
// F is Fresnel's own formula for unpolarised light.
#pragma once

#include <algorithm>
#include <cmath>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Indices nearer to 1 bend light by less than the rounding error of the half-vector, so the surface has no effect.
inline constexpr float kLeastIor = 1.001F;

// Facets mask each other even where light does not bend, which would make the surface of a body of index 1 visible.
// Below 1.05 the roughness therefore fades out with the index, so that such a body vanishes as KHR_materials_ior
// requires.
inline float roughness_of_body(float roughness, float ior) noexcept {
  return roughness * std::clamp((ior - 1.0F) / 0.05F, 0.0F, 1.0F);
}

// Fresnel reflectance for light that meets a medium of relative index eta at an angle of `cosine` >= 0; 1 beyond the
// critical angle.
template <class T>
T fresnel_dielectric(T cosine, T eta) noexcept {
  const T sin2 = (T(1) - cosine * cosine) / (eta * eta);
  if (sin2 >= T(1)) {
    return T(1);
  }
  const T through = std::sqrt(T(1) - sin2);
  const T parallel = (eta * cosine - through) / (eta * cosine + through);
  const T perpendicular = (cosine - eta * through) / (cosine + eta * through);
  return T(0.5) * (parallel * parallel + perpendicular * perpendicular);
}

// Refracts about `h` (o.h > 0) by Snell's law; false where there is total reflection.
template <class T>
bool refract(const Vec3<T>& wo, const Vec3<T>& h, T eta, Vec3<T>& wi) noexcept {
  const T cosine = dot(wo, h);
  const T sin2 = (T(1) - cosine * cosine) / (eta * eta);
  if (sin2 >= T(1)) {
    return false;
  }
  wi = normalize(h * (cosine / eta - std::sqrt(T(1) - sin2)) - wo / eta);
  return true;
}

// The normal, on the side of +z, of the facet that refracts o to i; of length zero where eta is 1 and o is opposite to
// i.
template <class T>
Vec3<T> refraction_half_vector(const Vec3<T>& wo, const Vec3<T>& wi, T eta) noexcept {
  const Vec3<T> h = normalize(wo + wi * eta);
  return h.z < T(0) ? -h : h;
}

// |dh / di|, which converts the density of h to that of the refracted direction.
template <class T>
T refraction_jacobian(T o_dot_h, T i_dot_h, T eta) noexcept {
  const T s = o_dot_h + eta * i_dot_h;
  return eta * eta * std::fabs(i_dot_h) / (s * s);
}

}  // namespace gazetrace
