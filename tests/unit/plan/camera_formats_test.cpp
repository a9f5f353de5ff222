// SPDX-License-Identifier: Apache-2.0
// Camera paths of other programs. Expected poses are worked by hand from the conventions of each format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "gazetrace/camera.hpp"
#include "support/text_file.hpp"

namespace gazetrace::camera_formats_test {
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

// Where the camera looks and where its up points.
void expect_view(const CameraPose& pose, const Vec3d& position, const Vec3d& forward, const Vec3d& up) {
  expect_near(pose.position_m, position);
  expect_near(rotate(pose.orientation, kForward), forward);
  expect_near(rotate(pose.orientation, kUp), up);
}

class CameraFormats : public ::testing::Test {
 protected:
  CameraPath read(const std::string& name, const std::string& text, const CameraReadOptions& options = {}) {
    return load_camera_path(files_.write(name, text), options);
  }
  std::string refusal(const std::string& name, const std::string& text, const CameraReadOptions& options = {}) {
    try {
      read(name, text, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return files_.without_folder(error.what());
    }
    return "accepted";
  }
  void put(const std::string& name, const std::string& text) { ASSERT_FALSE(files_.write(name, text).empty()); }
  TextFiles files_;
};

constexpr const char* kEurocHeader =
    "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1]\r\n";

TEST_F(CameraFormats, EurocHasNanosecondsAndWFirst) {
  CameraReadOptions options;
  options.keep_time = true;
  const CameraPath path =
      read("data.csv",
           std::string(kEurocHeader) +
               "1403636580838555648,4.688319,-1.786938,0.783338,1,0,0,0,0,0,0\r\n"
               "1403636580843555649,4.7,-1.8,0.8,0.70710678118654752,0,0.70710678118654752,0,0,0,0\r\n",
           options);
  EXPECT_EQ(path.begin_ns, 1'403'636'580'838'555'648);
  EXPECT_EQ(path.end_ns, 1'403'636'580'843'555'649);  // a double would lose the last digit
  expect_view(path.pose_at(path.begin_ns), {4.688319, -1.786938, 0.783338}, kForward, kUp);
  // A quarter turn about y: to the left.
  expect_view(path.pose_at(path.end_ns), {4.7, -1.8, 0.8}, {-1, 0, 0}, kUp);
  // The same as a camera of computer vision: its forward is what +z was, which turned to +x.
  options.axes = CameraAxes::cv;
  expect_view(load_camera_path(files_.path("data.csv"), options).pose_at(path.end_ns), {4.7, -1.8, 0.8}, {1, 0, 0},
              {0, -1, 0});
  EXPECT_EQ(read("headless.csv", "1403636580838555648,1,2,3,1,0,0,0\n").pose_at(0).position_m, (Vec3d{1, 2, 3}));
  EXPECT_EQ(refusal("x.csv", "#timestamp [ns],x,y,z,qx,qy,qz,qw\n1403636580838555648,1,2,3,0,0,0,1\n"),
            "x.csv:1: column 5 is 'qx', where the quaternion's w belongs; a EuRoC line is `timestamp [ns],x,y,z "
            "[m],qw,qx,qy,qz` and may go on with velocity and biases");
  EXPECT_THAT(refusal("y.csv", std::string(kEurocHeader) + "1,2,3\n"), HasSubstr("y.csv:2: 3 values where 8 belong"));
}

// Frames at 24 a second lie at (n - 1/2) / 24 s: 20'833'333.33 ns, 62'500'000 ns, 104'166'666.67 ns.
TEST_F(CameraFormats, NukeCountsFramesAndTurnsAboutZThenXThenY) {
  const std::string text =
      "# frame tx ty tz rx ry rz vfov\n101\t1\t2\t3\t0\t0\t0\t40\n102 4 5 6 0 90 0 40\n103 7 8 9 -90 0 0 40\n";
  const CameraPath path = read("shot.chan", text);
  EXPECT_EQ(path.begin_ns, 20'833'333);
  EXPECT_EQ(path.end_ns, 104'166'666);
  EXPECT_NEAR(path.projection.yfov_rad * kDegPerRad, 40, 1e-12);
  expect_view(path.pose_at(20'833'333), {1, 2, 3}, kForward, kUp);
  expect_view(path.pose_at(62'500'000), {4, 5, 6}, {-1, 0, 0}, kUp);          // to the left
  expect_view(path.pose_at(104'166'666), {7, 8, 9}, {0, -1, 0}, {0, 0, -1});  // down
  CameraReadOptions options;
  options.fps = {30, 1};
  options.keep_time = true;
  options.yfov_rad = 0.5;
  const CameraPath kept = load_camera_path(files_.path("shot.chan"), options);
  EXPECT_EQ(kept.begin_ns, 3'350'000'000);  // (101 - 1/2) / 30 s
  EXPECT_EQ(kept.projection.yfov_rad, 0.5);
  // z first: the camera rolls a quarter to the left, so that its up is -x; then x by 90: -x stays, and it looks up
  // (+y); then y by 90: up goes from -x to +z, and it still looks up.
  expect_view(read("zxy.chan", "1 0 0 0 90 90 90\n").pose_at(0), {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  // Seven columns or eight by content alone; a quaternion of length 1 is TUM's.
  expect_view(read("a.txt", "1 0 0 0 0 90 0\n").pose_at(0), {0, 0, 0}, {-1, 0, 0}, kUp);
  expect_view(read("b.txt", "1 0 0 0 0 90 0 35\n").pose_at(0), {0, 0, 0}, {-1, 0, 0}, kUp);
  EXPECT_NEAR(read("c.txt", "1 0 0 0 0 1 0 0\n").pose_at(0).orientation.y, 1, 0);
}

TEST_F(CameraFormats, NukeErrorsAndWarnings) {
  const std::string form = "; a line of a .chan file is `frame tx ty tz rx ry rz [vfov]`, angles in degrees";
  EXPECT_EQ(refusal("a.chan", "1 0 0 0 0 0 0\n2 0 0 0 0 0\n"), "a.chan:2: 6 values where 7 or 8 belong" + form);
  EXPECT_EQ(refusal("b.chan", "1 0 0 0 0 0 0\n1.5 0 0 0 0 0 0\n"), "b.chan:2: '1.5' is not a frame number" + form);
  EXPECT_EQ(refusal("c.chan", "2 0 0 0 0 0 0\n2 0 0 0 0 0 0\n"),
            "c.chan:2: frame 2 repeats 2; frames of a .chan file must increase");
  EXPECT_EQ(refusal("d.chan", "2 0 0 0 0 0 0\n1 0 0 0 0 0 0\n"),
            "d.chan:2: frame 1 comes after 2; frames of a .chan file must increase");
  EXPECT_EQ(refusal("e.chan", "1 0 0 0 0 0 0\n2 0 0 nan 0 0 0\n"), "e.chan:2: 'nan' is not a finite number" + form);
  EXPECT_EQ(refusal("f.chan", "1 0 0 0 0 0 0 180\n"),
            "f.chan:1: a field of view of 180 degrees is not between 0 and 180" + form);
  const CameraPath zoom = read("zoom.chan", "1 0 0 0 0 0 0 40\n2 0 0 0 0 0 0 20\n");
  ASSERT_EQ(zoom.warnings.size(), 1U);
  EXPECT_THAT(zoom.warnings[0], HasSubstr("changes from 20 to 40 degrees along the path; 40, the first, is used"));
}

// An upright camera at (0, 1, 5), and one at (2, 0, 0) that looks along -x (a quarter turn to the left).
TEST_F(CameraFormats, NerfMatricesGoFromCameraToWorld) {
  const std::string frames = R"("frames": [
    {"file_path": "./train/r_10", "transform_matrix": [[0, 0, 1, 2], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]},
    {"file_path": "./train/r_9", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 1, 5]]}]})";
  const CameraPath path = read("transforms.json", "{\"fl_y\": 500, \"w\": 1600, \"h\": 1000, " + frames);
  expect_view(path.pose_at(20'833'333), {0, 1, 5}, kForward, kUp);  // r_9 comes before r_10
  expect_view(path.pose_at(62'500'000), {2, 0, 0}, {-1, 0, 0}, kUp);
  EXPECT_NEAR(path.projection.yfov_rad * kDegPerRad, 90, 1e-12);  // half the height is the focal length
  // Blender's camera_angle_x is horizontal: 90 deg across 1600 are 2 atan(1000 / 1600) = 64.01 deg down 1000.
  const CameraPath wide =
      read("x.json", "{\"camera_angle_x\": 1.5707963267948966, \"w\": 1600, \"h\": 1000, " + frames);
  EXPECT_NEAR(wide.projection.yfov_rad, 2 * std::atan(0.625), 1e-15);
  const CameraPath unknown = read("u.json", "{\"camera_angle_x\": 0.69, " + frames);
  EXPECT_NEAR(unknown.projection.yfov_rad * kDegPerRad, 50, 1e-12);
  ASSERT_EQ(unknown.warnings.size(), 1U);
  EXPECT_THAT(unknown.warnings[0], HasSubstr("neither w and h nor camera_angle_y"));
  EXPECT_THAT(read("k.json", "{\"fl_y\": 500, \"h\": 1000, \"k1\": 0.1, " + frames).warnings.at(0),
              HasSubstr("distorted"));
}

