// SPDX-License-Identifier: Apache-2.0
// SMPTE RP 177 (from primaries and white to a matrix); Lam 1985 for Bradford's matrix.
#include "core/primaries.hpp"

#include <cmath>

namespace gazetrace {
namespace {

Vec3d xyz_of(const Vec2d& xy) {
  return {xy.x, xy.y, 1 - xy.x - xy.y};
}

RgbMatrix transposed(const RgbMatrix& m) {
  return {Vec3d{m[0].x, m[1].x, m[2].x}, Vec3d{m[0].y, m[1].y, m[2].y}, Vec3d{m[0].z, m[1].z, m[2].z}};
}

Vec3d times(const RgbMatrix& m, const Vec3d& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

RgbMatrix times(const RgbMatrix& a, const RgbMatrix& b) {
  const RgbMatrix columns = transposed(b);
  return transposed({times(a, columns[0]), times(a, columns[1]), times(a, columns[2])});
}

double determinant_of(const RgbMatrix& m) {
  return dot(m[0], cross(m[1], m[2]));
}

RgbMatrix inverse_of(const RgbMatrix& m) {
  const double scale = 1 / determinant_of(m);
  return transposed({cross(m[1], m[2]) * scale, cross(m[2], m[0]) * scale, cross(m[0], m[1]) * scale});
}

RgbMatrix diagonal(const Vec3d& v) {
  return {Vec3d{v.x, 0, 0}, Vec3d{0, v.y, 0}, Vec3d{0, 0, v.z}};
}

RgbMatrix columns_of(const Primaries& p) {
  return transposed({xyz_of(p.red), xyz_of(p.green), xyz_of(p.blue)});
}

Vec3d white_of(const Primaries& p) {
  return xyz_of(p.white) * (1 / p.white.y);
}

RgbMatrix to_xyz(const Primaries& p) {
  const RgbMatrix columns = columns_of(p);
  return times(columns, diagonal(times(inverse_of(columns), white_of(p))));
}

RgbMatrix adaptation(const Vec3d& from, const Vec3d& to) {
  constexpr RgbMatrix kBradford{Vec3d{0.8951, 0.2664, -0.1614}, Vec3d{-0.7502, 1.7135, 0.0367},
                                Vec3d{0.0389, -0.0685, 1.0296}};
  const Vec3d a = times(kBradford, from);
  const Vec3d b = times(kBradford, to);
  return times(inverse_of(kBradford), times(diagonal({b.x / a.x, b.y / a.y, b.z / a.z}), kBradford));
}

bool are_near(const Vec2d& a, const Vec2d& b) {
  constexpr double kSame = 1e-3;  // what files round to
  return std::fabs(a.x - b.x) < kSame && std::fabs(a.y - b.y) < kSame;
}

}  // namespace

bool is_space(const Primaries& p) {
  constexpr double kLeast = 1e-6;
  return std::fabs(determinant_of(columns_of(p))) > kLeast && p.white.y > kLeast;
}

std::optional<RgbMatrix> matrix_to_rec709(const Primaries& p) {
  const bool is_own = are_near(p.red, kRec709.red) && are_near(p.green, kRec709.green) &&
                      are_near(p.blue, kRec709.blue) && are_near(p.white, kRec709.white);
  if (is_own || !is_space(p)) {
    return std::nullopt;
  }
  const RgbMatrix from_xyz = inverse_of(to_xyz(kRec709));
  if (are_near(p.red, {1, 0}) && are_near(p.green, {0, 1}) && are_near(p.blue, {0, 0})) {
    return from_xyz;
  }
  return times(from_xyz, times(adaptation(white_of(p), white_of(kRec709)), to_xyz(p)));
}

std::optional<RgbMatrix> matrix_from_rec709(const Primaries& primaries) {
  const std::optional<RgbMatrix> way = matrix_to_rec709(primaries);
  return way ? std::optional(inverse_of(*way)) : std::nullopt;
}

}  // namespace gazetrace
