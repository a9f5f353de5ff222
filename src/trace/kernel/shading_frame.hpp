// SPDX-License-Identifier: Apache-2.0
// Geometry of a hit: bent normals, and ray origins that clear their surface.
#pragma once

#include <algorithm>
#include <cmath>

#include "gazetrace/math.hpp"
#include "material/local_frame.hpp"

namespace gazetrace {

inline Vec3f fast_normalize(const Vec3f& v) {
  return v * (1.0F / std::sqrt(dot(v, v)));
}

// The shading normal nearest to the given one (in the plane of view and normal) whose mirror direction stays above the
// geometric surface, which avoids black fringes and light from behind (Keller et al., "The Iray Light Transport
// Simulation and Rendering System", 2017, section A.3). All vectors are of unit length; `geometric` is on the viewer's
// side.
inline Vec3f bend_normal(const Vec3f& shading, const Vec3f& geometric, const Vec3f& view) {
  const float cosine = dot(shading, view);
  const Vec3f mirrored = shading * (2.0F * cosine) - view;
  const float height = dot(mirrored, geometric);
  // The lowest mirror direction that is allowed; lower where the view itself is at a grazing angle.
  const float least = std::min(0.01F, 0.5F * dot(view, geometric));
  const bool keep = (static_cast<int>(cosine > 0) & static_cast<int>(height >= least)) != 0;
  const Vec3f raised = mirrored + geometric * (least - height);
  const Vec3f bent = raised * (1.0F / std::sqrt(std::max(dot(raised, raised), 1e-20F))) + view;
  const float len2 = dot(bent, bent);
  const bool sound = len2 > 1e-12F;
  const float scale = 1.0F / std::sqrt(sound ? len2 : 1.0F);
  const auto choose = [&](float kept, float bent_one, float flat) {
    const float other = sound ? bent_one * scale : flat;
    return keep ? kept : other;
  };
  return {choose(shading.x, bent.x, geometric.x), choose(shading.y, bent.y, geometric.y),
          choose(shading.z, bent.z, geometric.z)};
}

// Points on a triangle have rounding errors of a few ulps of its coordinates (from interpolation, and from the ray
// library's own edge tests). An origin that is this far along the geometric normal clears them at any scale. What
// counts is the error across the triangle: each axis's largest coordinate times the normal's component along it, so
// that on large level ground the offset does not exceed what stands on it; and the coordinates of the point from which
// the ray starts. This is the idea of Waechter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection"
// (Ray Tracing Gems, 2019, chapter 6), with the ulp taken from the triangle, so that there is no absolute constant.
inline constexpr float kOffsetUlps = 0x1p-19F;

inline float largest(const Vec3f& a) {
  return std::max(std::max(std::fabs(a.x), std::fabs(a.y)), std::fabs(a.z));
}

}  // namespace gazetrace