TEST_F(CameraFormats, NerfErrors) {
  const auto one = [](const std::string& matrix) {
    return "{\"frames\": [{\"file_path\": \"a\", \"transform_matrix\": " + matrix + "}]}";
  };
  EXPECT_THAT(refusal("a.json", one("[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]")),
              HasSubstr("a.json: frames[0]: the columns of its transform_matrix are not a rotation"));
  EXPECT_THAT(refusal("b.json", one("[[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]")), HasSubstr("a mirror image"));
  EXPECT_THAT(refusal("c.json", one("[[1,0,0,0],[0,1,0,0],[0,0,1,null],[0,0,0,1]]")),
              HasSubstr("no finite number at row 3, column 4"));
  EXPECT_THAT(refusal("d.json", one("[[1,0,0],[0,1,0],[0,0,1],[0,0,0]]")), HasSubstr("row 1"));
  EXPECT_THAT(refusal("e.json", one("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]")), HasSubstr("the last row"));
  EXPECT_THAT(refusal("f.json", "{\"frames\": [], \"x\": \"transform_matrix\"}"), HasSubstr("f.json: holds no pose"));
  EXPECT_THAT(refusal("g.json", "{\"frames\": [{\"transform_matrix\": "), HasSubstr("is not a JSON object"));
  const std::string ahead = "\"frames\": [{\"transform_matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}";
  EXPECT_THAT(refusal("wide.json", "{\"fl_y\": 691, \"h\": 9e22, " + ahead), HasSubstr("field of view of 180 degrees"));
  EXPECT_THAT(refusal("thin.json", "{\"fl_y\": 1e300, \"h\": 1e-300, " + ahead),
              HasSubstr("field of view of 0 degrees"));
  EXPECT_THAT(refusal("scene.gltf", "{\"asset\": {\"version\": \"2.0\"}}"), HasSubstr("chosen with `camera`"));
}

