// SPDX-License-Identifier: Apache-2.0
// Orthonormal frames whose z axis is a given normal.
#pragma once

#include <cmath>

#include "gazetrace/math.hpp"

namespace gazetrace {

// A frame about a unit normal, made without a branch (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT
// 6(1), 2017).
struct LocalFrame {
  Vec3f s, t, n;
  explicit LocalFrame(const Vec3f& normal) : n(normal) {
    const float sign = std::copysign(1.0F, normal.z);
    const float a = -1.0F / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    s = {1.0F + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    t = {b, sign + normal.y * normal.y * a, -normal.y};
  }
  // A frame with s along the part of `tangent` that is perpendicular to the normal; any frame where there is none.
  static LocalFrame along(const Vec3f& normal, const Vec3f& tangent) {
    LocalFrame frame(normal);
    const Vec3f in_plane = tangent - normal * dot(tangent, normal);
    const float len2 = dot(in_plane, in_plane);
    if (len2 > 1e-12F) {
      frame.s = in_plane * (1.0F / std::sqrt(len2));
      frame.t = cross(normal, frame.s);
    }
    return frame;
  }
  [[nodiscard]] Vec3f to_local(const Vec3f& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
  [[nodiscard]] Vec3f to_world(const Vec3f& v) const { return s * v.x + t * v.y + n * v.z; }
};

}  // namespace gazetrace
