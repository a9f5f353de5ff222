// SPDX-License-Identifier: Apache-2.0
// GGX (Trowbridge-Reitz) microfacets with height-correlated Smith masking, in a frame whose z is the normal.
//   D(h)      = 1 / (pi alpha^2 ((h.x^2 + h.y^2) / alpha^2 + h.z^2)^2)
//   G2/(4 o i) = 0.5 / (o.z L(i) + i.z L(o)),  L(v) = sqrt(alpha^2 (1 - v.z^2) + v.z^2)
// (Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014, eqs. 71, 72, 99.) D is computed from h.x and
// h.y, not from 1 - h.z^2, which has no digits left where alpha is small. The functions are templates over the scalar,
// so that tests can differentiate the same mapping in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/fast_math.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Surfaces of a roughness below 0.0224 are rendered with this alpha (a lobe 0.06 degrees wide). A mirror is then an
// ordinary lobe that light sampling and MIS can handle, and nothing divides by zero.
inline constexpr double kAlphaMin = 5e-4;

template <class T>
T alpha_of_roughness(T roughness) noexcept {
  return std::max(roughness * roughness, T(kAlphaMin));
}

template <class T>
T ggx_distribution(const Vec3<T>& h, T alpha) noexcept {
  const T a2 = alpha * alpha;
  const T tangent = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
  return T(1 / kPi) / (a2 * tangent * tangent);
}

// L(v) of the comment above; Smith's G1 = 2 cos / (cos + L).
template <class T>
T smith_length(T cosine, T alpha2) noexcept {
  return std::sqrt(alpha2 + (T(1) - alpha2) * cosine * cosine);
}

// A half-vector distributed as the visible normals of `wo` (Dupuy and Benyoub, "Sampling Visible GGX Normals with
// Spherical Caps", 2023, listing 3), from a point on the cap of reflected directions in the stretched space of unit
// roughness.
template <class T>
[[gnu::always_inline]] inline Vec3<T> sample_visible_normal(const Vec3<T>& wo, T alpha, const Vec2<T>& u) noexcept {
  const Vec3<T> stretched = normalize(Vec3<T>{wo.x * alpha, wo.y * alpha, wo.z});
  // The half-vector's z is the sum (1 - u.y) (1 + stretched.z): never zero, and exact where the cap's own z is near -1.
  const T rise = (T(1) - u.y) * (T(1) + stretched.z);
  const T z = rise - stretched.z;
  const T radius = std::sqrt(std::max((T(1) - z) * (T(1) + z), T(0)));
  const Vec2<T> circle = cos_sin_2pi(u.x);
  const Vec3<T> half{radius * circle.x + stretched.x, radius * circle.y + stretched.y, rise};
  return normalize(Vec3<T>{half.x * alpha, half.y * alpha, half.z});
}

template <class T>
Vec3<T> reflect(const Vec3<T>& wo, const Vec3<T>& h) noexcept {
  return h * (T(2) * dot(wo, h)) - wo;
}

// The density of reflect(wo, sample_visible_normal(...)) over solid angle: G1(wo) D(h) / (4 wo.z).
template <class T>
T visible_reflection_pdf(T wo_z, T smith_o, T distribution) noexcept {
  return distribution * T(0.5) / (wo_z + smith_o);
}

// Schlick 1994: F = f0 + (1 - f0) schlick_weight(cos).
template <class T>
T schlick_weight(T cosine) noexcept {
  const T m = std::clamp(T(1) - cosine, T(0), T(1));
  const T m2 = m * m;
  return m2 * m2 * m;
}

template <class T>
Vec3<T> sample_cosine_hemisphere(const Vec2<T>& u) noexcept {
  const T radius = std::sqrt(u.y);
  const Vec2<T> circle = cos_sin_2pi(u.x);
  return {radius * circle.x, radius * circle.y, std::sqrt(T(1) - u.y)};
}

}  // namespace gazetrace