// x_camera = R x_world + t. Without rotation and with t = (1, 2, 3) the camera stands at (-1, -2, -3) and looks along
// +z with its up along -y. With R a quarter turn about y, which takes +z to +x: t = (0, 0, 4) stands at -R' t, and R'
// takes +z to -x, so at (4, 0, 0), and it looks along R' z = -x.
TEST_F(CameraFormats, ColmapIsInvertedAndSortedByName) {
  const std::string images =
      "# Image list with two lines of data per image:\n"
      "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
      "#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
      "1 0.70710678118654752 0 0.70710678118654752 0 0 0 4 7 shot 10.jpg\n"
      "1.5 2.5 -1 3.5 4.5 12\n"
      "2 1 0 0 0 1 2 3 7 shot 9.jpg\n"
      "\n"
      "3 1 0 0 0 0 0 0 7 shot 11.jpg\n\n";
  const CameraPath path = read("images.txt", images);
  expect_view(path.pose_at(20'833'333), {-1, -2, -3}, {0, 0, 1}, {0, -1, 0});
  expect_view(path.pose_at(62'500'000), {4, 0, 0}, {-1, 0, 0}, {0, -1, 0});
  expect_view(path.pose_at(104'166'666), {0, 0, 0}, {0, 0, 1}, {0, -1, 0});
  // The camera sees what the matrices say: a point's place in the camera is R x + t, here for x = (0.3, -0.2, 0.7).
  const CameraPose pose = path.pose_at(62'500'000);
  const Quatd to_camera{-pose.orientation.x, -pose.orientation.y, -pose.orientation.z, pose.orientation.w};
  const Vec3d seen = rotate(to_camera, Vec3d{0.3, -0.2, 0.7} - pose.position_m);
  expect_near(seen, {0.7, 0.2, -(-0.3 + 4)});  // (z, y, -x + 4) in cv's axes; y and z change sign in ours
  EXPECT_NEAR(path.projection.yfov_rad * kDegPerRad, 50, 1e-12);

  put("cameras.txt", "# cameras\n7 PINHOLE 1920 1080 900 540 960 540\n");
  EXPECT_NEAR(load_camera_path(files_.path("images.txt"), {}).projection.yfov_rad * kDegPerRad, 90, 1e-12);
  put("cameras.txt", "7 SIMPLE_RADIAL 1920 1080 540 960 540 0.01\n");
  EXPECT_THAT(load_camera_path(files_.path("images.txt"), {}).warnings.at(0), HasSubstr("distorted"));
  put("cameras.txt", "8 PINHOLE 1920 1080 900 540 960 540\n");
  EXPECT_THAT(refusal("images.txt", images), HasSubstr("images.txt:6: camera 7 is not in cameras.txt"));
  put("cameras.txt", "7 PINHOLE 1920 1080 900 540 960\n");
  EXPECT_THAT(refusal("images.txt", images), HasSubstr("cameras.txt:1: PINHOLE has 4 parameters, not 3"));
  std::filesystem::remove(files_.path("cameras.txt"));
  EXPECT_THAT(refusal("images.txt", "1 1 0 0 0 1 2 3 7 a.jpg\n\n2 0 0 0 0 1 2 3 7 b.jpg\n"),
              HasSubstr("images.txt:3: quaternion (-0, -0, -0, 0) has no direction"));
  EXPECT_THAT(refusal("images.txt", "1 1 0 0 0 1 2 3 7 a.jpg\n\n2 1 0 0 0 1 2 3\n"),
              HasSubstr("images.txt:3: is not the line of a picture: it has less than 10 values"));
}

