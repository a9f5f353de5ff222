// SPDX-License-Identifier: Apache-2.0
// Formats on files of our own, made after their documentation: head-mounted displays and glasses.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "gazelog/row_samples.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_formats_head_test {
namespace {

using ::testing::HasSubstr;

TEST_F(GazeFormats, PupilCloudUnwornAndNoBreakSpaces) {
  GazeReadOptions options;
  options.frame = GazeFrame::head;
  const GazeLog log = read("gaze.csv",
                           "section id,recording id,timestamp [ns],gaze x\xC2\xA0[px],gaze y\xC2\xA0[px],worn,fixation "
                           "id,blink id,azimuth [deg],elevation [deg]\na,b,1,800,600,1,,,0,0\na,b,2,800,600,0,,,0,0\n"
                           "a,b,3,800,600,,,,90,0\n",
                           options);
  EXPECT_EQ(log.format, "pupil-cloud");
  EXPECT_EQ(log.samples[0].validity, GazeValidity::ok);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  EXPECT_NEAR(log.samples[2].direction.x, 1, 1e-15);
}

// Pupil Cloud's own azimuth and elevation of the same pixels, through the lens that it ships beside them.
TEST_F(GazeFormats, TheLensAgreesWithAzimuthAndElevation) {
  const std::string folder = std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/pupil-invisible-cloud";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not here";
  }
  const SceneLens lens = load_scene_lens(folder + "/scene_camera.json");
  struct Row {
    double x, y, azimuth, elevation;
  };
  for (const Row& r : {Row{629.146, 647.936, 7.700536268254241, -8.617572141588298},
                       Row{362.88, 564.426, -12.476189956951853, -2.316418533853971},
                       Row{476.827, 558.565, -3.859244830514583, -1.8912318761865106}}) {
    const Vec3d ray = ray_of(lens, {r.x, r.y});
    // Pixels are written to 0.001: half of that on both axes, over a focal length of 757 px.
    const double rounding_deg = 0.0005 * std::sqrt(2.0) / 757 * kDegPerRad;
    EXPECT_NEAR(std::atan2(ray.x, ray.z) * kDegPerRad, r.azimuth, rounding_deg);
    EXPECT_NEAR(-std::asin(ray.y) * kDegPerRad, r.elevation, rounding_deg);
  }
}

TEST_F(GazeFormats, NeonWithItsLensGivesDirections) {
  std::string raw;
  std::string times;
  for (int i = 0; i < 3; ++i) {
    const float at[2] = {800.0F + 100.0F * static_cast<float>(i), 600.0F};
    const std::uint64_t t = 1'700'000'000'000'000'001ULL + static_cast<std::uint64_t>(i) * 5'000'000ULL;
    raw.append(reinterpret_cast<const char*>(at), 8);
    times.append(reinterpret_cast<const char*>(&t), 8);
  }
  const std::string path = files_.write("gaze ps1.raw", raw);
  put("gaze ps1.time", times);
  put("worn ps1.raw", std::string("\xFF\xFF\x00", 3));
  put("scene_camera.json",
      R"({"camera_matrix": [[800, 0, 800], [0, 800, 600], [0, 0, 1]], "distortion_coefficients": [0, 0, 0, 0, 0, 0, 0, 0]})");
  GazeReadOptions options;
  options.frame = GazeFrame::head;
  const GazeLog log = load_gaze_log(path, options);
  EXPECT_EQ(log.format, "neon-native");
  EXPECT_EQ(log.samples[0].t_ns, 1'700'000'000'000'000'001);
  EXPECT_NEAR(log.samples[0].direction.z, -1, 1e-15);
  EXPECT_NEAR(log.samples[1].direction.x, 0.125 / std::hypot(1, 0.125), 1e-12);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);  // not worn
  put("gaze ps1.time", times.substr(0, 20));
  EXPECT_THROW(load_gaze_log(path, options), Error);
}

TEST_F(GazeFormats, VarjoInItsViewFrame) {
  const GazeLog log =
      read("varjo.csv",
           "raw_timestamp,relative_to_video_first_frame_timestamp,status,gaze_forward_x,gaze_forward_y,gaze_forward_z,"
           "left_forward_x,left_forward_y,left_forward_z,left_origin_x,left_origin_y,left_origin_z,left_status,"
           "right_forward_x,right_forward_y,right_forward_z,right_origin_x,right_origin_y,right_origin_z,right_status\n"
           "9007199254740993,-5,2,0.6,0,0.8,0,0,1,-0.031,0,0,3,0,0,1,0.031,0,0,2\n"
           "9007199264740993,5,1,0.6,0,0.8,0,0,1,-0.031,0,0,1,0,0,1,0.031,0,0,2\n"
           "9007199274740993,15,0,-nan(ind),-nan(ind),-nan(ind),0,0,1,-0.031,0,0,0,0,0,1,0.031,0,0,0\n");
  EXPECT_EQ(log.format, "varjo");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[0].t_ns, 9'007'199'254'740'993);
  EXPECT_EQ(log.samples[0].direction, (Vec3d{0.6, 0, -0.8}));
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);  // adjusting
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
  EXPECT_EQ(log.eyes[1].left.validity, GazeValidity::lost);
  EXPECT_EQ(log.eyes[1].right.validity, GazeValidity::ok);
  EXPECT_FLOAT_EQ(log.origins[0].left_mm.x, -31);
  GazeReadOptions options;
  options.columns.time = "relative_to_video_first_frame_timestamp";
  EXPECT_EQ(load_gaze_log(files_.path("varjo.csv"), options).samples[0].t_ns, -5);
}

