// SPDX-License-Identifier: Apache-2.0
// Small vectors, quaternions and affine maps as plain values without units of their own.
// All frames are right-handed; a camera or eye looks along -z with +x right and +y up (glTF, OpenXR).
#pragma once

#include <cmath>
#include <cstdint>

namespace gazetrace {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegPerRad = 180.0 / kPi;
inline constexpr double kRadPerDeg = kPi / 180.0;

template <class T>
struct Vec2 {
  T x{}, y{};
  friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  constexpr Vec3& operator*=(const Vec3& b) { return *this = *this * b; }
  constexpr Vec3& operator*=(T s) { return *this = *this * s; }

  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
  friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};

template <class T>
struct Vec4 {
  T x{}, y{}, z{}, w{};
  friend constexpr bool operator==(const Vec4&, const Vec4&) = default;
};

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Vec4f = Vec4<float>;
using Vec4d = Vec4<double>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}

// The zero vector stays zero; callers that can meet one must test for it.
template <class T>
Vec3<T> normalize(const Vec3<T>& a) {
  const T len = length(a);
  return len > T(0) ? a / len : a;
}

template <class T>
bool is_finite(const Vec3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

inline Vec3f to_float(const Vec3d& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}
inline Vec3d to_double(const Vec3f& a) {
  return {a.x, a.y, a.z};
}

// Angle between two directions of any length, in radians, 0..pi. atan2 keeps all digits near 0, where the acos of a
// normalised dot product has none left.
inline double angle_between_rad(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

// The unit quaternion x i + y j + z k + w, which rotates v to q v q*.
struct Quatd {
  double x{}, y{}, z{}, w{1};
  friend constexpr bool operator==(const Quatd&, const Quatd&) = default;
};

Quatd normalize(const Quatd& q);
Quatd operator*(const Quatd& a, const Quatd& b);
Vec3d rotate(const Quatd& q, const Vec3d& v);
// Spherical interpolation along the shorter path, t in 0..1; linear where the arc is below 1e-9 rad.
Quatd slerp(const Quatd& a, const Quatd& b, double t);

// The map p -> x p.x + y p.y + z p.z + t; the members are the columns of a 3x4 matrix.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{0, 0, 0};
  friend constexpr bool operator==(const Affine&, const Affine&) = default;
};

Affine operator*(const Affine& a, const Affine& b);  // b is applied first, then a
Affine make_affine(const Vec3d& translation, const Quatd& rotation, const Vec3d& scale);
double determinant(const Affine& a);  // of the 3x3 part
// The rotation in the 3x3 part without its scale and shear, as cameras need it: the columns are orthonormalised, z
// first, then y. A mirrored map keeps its z and y axes.
Quatd rotation_of(const Affine& a);

inline Vec3d transform_vector(const Affine& a, const Vec3d& v) {
  return a.x * v.x + a.y * v.y + a.z * v.z;
}
inline Vec3d transform_point(const Affine& a, const Vec3d& p) {
  return transform_vector(a, p) + a.t;
}

}  // namespace gazetrace
