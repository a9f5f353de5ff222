// SPDX-License-Identifier: Apache-2.0
// Euler angles in every order against products of matrices, paths out and in again, and where a path is placed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "gazetrace/camera.hpp"
#include "support/text_file.hpp"

namespace gazetrace::camera_write_test {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// Rotation matrices as any textbook has them.
Matrix about(char axis, double a) {
  const double c = std::cos(a);
  const double s = std::sin(a);
  switch (axis) {
    case 'x':
      return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
    case 'y':
      return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
    default:
      return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  }
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix product{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 3; ++k) {
        product[r][c] += a[r][k] * b[k][c];
      }
    }
  }
  return product;
}

Vec3d apply(const Matrix& m, const Vec3d& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

// The angle of the rotation that takes a to b.
double angle_between(const Quatd& a, const Quatd& b) {
  const Quatd d = Quatd{-a.x, -a.y, -a.z, a.w} * b;
  return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

const std::vector<std::pair<RotationOrder, std::string>>& orders() {
  static const std::vector<std::pair<RotationOrder, std::string>> all{
      {RotationOrder::xyz, "xyz"}, {RotationOrder::xzy, "xzy"}, {RotationOrder::yxz, "yxz"},
      {RotationOrder::yzx, "yzx"}, {RotationOrder::zxy, "zxy"}, {RotationOrder::zyx, "zyx"}};
  return all;
}

TEST(Euler, EveryOrderIsTheProductOfItsMatrices) {
  const Vec3d angles{0.3, -1.1, 2.4};
  const auto angle = [&](char axis) { return axis == 'x' ? angles.x : axis == 'y' ? angles.y : angles.z; };
  for (const auto& [order, name] : orders()) {
    // The first letter acts first, so its matrix stands on the right.
    const Matrix m = about(name[2], angle(name[2])) * about(name[1], angle(name[1])) * about(name[0], angle(name[0]));
    const Quatd q = quaternion_of_euler(angles, order);
    for (const Vec3d& v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      EXPECT_LT(length(rotate(q, v) - apply(m, v)), 1e-15 * 4) << name;
    }
  }
}

TEST(Euler, ComesBackAlsoAtAndNearTheGimbalLock) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-kPi, kPi);
  for (const auto& [order, name] : orders()) {
    for (int i = 0; i < 2000; ++i) {
      const double near = std::pow(10.0, -(i % 17)) * (i % 2 == 0 ? 1 : -1);
      const double second = i % 4 == 0 ? any(random) : (i % 3 == 0 ? -1 : 1) * kPi / 2 + (i % 5 == 0 ? 0 : near);
      Vec3d angles{any(random), any(random), any(random)};
      (name[1] == 'x' ? angles.x : name[1] == 'y' ? angles.y : angles.z) = second;
      const Quatd q = quaternion_of_euler(angles, order);
      const Vec3d back = euler_of_quaternion(q, order);
      EXPECT_LT(angle_between(q, quaternion_of_euler(back, order)), 1e-14) << name << " " << second;
      const double middle = name[1] == 'x' ? back.x : name[1] == 'y' ? back.y : back.z;
      EXPECT_LE(std::abs(middle), kPi / 2 + 1e-12);
    }
  }
}

// A walk of 200 frames with every attitude, steps from a nanometre to a kilometre, one of them straight up.
std::vector<FramePose> walk(std::int64_t start_ns, const FrameRate& fps) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<FramePose> frames;
  for (std::int32_t n = 1; n <= 200; ++n) {
    FramePose frame;
    frame.frame = n;
    frame.t_ns = *mid_frame_ns(n, fps, start_ns);
    const double reach = std::pow(10.0, n % 13 - 9);
    frame.camera.pose.position_m = Vec3d{normal(random), normal(random), normal(random)} * reach;
    const Quatd q{normal(random), normal(random), normal(random), normal(random)};
    frame.camera.pose.orientation = n == 100 ? Quatd{std::sqrt(0.5), 0, 0, std::sqrt(0.5)} : normalize(q);
    frame.camera.projection.yfov_rad = 0.7;
    frames.push_back(frame);
  }
  return frames;
}

void expect_same(const std::vector<FramePose>& frames, const CameraPath& path) {
  for (const FramePose& frame : frames) {
    const CameraPose pose = path.pose_at(frame.t_ns);
    EXPECT_LT(length(pose.position_m - frame.camera.pose.position_m), 1e-9) << frame.frame;
    EXPECT_LT(angle_between(pose.orientation, frame.camera.pose.orientation), 1e-9) << frame.frame;
  }
}

