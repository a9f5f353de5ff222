// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "gazetrace/camera.hpp"

namespace gazetrace {
namespace {

// Axes in the order of application.
std::array<int, 3> axes_of(RotationOrder order) {
  switch (order) {
    case RotationOrder::xyz:
      return {0, 1, 2};
    case RotationOrder::xzy:
      return {0, 2, 1};
    case RotationOrder::yxz:
      return {1, 0, 2};
    case RotationOrder::yzx:
      return {1, 2, 0};
    case RotationOrder::zxy:
      return {2, 0, 1};
    case RotationOrder::zyx:
      return {2, 1, 0};
  }
  return {2, 0, 1};
}

Quatd turn_about(int axis, double angle_rad) {
  const double s = std::sin(0.5 * angle_rad);
  return {axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0, std::cos(0.5 * angle_rad)};
}

double component(const Vec3d& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

Vec3d unit(int axis) {
  return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

// Row r, column c of the rotation's matrix.
double entry(const Quatd& q, int r, int c) {
  return component(rotate(q, unit(c)), r);
}

}  // namespace

Quatd quaternion_of_euler(const Vec3d& angles_rad, RotationOrder order) {
  const auto [i, j, k] = axes_of(order);
  return normalize(turn_about(k, component(angles_rad, k)) * turn_about(j, component(angles_rad, j)) *
                   turn_about(i, component(angles_rad, i)));
}

// M = Rk(c) Rj(b) Ri(a). Row k of M does not depend on c: (k,i) = -e sin b, (k,j) = e cos b sin a, (k,k) = cos b cos a,
// with e = 1 where i, j, k follow each other cyclically and -1 otherwise. Once `a` is known its rotation is undone, and
// b and c come from what is left. An inexact `a` near b = 90 degrees then does no harm, since c makes up for it.
Vec3d euler_of_quaternion(const Quatd& rotation, RotationOrder order) {
  const auto [i, j, k] = axes_of(order);
  const double e = (i + 1) % 3 == j ? 1.0 : -1.0;
  const double a = std::atan2(e * entry(rotation, k, j), entry(rotation, k, k));
  const Quatd rest = normalize(rotation * turn_about(i, -a));
  const double b = std::atan2(-e * entry(rest, k, i), entry(rest, k, k));
  const double c = std::atan2(-e * entry(rest, i, j), entry(rest, j, j));
  const auto angle = [&, i = i, j = j](int axis) { return axis == i ? a : axis == j ? b : c; };
  return {angle(0), angle(1), angle(2)};
}

}  // namespace gazetrace
