// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/math.hpp"

#include <gtest/gtest.h>

namespace gazetrace::math_test {
namespace {

TEST(Angle, KeepsDigitsNearZeroAndPi) {
  const Vec3d forward{0, 0, -1};
  EXPECT_NEAR(angle_between_rad(forward, {1e-12, 0, -1}), 1e-12, 1e-24);
  EXPECT_DOUBLE_EQ(angle_between_rad(forward, {0, 0, 5}), kPi);
  EXPECT_DOUBLE_EQ(angle_between_rad({2, 0, 0}, {0, 3, 0}), kPi / 2);
}

TEST(Quaternion, RotatesAndComposes) {
  const double h = std::sqrt(0.5);
  const Quatd quarter_about_y{0, h, 0, h};
  const Vec3d x = rotate(quarter_about_y, {0, 0, -1});
  EXPECT_NEAR(x.x, -1, 1e-15);
  const Vec3d back = rotate(quarter_about_y * quarter_about_y, {0, 0, -1});
  EXPECT_NEAR(back.z, 1, 1e-15);
}

TEST(Quaternion, SlerpTakesTheShortWayAtConstantSpeed) {
  const auto about_z = [](double deg) {
    return Quatd{0, 0, std::sin(deg * kRadPerDeg / 2), std::cos(deg * kRadPerDeg / 2)};
  };
  for (const double t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const Quatd q = slerp(about_z(10), about_z(350), t);
    const Vec3d v = rotate(q, {1, 0, 0});
    EXPECT_NEAR(std::atan2(v.y, v.x) * kDegPerRad, 10 - 20 * t, 1e-12) << t;
  }
}

TEST(Affine, RotationOfIgnoresScaleAndRoundTrips) {
  for (const Quatd q : {Quatd{0, 0, 0, 1}, Quatd{1, 0, 0, 0}, Quatd{0, 1, 0, 0}, Quatd{0, 0, 1, 0},
                        normalize(Quatd{0.3, -0.5, 0.7, 0.1})}) {
    const Quatd r = rotation_of(make_affine({1, 2, 3}, q, {2, 3, 0.5}));
    for (const Vec3d v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      EXPECT_NEAR(length(rotate(r, v) - rotate(q, v)), 0, 1e-14);
    }
  }
}

}  // namespace
}  // namespace gazetrace::math_test
