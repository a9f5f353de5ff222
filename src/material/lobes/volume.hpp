// SPDX-License-Identifier: Apache-2.0
// KHR_materials_volume: absorption along a path of length t inside a body (Beer-Lambert),
//   transmittance(t) = c^(t / d) = exp(-sigma t),  sigma = -ln(c) / d
// with c the attenuation colour and d its distance. c = 0 is opaque after any distance; the least value of c avoids
// 0 * infinity.
#pragma once

#include <algorithm>
#include <cmath>

#include "gazetrace/material.hpp"

namespace gazetrace {

inline Vec3f absorption_per_m(const VolumeParameters& volume) {
  const auto sigma = [&](float c) {
    return -std::log(std::clamp(c, 1e-6F, 1.0F)) / std::max(volume.attenuation_distance_m, 1e-20F);
  };
  const Vec3f& c = volume.attenuation_color;
  return {sigma(c.x), sigma(c.y), sigma(c.z)};
}

// An infinite length occurs for light from outside a body that is not closed; with any absorption nothing arrives.
inline Vec3f transmittance(const Vec3f& sigma, float length_m) {
  const auto one = [&](float s) { return s > 0 ? std::exp(-s * length_m) : 1.0F; };
  return {one(sigma.x), one(sigma.y), one(sigma.z)};
}

}  // namespace gazetrace
