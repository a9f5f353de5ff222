// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "gazetrace/camera.hpp"
#include "support/text_file.hpp"

namespace gazetrace::camera_path_test {
namespace {

using ::testing::HasSubstr;

constexpr Vec3d kRight{1, 0, 0};
constexpr Vec3d kUp{0, 1, 0};
constexpr Vec3d kForward{0, 0, -1};

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(LookAt, FacesTheTargetWithUpAbove) {
  const CameraPose pose = look_at({8, 2, -0.3}, {-8, 3, -0.3}, kUp);
  expect_near(rotate(pose.orientation, kForward), normalize(Vec3d{-16, 1, 0}));
  expect_near(rotate(pose.orientation, kRight), {0, 0, -1});
  EXPECT_GT(rotate(pose.orientation, kUp).y, 0.99);
  EXPECT_EQ(look_at({0, 0, 5}, {0, 0, 0}, kUp).orientation, (Quatd{0, 0, 0, 1}));
}

TEST(LookAt, DegenerateUpStillGivesARotation) {
  for (const auto& [target, up] : {std::pair(Vec3d{0, -5, 0}, kUp), std::pair(Vec3d{3, 0, 0}, Vec3d{0, 0, 0}),
                                   std::pair(Vec3d{0, 0, 7}, Vec3d{0, 0, 1}), std::pair(Vec3d{0, 0, 0}, kUp)}) {
    const Quatd q = look_at({0, 0, 0}, target, up).orientation;
    EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.0, 1e-14);
    if (length(target) > 0) {
      expect_near(rotate(q, kForward), normalize(target));
    }
  }
  expect_near(rotate(look_at({0, 0, 0}, {3, 0, 0}, {0, 0, 0}).orientation, kUp), kUp);
}

// A view 2.5 times as wide as high in a frame of 16:9 is as wide as the frame, and 2.5 / (16/9) times as high.
TEST(Projection, ShowsAllThatItsCameraDoes) {
  Projection flat;
  flat.kind = ProjectionKind::orthographic;
  flat.ymag_m = 3;
  flat.aspect = 2.5;
  EXPECT_NEAR(fit_projection(flat, 1920, 1080).ymag_m, 3 * 1.40625, 1e-12);
  EXPECT_EQ(fit_projection(flat, 1920, 1080).aspect, 0);
  EXPECT_EQ(fit_projection(flat, 1000, 400).ymag_m, 3);
  EXPECT_EQ(fit_projection(flat, 1000, 100).ymag_m, 3);  // the frame shows more at the sides
  Projection wide;
  wide.yfov_rad = kPi / 2;
  wide.aspect = 2;
  EXPECT_NEAR(fit_projection(wide, 100, 100).yfov_rad, 2 * std::atan(2.0), 1e-12);
  Projection rounded;
  rounded.yfov_rad = 1;
  rounded.aspect = 1.7778;
  EXPECT_EQ(fit_projection(rounded, 1280, 720).yfov_rad, 1);
}

TEST(CameraPath, CsvInterpolatesPositionsLinearlyAndOrientationsBySlerp) {
  const TextFiles files;
  // No rotation, then a quarter turn to the left (about +y).
  const std::string path = files.write("path.csv",
                                       "# by hand\nt[ms],x[m],y[m],z[m],qx,qy,qz,qw\n"
                                       "1000,0,1,2,0,0,0,1\n"
                                       "1500.000001,4,1,-2,0,0.70710678118654752,0,0.70710678118654752\n");
  const CameraPath camera = load_camera_path(path, {});
  EXPECT_FALSE(camera.is_static);
  EXPECT_EQ(camera.begin_ns, 0);
  EXPECT_EQ(camera.end_ns, 500'000'001);
  const CameraPose quarter = camera.pose_at(125'000'000);
  expect_near(quarter.position_m, {1, 1, 1}, 1e-8);
  const double a = 22.5 * kRadPerDeg;
  expect_near(rotate(quarter.orientation, kForward), {-std::sin(a), 0, -std::cos(a)}, 1e-8);
  expect_near(rotate(camera.pose_at(500'000'001).orientation, kForward), {-1, 0, 0});
  expect_near(camera.pose_at(-5).position_m, {0, 1, 2});
  expect_near(camera.pose_at(std::numeric_limits<std::int64_t>::max()).position_m, {4, 1, -2});

  CameraReadOptions step;
  step.interpolation = PathInterpolation::step;
  step.keep_time = true;
  const CameraPath held = load_camera_path(path, step);
  EXPECT_EQ(held.begin_ns, 1'000'000'000);
  expect_near(held.pose_at(1'500'000'000).position_m, {0, 1, 2});
  expect_near(held.pose_at(1'500'000'001).position_m, {4, 1, -2});
}

TEST(CameraPath, TumIsReadInNanosecondsAndOneKeyIsStatic) {
  const TextFiles files;
  const std::string tum = files.write("groundtruth.txt",
                                      "# timestamp tx ty tz qx qy qz qw\n"
                                      "1305031102.175304301 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248\n"
                                      "1305031102.211214000 1.3303 0.6256 1.6464 0.6579 0.6161 -0.2932 -0.3189\r\n");
  CameraReadOptions options;
  options.keep_time = true;
  const CameraPath camera = load_camera_path(tum, options);
  EXPECT_EQ(camera.begin_ns, 1'305'031'102'175'304'301);  // a double would be 45 ns off
  EXPECT_EQ(camera.end_ns, 1'305'031'102'211'214'000);
  expect_near(camera.pose_at(camera.begin_ns).position_m, {1.3405, 0.6266, 1.6575});

  const CameraPath one = load_camera_path(files.write("one.txt", "5 1 2 3 0 0 0 1.0001\n"), {});
  EXPECT_TRUE(one.is_static);
  EXPECT_EQ(one.pose_at(123).orientation, (Quatd{0, 0, 0, 1}));
}

// Forward and up of the camera in the world, worked by hand for each preset.
TEST(CameraAxes, AreConvertedToGltf) {
  const TextFiles files;
  const auto pose = [&](CameraAxes axes, const std::string& key) {
    CameraReadOptions options;
    options.axes = axes;
    return load_camera_path(files.write("axes.txt", "0 " + key + "\n"), options).pose_at(0);
  };
  // gl: as it is.
  expect_near(rotate(pose(CameraAxes::gl, "1 2 3 0 0 0 1").orientation, kForward), {0, 0, -1});
  // cv, unrotated: looks along +z, its up is -y; +x stays right.
  const CameraPose cv = pose(CameraAxes::cv, "1 2 3 0 0 0 1");
  expect_near(cv.position_m, {1, 2, 3});
  expect_near(rotate(cv.orientation, kForward), {0, 0, 1});
  expect_near(rotate(cv.orientation, kUp), {0, -1, 0});
  expect_near(rotate(cv.orientation, kRight), {1, 0, 0});
  // cv, turned a quarter about world z (x to y): its right is +y, its down -x, it still looks along +z.
  const CameraPose rolled = pose(CameraAxes::cv, "0 0 0 0 0 0.70710678118654752 0.70710678118654752");
  expect_near(rotate(rolled.orientation, kRight), {0, 1, 0});
  expect_near(rotate(rolled.orientation, kUp), {1, 0, 0});
  expect_near(rotate(rolled.orientation, kForward), {0, 0, 1});
  // unity, unrotated: looks along +z, which is -z after mirroring.
  const CameraPose unity = pose(CameraAxes::unity, "1 2 3 0 0 0 1");
  expect_near(unity.position_m, {1, 2, -3});
  expect_near(rotate(unity.orientation, kForward), {0, 0, -1});
  expect_near(rotate(unity.orientation, kUp), {0, 1, 0});
  // unity, Euler y = 90: turns right there (from +z to +x), so to the right here as well.
  const CameraPose yawed = pose(CameraAxes::unity, "0 0 0 0 0.70710678118654752 0 0.70710678118654752");
  expect_near(rotate(yawed.orientation, kForward), {1, 0, 0});
  expect_near(rotate(yawed.orientation, kRight), {0, 0, 1});
  // unity, Euler x = 90: looks down.
  const CameraPose pitched = pose(CameraAxes::unity, "0 0 0 0.70710678118654752 0 0 0.70710678118654752");
  expect_near(rotate(pitched.orientation, kForward), {0, -1, 0});
  // unity, Euler z = 90: rolls x to y, seen from behind to the left; right becomes up in both worlds.
  const CameraPose tilted = pose(CameraAxes::unity, "0 0 0 0 0 0.70710678118654752 0.70710678118654752");
  expect_near(rotate(tilted.orientation, kRight), {0, 1, 0});
}

TEST(CameraPath, ErrorsHavePlaceAndRemedy) {
  const std::string header = "t[s],x[m],y[m],z[m],qx,qy,qz,qw\n";
  const std::string form = "; the header is `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, t also in [ms], [us] or [ns]";
  const std::string tum_form = "; a TUM line is `t tx ty tz qx qy qz qw`, in seconds and metres";
  struct Case {
    std::string name, text, message;
  };
  const std::vector<Case> cases{
      {"empty.csv", header,
       "empty.csv: holds no pose; give at least one line with a time, a position and a quaternion"},
      {"back.csv", header + "1,0,0,0,0,0,0,1\n0.5,0,0,0,0,0,0,1\n",
       "back.csv:3: time 500000000 ns is before the previous one, at line 2; times of a camera path must increase"},
      {"twice.csv", header + "1,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n",
       "twice.csv:3: time 1000000000 ns repeats that of line 2; times of a camera path must increase"},
      {"zero.csv", header + "1,0,0,0,0,0,0,0\n",
       "zero.csv:2: quaternion (0, 0, 0, 0) has no direction; no rotation is x 0, y 0, z 0, w 1; check the order of "
       "its "
       "columns"},
      {"two.csv", header + "1,0,0,0,0,0,0,2\n",
       "two.csv:2: quaternion (0, 0, 0, 2) has length 2, not 1; no rotation is x 0, y 0, z 0, w 1; check the order of "
       "its columns"},
      {"short.csv", header + "1,0,0,0,0,0\n",
       "short.csv:2: 6 cells where the header has 8; the file may be cut off; remove or mend the line"},
      {"text.csv", header + "1,0,zero,0,0,0,0,1\n",
       "text.csv:2: 'zero' in column 'y' is not a finite number; every pose must be complete; remove or mend the line"},
      {"column.csv", "t[s],x[m],y[m],qx,qy,qz,qw\n",
       "column.csv:1: has no column 'z'; its columns are: t, x, y, qx, qy, "
       "qz, qw" +
           form},
      {"unit.csv", "t,x,y,z,qx,qy,qz,qw\n", "unit.csv:1: the time column 't' does not state its unit" + form},
      {"hours.csv", "t[h],x,y,z,qx,qy,qz,qw\n", "hours.csv:1: unknown unit 'h' of the time column 't'" + form},
      {"inch.csv", "t[s],x[in],y,z,qx,qy,qz,qw\n",
       "inch.csv:1: unknown or mixed unit 'in' of column 'x'; positions are in [m], [cm] or [mm], all three alike"},
      {"far.csv", header + "9300000000,0,0,0,0,0,0,1\n",
       "far.csv:2: time '9300000000' does not fit int64 nanoseconds; check the unit in the header"},
      {"bad.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n", "bad.tum:2: 7 values where 8 belong" + tum_form},
      {"nan.tum", "1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n", "nan.tum:2: 'nan' is not a finite number" + tum_form},
      {"time.tum", "1 0 0 0 0 0 0 1\ntwo 0 0 0 0 0 0 1\n", "time.tum:2: time 'two' is not a number" + tum_form},
      {"prose.txt", "Dear reader,\n",
       "prose.txt: is not a camera path of a known format; known are csv, tum, euroc, chan, nerf, colmap; CSV has a "
       "header `t[s],x[m],y[m],z[m],qx,qy,qz,qw`, TUM lines `t tx ty tz qx qy qz qw`"},
  };
  const TextFiles files;
  for (const Case& c : cases) {
    try {
      load_camera_path(files.write(c.name, c.text), {});
      ADD_FAILURE() << c.name << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(files.without_folder(error.what()), c.message);
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
  try {
    load_camera_path(files.path("absent.csv"), {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(files.without_folder(error.what()),
              "absent.csv: cannot be opened: No such file or directory; check the path");
  }
  CameraReadOptions options;
  options.format = "tun";
  try {
    load_camera_path(files.write("a.txt", "0 0 0 0 0 0 0 1\n"), options);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "unknown camera path format 'tun'; did you mean 'tum'? Known: csv, tum, euroc, chan, nerf, colmap");
  }
}

// A quaternion and its negative are the same rotation: between them nothing turns.
TEST(CameraPath, TheSignOfAQuaternionDoesNotMatter) {
  const TextFiles files;
  const CameraPath camera =
      load_camera_path(files.write("sign.txt", "0 0 0 0 0.6 0 0 0.8\n1 0 0 0 -0.6 0 0 -0.8\n"), {});
  const Vec3d ahead = rotate({0.6, 0, 0, 0.8}, kForward);
  for (const std::int64_t t_ns : {0, 250'000'000, 500'000'000, 1'000'000'000}) {
    expect_near(rotate(camera.pose_at(t_ns).orientation, kForward), ahead);
  }
}

TEST(CameraPath, UnitsScalePositions) {
  const TextFiles files;
  const CameraPath camera = load_camera_path(
      files.write("cm.csv", "qw;qx;qy;qz;x[cm];y[cm];z[cm];t[ns];note\n1;0;0;0;100;-50;1,5;7;x\n"), {});
  expect_near(camera.pose_at(0).position_m, {1, -0.5, 0.015}, 1e-15);
}

}  // namespace
}  // namespace gazetrace::camera_path_test