TEST_F(GazeFormats, ViveThatWasTurnedAlreadyIsTurnedBack) {
  const std::string header =
      "time(100ns);frame;eye_valid_L;eye_valid_R;openness_L;openness_R;pupil_diameter_L(mm);pupil_diameter_R(mm);"
      "gaze_origin_L.x(mm);gaze_origin_L.y(mm);gaze_origin_L.z(mm);gaze_origin_R.x(mm);gaze_origin_R.y(mm);"
      "gaze_origin_R.z(mm);gaze_direct_L.x;gaze_direct_L.y;gaze_direct_L.z;gaze_direct_R.x;gaze_direct_R.y;"
      "gaze_direct_R.z;helmet_pos_x;helmet_pos_y;helmet_pos_z;helmet_rot_x;helmet_rot_y;helmet_rot_z\n";
  const auto row = [](int frame, int origin_left, double x) {
    return fmt::format("{};{};31;31;1;1;3;-1;{};0;0;{};0;0;{};0;0.8;{};0;0.8;1;2;3;0;{};0\n",
                       638342802882596202 + frame * 80000, frame, origin_left, -origin_left, x, x, 359 + frame);
  };
  const GazeLog sdk = read("sdk.csv", header + row(0, 38, 0.6) + row(1, 38, 0.6) + row(1, 38, 0.6));
  EXPECT_EQ(sdk.format, "vive-sranipal");
  ASSERT_EQ(sdk.samples.size(), 2U);  // the frame counter stood still
  EXPECT_THAT(sdk.warnings.at(0), HasSubstr("1 rows repeat the sample counter 'frame'"));
  EXPECT_EQ(sdk.samples[0].direction.x, -0.6);
  EXPECT_TRUE(std::isnan(sdk.eyes[0].right.pupil));  // -1
  const GazeLog turned = read("unity.csv", header + row(0, -38, 0.6) + row(1, -38, 0.6));
  EXPECT_EQ(turned.samples[0].direction.x, 0.6);
  EXPECT_LT(turned.origins[0].left_mm.x, turned.origins[0].right_mm.x);
  // 359 and 360 degrees about y are one degree apart.
  const auto view = [&](std::size_t i) { return rotate(sdk.head[i].orientation, {0, 0, -1}); };
  EXPECT_NEAR(angle_between_rad(view(0), view(1)) * kDegPerRad, 1, 1e-9);
  EXPECT_LT(view(0).x, 0);  // Unity's yaw of 359 deg is one degree to the left
  EXPECT_EQ(sdk.head[0].position_m, (Vec3d{1, 2, -3}));
}

TEST_F(GazeFormats, OpenXrPoses) {
  const std::string header =
      "time[ns],sample_time,gaze_orientation_x,gaze_orientation_y,gaze_orientation_z,gaze_orientation_w,is_tracked,"
      "head_position_x,head_position_y,head_position_z,head_orientation_x,head_orientation_y,head_orientation_z,"
      "head_orientation_w,space\n";
  const double s = std::sin(15 * kRadPerDeg);
  const double c = std::cos(15 * kRadPerDeg);
  const std::string turned = fmt::format("0,{},0,{}", s, c);  // 30 deg to the left
  const GazeLog log = read("xr.csv", header + "10,7," + turned + ",1,0,1.6,0,0,0,0,1,view\n20,7," + turned +
                                         ",1,0,1.6,0,0,0,0,1,view\n30,8," + turned + ",0,0,1.6,0,0,0,0,1,view\n40,9," +
                                         turned + ",1,0,1.6,0," + turned + ",local\n");
  EXPECT_EQ(log.format, "openxr-pose");
  ASSERT_EQ(log.samples.size(), 3U);  // a clamped sample is no new one
  EXPECT_EQ(log.head.size(), 4U);
  EXPECT_NEAR(log.samples[0].direction.x, -0.5, 1e-12);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  EXPECT_NEAR(log.samples[2].direction.z, -1, 1e-12);  // in the world as the head: straight ahead
}

TEST_F(GazeFormats, DegreesOfGazeBaseNeedNoDisplay) {
  const GazeLog log = read("S_1.csv", "n,x,y,val,xT,yT,dP,lab\n0,10,-5,0,0,0,900,1\n1,NaN,NaN,4,0,0,0,-1\n");
  EXPECT_EQ(log.format, "gazebase");
  EXPECT_NEAR(log.samples[0].direction.x / -log.samples[0].direction.z, std::tan(10 * kRadPerDeg), 1e-15);
  EXPECT_NEAR(log.samples[0].direction.y / -log.samples[0].direction.z, std::tan(-5 * kRadPerDeg), 1e-15);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
}

TEST_F(GazeFormats, GlassesThreeCutOffInItsLastLine) {
  GazeReadOptions options;
  options.frame = GazeFrame::head;
  const std::string line =
      R"({"type":"gaze","timestamp":0.1,"data":{"gaze2d":[0.5,0.5],"eyeleft":{"gazeorigin":[30,0,0],)"
      R"("gazedirection":[0,0,1],"pupildiameter":3},"eyeright":{}}})";
  const GazeLog log = read("gazedata", line + "\n{\"type\":\"gaze\",\"timestamp\":0.2,\"da", options);
  EXPECT_EQ(log.samples.size(), 1U);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("the last line is cut off"));
  EXPECT_THAT(refusal("gazedata2", line + "\n{\"type\": \n" + line + "\n", options),
              HasSubstr("gazedata2:2: is not the JSON"));
}

}  // namespace
}  // namespace gazetrace::gaze_formats_head_test
