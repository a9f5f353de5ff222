// SPDX-License-Identifier: Apache-2.0
// GGX facets whose slopes differ along x and y, with height-correlated Smith masking; z is the normal.
//   D(h) = 1 / (pi ax ay ((h.x / ax)^2 + (h.y / ay)^2 + h.z^2)^2)
//   G2   = 1 / (1 + Lambda(o) + Lambda(i)) = 2 |o.z| |i.z| / (|o.z| L(i) + |i.z| L(o)),
//   L(v) = sqrt((ax v.x)^2 + (ay v.y)^2 + v.z^2)
// (Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014, eqs. 85-87 and 99; the same G2 with |v.z| is
// used for transmitted light.) Visible normals are sampled as in microfacet.hpp (Dupuy and Benyoub 2023).
// KHR_materials_anisotropy: alpha becomes mix(alpha, 1, strength^2) along the tangent, and stays alpha across it.
#pragma once

#include "material/microfacet.hpp"

namespace gazetrace {

template <class T>
struct GgxAlpha {
  T x, y;
};

template <class T>
GgxAlpha<T> anisotropic_alpha(T roughness, T strength) noexcept {
  const T alpha = alpha_of_roughness(roughness);
  return {alpha + (T(1) - alpha) * strength * strength, alpha};
}

template <class T>
T ggx_distribution(const Vec3<T>& h, const GgxAlpha<T>& a) noexcept {
  const T x = h.x / a.x;
  const T y = h.y / a.y;
  const T tangent = x * x + y * y + h.z * h.z;
  return T(1 / kPi) / (a.x * a.y * tangent * tangent);
}

template <class T>
T smith_length(const Vec3<T>& v, const GgxAlpha<T>& a) noexcept {
  const T x = a.x * v.x;
  const T y = a.y * v.y;
  return std::sqrt(x * x + y * y + v.z * v.z);
}

template <class T>
Vec3<T> sample_visible_normal(const Vec3<T>& wo, const GgxAlpha<T>& a, const Vec2<T>& u) noexcept {
  const Vec3<T> stretched = normalize(Vec3<T>{wo.x * a.x, wo.y * a.y, wo.z});
  const T rise = (T(1) - u.y) * (T(1) + stretched.z);
  const T z = rise - stretched.z;
  const T radius = std::sqrt(std::max((T(1) - z) * (T(1) + z), T(0)));
  const Vec2<T> circle = cos_sin_2pi(u.x);
  return normalize(Vec3<T>{(radius * circle.x + stretched.x) * a.x, (radius * circle.y + stretched.y) * a.y, rise});
}

// The density of the visible normal itself: G1(o) (o.h) D(h) / o.z.
template <class T>
T visible_normal_pdf(T o_dot_h, T wo_z, T smith_o, T distribution) noexcept {
  return T(2) * o_dot_h * distribution / (wo_z + smith_o);
}

}  // namespace gazetrace