TEST(CameraWrite, PathsComeBackFromTumAndFromNukeInEveryOrder) {
  const TextFiles files;
  for (const FrameRate& fps : {FrameRate{24, 1}, FrameRate{24000, 1001}, FrameRate{1000, 1}}) {
    const auto frames = walk(0, fps);
    for (const auto& [order, name] : orders()) {
      CameraReadOptions options;
      options.rotation_order = order;
      options.fps = fps;
      options.keep_time = true;
      write_camera_path(frames, order, files.path("walk.chan"));
      const CameraPath path = load_camera_path(files.path("walk.chan"), options);
      expect_same(frames, path);
      EXPECT_EQ(path.begin_ns, frames.front().t_ns);
      EXPECT_EQ(path.end_ns, frames.back().t_ns);
      EXPECT_NEAR(path.projection.yfov_rad, 0.7, 1e-15);
    }
  }
  for (const std::int64_t start_ns :
       {std::int64_t{0}, std::int64_t{-3'000'000'001}, std::int64_t{1'700'000'000'000'000'007}}) {
    const auto frames = walk(start_ns, {24, 1});
    CameraReadOptions options;
    options.keep_time = true;
    write_camera_path(frames, RotationOrder::zxy, files.path("walk.tum"));
    const CameraPath path = load_camera_path(files.path("walk.tum"), options);
    expect_same(frames, path);
    EXPECT_EQ(path.begin_ns, frames.front().t_ns);
    EXPECT_EQ(path.end_ns, frames.back().t_ns);
  }
  EXPECT_THROW(write_camera_path(walk(0, {24, 1}), RotationOrder::zxy, files.path("walk.fbx")), Error);
  EXPECT_THROW(write_camera_path(walk(0, {24, 1}), RotationOrder::zxy, files.path("absent/walk.tum")), Error);
}

TEST(MidFrame, IsFlooredAndKnowsItsLimits) {
  EXPECT_EQ(mid_frame_ns(1, {24, 1}, 0), 20'833'333);
  EXPECT_EQ(mid_frame_ns(1, {24000, 1001}, 0), 20'854'166);  // 1001 / 48000 s
  EXPECT_EQ(mid_frame_ns(0, {24, 1}, 0), -20'833'334);
  EXPECT_EQ(mid_frame_ns(3, {2, 1}, 5), 1'250'000'005);
  EXPECT_FALSE(mid_frame_ns(1, {0, 1}, 0).has_value());
  EXPECT_FALSE(mid_frame_ns(std::numeric_limits<std::int64_t>::max(), {1, 1}, 0).has_value());
}

// x(t) = 1 + 2 t + 3 t^2 at uneven times: parabolas come back exactly between inner keys.
TEST(CatmullRom, PassesThroughItsKeysAndKeepsParabolas) {
  const auto x = [](double t) { return 1 + 2 * t + 3 * t * t; };
  std::vector<TimedPose> poses;
  for (const double t : {0.0, 0.1, 0.5, 0.6, 1.4, 2.0}) {
    poses.push_back({static_cast<std::int64_t>(std::llround(t * 1e9)), {{x(t), -x(t), 7}, {}}});
  }
  const CameraPath path = camera_from_poses(poses, "keys", {}, PathInterpolation::catmull_rom);
  for (const TimedPose& pose : poses) {
    EXPECT_NEAR(path.pose_at(pose.t_ns).position_m.x, pose.pose.position_m.x, 1e-14);
  }
  for (const double t : {0.1001, 0.3, 0.55, 0.8, 1.3999}) {
    const Vec3d p = path.pose_at(static_cast<std::int64_t>(std::llround(t * 1e9))).position_m;
    EXPECT_NEAR(p.x, x(t), 1e-13);
    EXPECT_NEAR(p.y, -x(t), 1e-13);
    EXPECT_NEAR(p.z, 7, 1e-14);
  }
  // The first step, by hand: from 1 to 1.23 in 0.1 s with 2.3 m/s at its begin and, of the parabola, 2.6 m/s at its
  // end. Half way: 0.5 (1 + 1.23) + 0.1 (2.3 - 2.6) / 8.
  EXPECT_NEAR(path.pose_at(50'000'000).position_m.x, 1.115 - 0.00375, 1e-14);
  // Two keys: a line.
  poses.resize(2);
  EXPECT_NEAR(camera_from_poses(poses, "keys", {}, PathInterpolation::catmull_rom).pose_at(25'000'000).position_m.x,
              1 + 0.23 / 4, 1e-14);
}

TEST(PlaceCamera, TurnsScalesAndMoves) {
  // Two poses of a world with z up: at (1, 0, 2), level (a camera without rotation there looks down, so x by 90).
  const Quatd level{std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  const std::vector<TimedPose> poses{{0, {{1, 0, 2}, level}}, {1'000'000'000, {{1, 3, 2}, level}}};
  const CameraPath path = camera_from_poses(poses, "keys", {}, PathInterpolation::linear);
  const auto look = [](const CameraPath& p, std::int64_t t) { return rotate(p.pose_at(t).orientation, {0, 0, -1}); };
  // There it looks along +y, which becomes -z.
  const CameraPath up = place_camera(path, {.z_up = true, .start_m = std::nullopt});
  EXPECT_LT(length(up.pose_at(0).position_m - Vec3d{1, 2, 0}), 1e-15);
  EXPECT_LT(length(up.pose_at(1'000'000'000).position_m - Vec3d{1, 2, -3}), 1e-15);
  EXPECT_LT(length(look(up, 0) - Vec3d{0, 0, -1}), 1e-15);
  EXPECT_LT(length(rotate(up.pose_at(0).orientation, {0, 1, 0}) - Vec3d{0, 1, 0}), 1e-15);
  // A quarter turn to the left, half as large, begun at (10, 20, 30): it walks along -x now, 1.5 m of them.
  const CameraPath placed =
      place_camera(path, {.z_up = true, .turn_deg = 90, .scale = 0.5, .start_m = Vec3d{10, 20, 30}});
  EXPECT_LT(length(placed.pose_at(0).position_m - Vec3d{10, 20, 30}), 1e-14);
  EXPECT_LT(length(placed.pose_at(1'000'000'000).position_m - Vec3d{8.5, 20, 30}), 1e-14);
  EXPECT_LT(length(look(placed, 0) - Vec3d{-1, 0, 0}), 1e-15);
  EXPECT_THROW(place_camera(path, {.scale = 0, .start_m = std::nullopt}), Error);
  EXPECT_THROW(place_camera(path, {.turn_deg = std::numeric_limits<double>::quiet_NaN(), .start_m = std::nullopt}),
               Error);
}

}  // namespace
}  // namespace gazetrace::camera_write_test
