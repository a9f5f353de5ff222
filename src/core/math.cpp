// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/math.hpp"

namespace gazetrace {

Quatd normalize(const Quatd& q) {
  const double len = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return len > 0 ? Quatd{q.x / len, q.y / len, q.z / len, q.w / len} : Quatd{};
}

Quatd operator*(const Quatd& a, const Quatd& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Vec3d rotate(const Quatd& q, const Vec3d& v) {
  const Vec3d u{q.x, q.y, q.z};
  const Vec3d t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

Quatd slerp(const Quatd& a, const Quatd& b, double t) {
  const double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  const double sign = cosine < 0 ? -1.0 : 1.0;
  const Quatd c{sign * b.x, sign * b.y, sign * b.z, sign * b.w};
  const Quatd d{c.x - a.x, c.y - a.y, c.z - a.z, c.w - a.w};
  const Quatd s{c.x + a.x, c.y + a.y, c.z + a.z, c.w + a.w};
  const double chord = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w);
  const double across = std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z + s.w * s.w);
  const double angle = 2.0 * std::atan2(chord, across);
  double wa = 1.0 - t;
  double wb = t;
  if (angle > 1e-9) {
    const double inv = 1.0 / std::sin(angle);
    wa = std::sin((1.0 - t) * angle) * inv;
    wb = std::sin(t * angle) * inv;
  }
  return normalize(Quatd{wa * a.x + wb * c.x, wa * a.y + wb * c.y, wa * a.z + wb * c.z, wa * a.w + wb * c.w});
}

Affine operator*(const Affine& a, const Affine& b) {
  return {transform_vector(a, b.x), transform_vector(a, b.y), transform_vector(a, b.z), transform_point(a, b.t)};
}

Affine make_affine(const Vec3d& translation, const Quatd& rotation, const Vec3d& scale) {
  return {rotate(rotation, {scale.x, 0, 0}), rotate(rotation, {0, scale.y, 0}), rotate(rotation, {0, 0, scale.z}),
          translation};
}

double determinant(const Affine& a) {
  return dot(a.x, cross(a.y, a.z));
}

Quatd rotation_of(const Affine& a) {
  const Vec3d z = normalize(a.z);
  const Vec3d y = normalize(a.y - z * dot(a.y, z));
  const Vec3d x = cross(y, z);
  // Shepperd's method divides by the largest of the four components.
  const double trace = x.x + y.y + z.z;
  if (trace > 0) {
    const double s = 2.0 * std::sqrt(trace + 1.0);
    return normalize(Quatd{(y.z - z.y) / s, (z.x - x.z) / s, (x.y - y.x) / s, 0.25 * s});
  }
  if (x.x > y.y && x.x > z.z) {
    const double s = 2.0 * std::sqrt(1.0 + x.x - y.y - z.z);
    return normalize(Quatd{0.25 * s, (x.y + y.x) / s, (z.x + x.z) / s, (y.z - z.y) / s});
  }
  if (y.y > z.z) {
    const double s = 2.0 * std::sqrt(1.0 + y.y - x.x - z.z);
    return normalize(Quatd{(x.y + y.x) / s, 0.25 * s, (y.z + z.y) / s, (z.x - x.z) / s});
  }
  const double s = 2.0 * std::sqrt(1.0 + z.z - x.x - y.y);
  return normalize(Quatd{(z.x + x.z) / s, (y.z + z.y) / s, 0.25 * s, (x.y - y.x) / s});
}

}  // namespace gazetrace