// Without its empty lines, each second picture would pass for the points of the one before.
TEST_F(CameraFormats, ColmapWithoutItsEmptyLinesIsRefused) {
  EXPECT_THAT(refusal("images.txt", "1 1 0 0 0 1 2 3 7 a.jpg\n2 1 0 0 0 1 2 3 7 b.jpg\n"),
              HasSubstr("images.txt:2: where the points of a picture belong"));
  EXPECT_THAT(
      refusal("images.txt", "1 1 0 0 0 1 2 3 7 a 1.jpg\n\n2 1 0 0 0 1 2 3 7 b 2.jpg\n3 1 0 0 0 1 2 3 7 c.jpg\n"),
      HasSubstr("images.txt:4: where the points"));
  EXPECT_EQ(read("images.txt", "1 1 0 0 0 1 2 3 7 a.jpg\n10 20 -1\n2 1 0 0 0 1 2 3 7 b.jpg").end_ns, 62'500'000);
}

// The poses of NerfMatricesGoFromCameraToWorld. Those of instant-ngp are made by its own steps: columns 1 and 2 change
// sign, places are scaled by 0.33 and moved by 0.5, and rows x, y, z become rows z, x, y.
TEST_F(CameraFormats, CameraPathsOfNerfPrograms) {
  const std::string poses = R"("camera_path": [
    {"camera_to_world": [1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 5, 0, 0, 0, 1], "fov": 35, "aspect": 1.7},
    {"camera_to_world": [0, 0, 1, 2, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1], "fov": 35, "aspect": 1.7}])";
  const CameraPath shown = read("camera_path.json", "{\"camera_type\": \"perspective\", \"fps\": 24, " + poses + "}");
  expect_view(shown.pose_at(20'833'333), {0, 1, 5}, kForward, kUp);
  expect_view(shown.pose_at(62'500'000), {2, 0, 0}, {-1, 0, 0}, kUp);
  EXPECT_NEAR(shown.projection.yfov_rad * kDegPerRad, 35, 1e-12);
  EXPECT_TRUE(shown.warnings.empty());
  EXPECT_THAT(read("s.json", "{\"seconds\": 4, " + poses + "}").warnings.at(0), HasSubstr("`camera-fps` 0.5 keeps"));
  EXPECT_THAT(read("w.json", "{\"camera_type\": \"equirectangular\", " + poses + "}").warnings.at(0),
              HasSubstr("a straight, centred one is rendered"));
  EXPECT_THAT(refusal("c.json", R"({"camera_path": [{"camera_to_world": [1, 0]}]})"),
              HasSubstr("c.json: camera_path[0]: has no camera_to_world of 4 rows"));

  // (0, 1, 5) becomes (0.33 + 0.5, 1.65 + 0.5, 0.5). The matrix of an upright camera, diag(1, -1, -1) in its own world,
  // has the rows (0, -1, 0), (0, 0, -1), (1, 0, 0): the quaternion (0.5, -0.5, 0.5, 0.5).
  const CameraPath steered = read("base_cam.json", R"({"path": [
    {"R": [0.5, -0.5, 0.5, 0.5], "T": [0.83, 2.15, 0.5], "fov": 50.625, "scale": 1.5, "slice": 0.0},
    {"R": [1, -1, 1, 1], "T": [0.5, 0.5, 1.16], "fov": 50.625, "scale": 1.5, "slice": 0.0}], "time": 0.5})");
  expect_view(steered.pose_at(20'833'333), {0, 1, 5}, kForward, kUp);
  expect_view(steered.pose_at(62'500'000), {2, 0, 0}, kForward, kUp);
  EXPECT_NEAR(steered.projection.yfov_rad * kDegPerRad, 50.625, 1e-12);
  EXPECT_THAT(steered.warnings.at(0), HasSubstr("instant-ngp's unit cube"));
  EXPECT_THAT(refusal("r.json", R"({"path": [{"R": [0, 0, 1], "T": [0, 0, 0]}]})"), HasSubstr("has no R of 4 numbers"));
}

