// SPDX-License-Identifier: Apache-2.0
// Cloth (KHR_materials_sheen): fibres that stand upright and are seen at the edges.
//   f = colour D(h) / (4 o.z i.z (1 + Lambda(o) + Lambda(i))),  D(h) = (2 + 1/a) sin(theta_h)^(1/a) / (2 pi)
// (Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, eqs. 2 and 3; a = roughness^2.) Lambda is
// their fit, table 1; their softened terminator is left out because it is not reciprocal. A roughness below
// kLeastSheenRoughness is raised to it, since the lobe would shrink to a line of light at the horizon. As stated by its
// authors, the lobe returns up to 2.7 times the light it receives near the horizon at a roughness below about 0.3;
// sheen_gain scales it there, symmetrically, so that no direction returns more than it receives. How much light is left
// for the layer below comes from a table, see layered_bsdf.hpp. The lobe is sampled uniformly over the hemisphere.
#pragma once

#include <algorithm>
#include <cmath>

#include "gazetrace/math.hpp"

namespace gazetrace {

inline constexpr double kLeastSheenRoughness = 0.07;

template <class T>
T sheen_alpha(T roughness) noexcept {
  const T r = std::max(roughness, T(kLeastSheenRoughness));
  return r * r;
}

template <class T>
T sheen_lambda(T cosine, T alpha) noexcept {
  const T t = (T(1) - alpha) * (T(1) - alpha);
  const auto mix = [t](double smooth, double rough) { return T(rough) + (T(smooth) - T(rough)) * t; };
  const T a = mix(25.3245, 21.5473);
  const T b = mix(3.32435, 3.82987);
  const T c = mix(0.16801, 0.19823);
  const T d = mix(-1.27393, -1.97760);
  const T e = mix(-4.85967, -4.32054);
  const auto fit = [&](T x) { return a / (T(1) + b * std::pow(x, c)) + d * x + e; };
  return cosine < T(0.5) ? std::exp(fit(cosine)) : std::exp(T(2) * fit(T(0.5)) - fit(T(1) - cosine));
}

// f for colour 1; both directions above the surface.
template <class T>
T sheen_value(const Vec3<T>& wo, const Vec3<T>& wi, T alpha) noexcept {
  const Vec3<T> h = normalize(wo + wi);
  const T sin2 = std::max(h.x * h.x + h.y * h.y, T(0));
  const T distribution = (T(2) + T(1) / alpha) * std::pow(sin2, T(0.5) / alpha) * T(0.5 / kPi);
  const T masking = T(1) + sheen_lambda(wo.z, alpha) + sheen_lambda(wi.z, alpha);
  return distribution / (T(4) * std::max(wo.z * wi.z, T(1e-7)) * masking);
}

// `raw_o`, `raw_i`: directional albedos of the lobe as its authors state it, from the table.
template <class T>
T sheen_gain(T raw_o, T raw_i) noexcept {
  return T(1) / std::max(T(1), std::max(raw_o, raw_i));
}

template <class T>
Vec3<T> sample_uniform_hemisphere(const Vec2<T>& u, const Vec2<T>& circle) noexcept {
  const T z = T(1) - u.y;
  const T radius = std::sqrt(std::max(u.y * (T(2) - u.y), T(0)));
  return {radius * circle.x, radius * circle.y, z};
}

}  // namespace gazetrace