TEST_F(CameraFormats, NamesWhatItDoesNotRead) {
  EXPECT_THAT(refusal("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"),
              HasSubstr("poses.txt: is in KITTI's form"));
  EXPECT_THAT(refusal("n.tum", "1403636580000000000.000000 0 0 0 0 0 0 1\n1403636580041666816.0 0 0 0 0 0 0 1\n"),
              HasSubstr("look like nanoseconds, where TUM has seconds: the last is 1403636580041666816"));
  EXPECT_THAT(refusal("u.tum", "1403636580000000 0 0 0 0 0 0 1\n"), HasSubstr("look like microseconds"));
  EXPECT_THAT(refusal("m.tum", "1403636580000 0 0 0 0 0 0 1\n"), HasSubstr("look like milliseconds"));
  EXPECT_THAT(refusal("z.tum", "0 0 0 0 0 0 0 1\n41666816 0 0 0 0 0 0 1\n83333376 0 0 0 0 0 0 1\n"),
              HasSubstr("they are 41666560 or more apart"));
  EXPECT_EQ(read("s.tum", "1403636580.5 0 0 0 0 0 0 1\n1403636581 0 0 0 0 0 0 1\n").end_ns, 500'000'000);
}

// A Unity camera at (1, 2, 3), yawed 90 degrees to the right: looks along Unity's +x, which is +x here too; z changes
// its sign.
TEST_F(CameraFormats, UnityIsMirroredInCsvAndTum) {
  CameraReadOptions options;
  options.axes = CameraAxes::unity;
  const std::string h = "0.70710678118654752";
  for (const CameraPath& path : {read("u.csv", "t[s],x,y,z,qx,qy,qz,qw\n0,1,2,3,0," + h + ",0," + h + "\n", options),
                                 read("u.tum", "0 1 2 3 0 " + h + " 0 " + h + "\n", options)}) {
    expect_view(path.pose_at(0), {1, 2, -3}, {1, 0, 0}, kUp);
    expect_near(rotate(path.pose_at(0).orientation, kRight), {0, 0, 1});
  }
}

}  // namespace
}  // namespace gazetrace::camera_formats_test
