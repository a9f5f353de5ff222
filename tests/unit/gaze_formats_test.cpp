// SPDX-License-Identifier: Apache-2.0
// Formats on files of our own, made after their documentation: what no real recording at hand shows.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "gaze/scene_lens.hpp"
#include "gazetrace/gaze.hpp"
#include "support/text_file.hpp"

namespace gazetrace {
namespace {

using ::testing::HasSubstr;

class GazeFormats : public ::testing::Test {
 protected:
  GazeLog read(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    return load_gaze_log(files_.write(name, text), options);
  }
  std::string refusal(std::string_view name, std::string_view text, const GazeReadOptions& options = {}) {
    try {
      read(name, text, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
  void put(std::string_view name, std::string_view text) { ASSERT_FALSE(files_.write(name, text).empty()); }
  TextFiles files_;
};

std::string asc(const std::string& samples_line, const std::string& rows) {
  return "** CONVERTED FROM a.edf using edfapi\n** EYELINK II 1\nMSG\t1 GAZE_COORDS 0 0 1919 1079\n"
         "START\t100 \tLEFT\tSAMPLES\tEVENTS\nPUPIL\tDIAMETER\n" +
         samples_line + "\n" + rows + "END\t200 \tSAMPLES\tEVENTS\tRES\t 40\t 40\n";
}

TEST_F(GazeFormats, EyeLinkAtTwoKilohertz) {
  const GazeLog log = read("a.asc", asc("SAMPLES\tGAZE\tLEFT\tRATE\t2000.00\tTRACKING\tCR\tFILTER\t2",
                                        "100\t 960.0\t 540.0\t 900.0\t...\n100\t 961.0\t 540.0\t 900.0\t...\n"
                                        "101\t 962.0\t 540.0\t 900.0\t...\n101\t 963.0\t 540.0\t 900.0\t...\n"));
  EXPECT_EQ(log.format, "eyelink-asc");
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_EQ(log.samples[1].t_ns, 100'500'000);
  EXPECT_EQ(log.samples[3].t_ns, 101'500'000);
  EXPECT_EQ(log.samples[0].u, 0.5);
  // With times as numbers with a point, nothing is added.
  EXPECT_EQ(read("b.asc", asc("SAMPLES\tGAZE\tLEFT\tRATE\t2000.00", "100.0\t1\t1\t9\t...\n100.5\t1\t1\t9\t...\n"))
                .samples[1]
                .t_ns,
            100'500'000);
}

TEST_F(GazeFormats, EyeLinkRemoteWithVelocityResolutionAndInput) {
  const GazeLog log =
      read("a.asc",
           asc("SAMPLES\tGAZE\tLEFT\tRATE\t500.00\tTRACKING\tCR\tFILTER\t2\tVEL\tRES\tINPUT\tHTARGET",
               "100\t 192.0\t 108.0\t 900.0\t 1.0\t 2.0\t 38.0\t 42.0\t 127\tI..\t 10 20 600 .............\n"
               "102\t 192.0\t 108.0\t 900.0\t 1.0\t 2.0\t 38.0\t 42.0\t 127\t.C.\t-32768 -32768 -32768 M............\n"
               "104\t -32768\t -32768\t 0.0\t . \t . \t 38.0\t 42.0\t 127\t...\t 10 20 600 .............\n"
               "106\t missing missing 0.0\t . \t . \t 38.0\t 42.0\t 127\t...\t 10 20 600 .............\n"));
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_EQ(log.samples[0].validity, GazeValidity::interpolated);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::low_confidence);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[3].validity, GazeValidity::lost);  // what -miss was told
  EXPECT_NEAR(log.pixels_per_degree->x, (4 * 38 + 40) / 5.0, 1e-12);
  EXPECT_EQ(log.pupil_unit, "diameter");
}

TEST_F(GazeFormats, EyeLinkThatIsNotOnTheScreenIsRefused) {
  EXPECT_THAT(refusal("a.asc", asc("SAMPLES\tHREF\tLEFT\tRATE\t1000.00", "100\t1\t1\t9\t...\n")),
              HasSubstr("samples are HREF data"));
  EXPECT_THAT(refusal("b.asc", asc("SAMPLES\tPUPIL\tLEFT\tRATE\t1000.00", "100\t1\t1\t9\t...\n")),
              HasSubstr("samples are PUPIL data"));
}

TEST_F(GazeFormats, TobiiProLabHeadersOldAndNew) {
  const std::string row = "\tEye Tracker\tP1\t{}\t540\t1920\t1080\tFixation\t1\n";
  const std::string rest =
      "\tSensor\tParticipant name\t{}\t{}\tRecording resolution width\tRecording resolution "
      "height\tEye movement type\tEye movement type index\n";
  struct Case {
    std::string time, x, y;
    std::int64_t t_ns;
  };
  for (const Case& c :
       {Case{"Recording timestamp", "Gaze point X", "Gaze point Y", 12'000},
        Case{"Recording timestamp [ms]", "Gaze point X [DACS px]", "Gaze point Y [DACS px]", 12'000'000},
        Case{"Recording timestamp [\xC2\xB5s]", "Gaze point X (DACSpx)", "Gaze point Y (DACSpx)", 12'000},
        Case{"Recording timestamp [\xCE\xBCs]", "Gaze point X", "Gaze point Y", 12'000}}) {
    const std::string text = c.time + fmt::format(fmt::runtime(rest), c.x, c.y) + "12" +
                             fmt::format(fmt::runtime(row), 480) + "12\tMouse\tP1\t1\t1\t1920\t1080\t\t\n" + "20" +
                             fmt::format(fmt::runtime(row), "");
    const GazeLog log = read("log.tsv", text);
    EXPECT_EQ(log.format, "tobii-pro-lab") << c.time;
    ASSERT_EQ(log.samples.size(), 2U) << c.time;  // the mouse has no gaze
    EXPECT_EQ(log.samples[0].t_ns, c.t_ns) << c.time;
    EXPECT_EQ(log.samples[0].u, 0.25);
    EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  }
  EXPECT_THAT(refusal("mcs.tsv",
                      "Recording timestamp\tSensor\tParticipant name\tGaze point X (MCSnorm)\tGaze point Y "
                      "(MCSnorm)\n1\tEye Tracker\tP\t0.5\t0.5\n"),
              HasSubstr("media coordinates (MCS)"));
  EXPECT_THAT(refusal("glasses.tsv",
                      "Recording timestamp\tSensor\tParticipant name\tGaze point X\tGaze point Y\tGyro X\n"
                      "1\tEye Tracker\tP\t500\t500\t\n2\tGyroscope\tP\t\t\t0.1\n"),
              HasSubstr("scene camera"));
}

TEST_F(GazeFormats, TobiiProSdkColumnsAndPairs) {
  const GazeLog columns =
      read("a.csv",
           "device_time_stamp,system_time_stamp,left_gaze_point_on_display_area_x,left_gaze_point_on_display_area_y,"
           "left_gaze_point_validity,left_pupil_diameter,left_pupil_validity,right_gaze_point_on_display_area_x,"
           "right_gaze_point_on_display_area_y,right_gaze_point_validity\n"
           "9007199254740993,5,0.5,0.25,1,3.5,1,0.5,0.75,1\n9007199254744326,9,nan,nan,0,nan,0,1.5,0.75,1\n");
  EXPECT_EQ(columns.format, "tobii-sdk");
  EXPECT_EQ(columns.samples[0].t_ns, 9'007'199'254'740'993'000);  // 2^53 + 1: a double would lose the last digit
  EXPECT_NEAR(columns.samples[0].v, 0.5, 1e-15);
  EXPECT_EQ(columns.eyes[0].left.pupil, 3.5F);
  EXPECT_EQ(columns.eyes[1].left.validity, GazeValidity::lost);
  EXPECT_EQ(columns.eyes[1].right.validity, GazeValidity::off_screen);
  const std::string head = "device_time_stamp,left_gaze_point_on_display_area,left_gaze_point_validity\n";
  const GazeLog pairs = read("b.csv", head + "1000,\"(0.5, 0.25)\",1\n2000,\"(nan, nan)\",0\n3000,\"(0.1, 0.2)\",0\n");
  EXPECT_EQ(pairs.samples[0].v, 0.25);
  EXPECT_EQ(pairs.samples[1].validity, GazeValidity::lost);
  EXPECT_EQ(pairs.samples[2].validity, GazeValidity::lost);
  EXPECT_THAT(refusal("c.csv", head + "1000,\"(0.5 0.25)\",1\n"), HasSubstr("c.csv:2: '0.5 0.25' is not a pair"));
}

TEST_F(GazeFormats, GazeOnASurface) {
  const GazeLog core =
      read("gaze_positions_on_surface_Screen.csv",
           "world_timestamp,world_index,gaze_timestamp,x_norm,y_norm,x_scaled,y_scaled,on_surf,"
           "confidence\n1.5,1,1.501,0.25,0.75,480,810,True,0.9\n1.5,1,1.505,0.25,1.75,480,1890,False,0.9\n"
           "1.5,1,1.509,0.25,0.5,480,540,True,0.3\n1.5,1,1.513,9,9,9,9,False,0\n");
  EXPECT_EQ(core.format, "pupil-surface");
  EXPECT_EQ(core.kind, GazeKind::screen);
  EXPECT_EQ(core.samples[0].t_ns, 1'501'000'000);
  EXPECT_EQ(core.samples[0].v, 0.25);  // from the bottom
  EXPECT_EQ(core.samples[1].validity, GazeValidity::off_screen);
  EXPECT_EQ(core.samples[2].validity, GazeValidity::low_confidence);
  EXPECT_EQ(core.samples[3].validity, GazeValidity::lost);
  GazeReadOptions options;
  options.min_confidence = 0.2;
  EXPECT_EQ(load_gaze_log(files_.path("gaze_positions_on_surface_Screen.csv"), options).samples[2].validity,
            GazeValidity::ok);
  const GazeLog cloud =
      read("gaze.csv",
           "section id,recording id,timestamp [ns],gaze detected on surface,gaze position on surface x "
           "[normalized],gaze position on surface y [normalized],fixation id,blink id\n"
           "a,b,1700000000000000001,true,0.25,0.75,1,\na,b,1700000000005000001,true,0.25,0.75,,3\n");
  EXPECT_EQ(cloud.format, "pupil-surface");
  EXPECT_EQ(cloud.samples[0].t_ns, 1'700'000'000'000'000'001);
  EXPECT_EQ(cloud.samples[0].v, 0.75);
  EXPECT_EQ(cloud.samples[1].validity, GazeValidity::blink);
}

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

constexpr const char* kGazepoint =
    "MEDIA_ID,MEDIA_NAME,CNT,TIME(2022/09/19 13:34:49.156),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,"
    "BPOGX,BPOGY,BPOGV,LPD,LPV,LPOGX,LPOGY,LPOGV,BKID,\n";

TEST_F(GazeFormats, GazepointHoldsItsLastValueWhileLost) {
  const GazeLog log =
      read("User 1_all_gaze.csv", std::string(kGazepoint) +
                                      "0,a,1,0.00000,5880000000001,.5,.5,0,0,1,1,0.25,0.75,1,20,1,0.2,0.7,1,0,\n"
                                      "0,a,2,0.01642,5880000164201,.5,.5,0,0,1,1,0.25,0.75,0,20,1,0.2,0.7,0,0,\n"
                                      "0,a,3,0.03284,5880000328401,.5,.5,0,0,1,0,1.08458,0.19156,1,20,1,0.2,0.7,1,0,\n"
                                      "0,a,4,0.04926,5880000492601,.5,.5,0,0,1,0,0.25,0.75,1,20,1,0.2,0.7,1,7,\n");
  EXPECT_EQ(log.format, "gazepoint");
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_EQ(log.samples[0].u, 0.25);
  EXPECT_EQ(log.samples[1].t_ns, 16'420'000);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::off_screen);
  EXPECT_EQ(log.samples[3].validity, GazeValidity::blink);
  for (const GazeFact& fact : log.facts) {
    EXPECT_EQ(fact.value.find("2022"), std::string::npos);  // the wall clock of the header goes nowhere
  }
  GazeReadOptions options;
  options.columns.time = "5";
  EXPECT_EQ(load_gaze_log(files_.path("User 1_all_gaze.csv"), options).samples[0].t_ns, 588'000'000'000'100);
  EXPECT_THAT(refusal("two.csv", std::string(kGazepoint) + "0,a,1,5.0,1,.5,.5,0,0,1,1,.2,.7,1,20,1,.2,.7,1,0,\n"
                                                           "1,b,1,0.0,9,.5,.5,0,0,1,1,.2,.7,1,20,1,.2,.7,1,0,\n"),
              HasSubstr("two.csv:3: TIME starts anew with another medium"));
}

TEST_F(GazeFormats, SmiWithTwoEyesAndLabels) {
  const GazeLog log =
      read("smi.txt",
           "## [BeGaze]\n## Sample Rate:\t250\n## Calibration Area:\t1280\t1024\nTime\tType\tTrial\tL POR X "
           "[px]\tL POR Y [px]\tR POR X [px]\tR POR Y [px]\tL Pupil Diameter [mm]\tL Event Info\n"
           "1000\tSMP\t1\t320.00\t512.00\t320.00\t512.00\t3.1\tFixation\n"
           "5000\tSMP\t1\t0.00\t0.00\t640.00\t512.00\t3.1\tFixation\n"
           "9000\tMSG\t1\t# Message: stimulus.bmp\n9000\tSMP\t1\t640.00\t512.00\t640.00\t512.00\t0\tBlink\n");
  EXPECT_EQ(log.format, "smi");
  ASSERT_EQ(log.eyes.size(), 3U);
  EXPECT_EQ(log.samples[0].u, 0.25);
  EXPECT_EQ(log.eyes[1].left.validity, GazeValidity::lost);
  EXPECT_EQ(log.eyes[2].left.validity, GazeValidity::blink);
  EXPECT_EQ(log.pupil_unit, "mm");
  EXPECT_THAT(refusal("raw.txt", "Time\tType\tTrial\tL Raw X [px]\tL Raw Y [px]\n1\tSMP\t1\t2\t3\n"),
              HasSubstr("there is no point of regard"));
}

TEST_F(GazeFormats, BidsInheritsAndForgivesDrafts) {
  namespace fs = std::filesystem;
  fs::create_directories(files_.path("sub-1/eyetrack"));
  put("dataset_description.json", "{}");
  put("task-x_physio.json",
      R"({"Columns": ["time", "x_coordinate", "y_coordinate"], "SamplingFrequency": 500,
                   "SampleCoordinateSystem": "gaze-on-screen", "x_coordinate": {"Units": "pixel"}})");
  put("sub-1/eyetrack/sub-1_task-x_recording-eye1_physio.json", R"({"RecordedEye": "right"})");
  put("task-x_events.json", R"({"StimulusPresentation": {"ScreenDistance": 1.2, "ScreenOrigin": ["bottom",
               "left"], "ScreenSize": [0.773, 0.445], "ScreenResolution": [1919, 1079]}})");
  const std::string path = files_.write("sub-1/eyetrack/sub-1_task-x_recording-eye1_physio.tsv",
                                        "\xEF\xBB\xBF"
                                        "2\t960\t270\n4\tn/a\tn/a\n6\t0\t0\n");
  const GazeLog log = load_gaze_log(path, {});
  EXPECT_EQ(log.format, "bids");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[0].t_ns, 2'000'000);  // no unit is stated, but 500 Hz is: milliseconds
  EXPECT_EQ(log.samples[0].eye, Eye::right);
  EXPECT_EQ(log.samples[0].u, 0.5);  // 1919 x 1079 are EyeLink's inclusive corners
  EXPECT_EQ(log.samples[0].v, 0.75);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::ok);  // n/a is BIDS' missing, zeros are places
  EXPECT_EQ(log.recording_geometry->distance_cm, 120);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("1919x1079 looks like inclusive corners"));
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

// The bytes of an XDF file; what pyxdf 1.17 makes of the same is in the test.
class XdfBytes {
 public:
  template <class... Values>
  static std::string pack(Values... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
    return bytes;
  }
  static std::string length(std::size_t n) {
    return n < 256 ? pack(std::uint8_t{1}, static_cast<std::uint8_t>(n))
                   : pack(std::uint8_t{4}, static_cast<std::uint32_t>(n));
  }
  void chunk(std::uint16_t tag, const std::string& content) {
    bytes += length(content.size() + 2) + pack(tag) + content;
  }
  std::string bytes = "XDF:";
};

std::string gaze_xdf() {
  XdfBytes xdf;
  xdf.chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>");
  xdf.chunk(2,
            XdfBytes::pack(std::uint32_t{7}) +
                "<?xml version=\"1.0\"?><info><name>t</name><type>Gaze</type><channel_count>3</channel_count>"
                "<nominal_srate>100</nominal_srate><channel_format>float32</channel_format><desc><channels>"
                "<channel><label>Screen_X</label><eye>both</eye><type>ScreenX</type><unit>normalized</unit></channel>"
                "<channel><label>Screen_Y</label><eye>both</eye><type>ScreenY</type><unit>normalized</unit></channel>"
                "<channel><label>Confidence</label></channel></channels></desc></info>");
  for (int k = 0; k < 4; ++k) {
    xdf.chunk(4, XdfBytes::pack(std::uint32_t{7}, 1000 + k * 0.1, 5.5 + 0.001 * k));
  }
  std::string samples = XdfBytes::pack(std::uint32_t{7}) + XdfBytes::length(40);
  for (int i = 0; i < 40; ++i) {
    const double jitter = 0.001 * ((i * 7) % 5 - 2);
    samples +=
        i % 10 == 3 ? XdfBytes::pack(std::uint8_t{0}) : XdfBytes::pack(std::uint8_t{8}, 1000 + i * 0.01 + jitter);
    samples += XdfBytes::pack(0.25F + static_cast<float>(i) / 256, 0.5F, i == 5 ? 0.0F : 1.0F);
  }
  xdf.chunk(3, samples);
  return xdf.bytes;
}

TEST_F(GazeFormats, XdfOnTheRecordersClock) {
  const GazeLog log = read("t.xdf", gaze_xdf());
  EXPECT_EQ(log.format, "xdf");
  ASSERT_EQ(log.samples.size(), 40U);
  EXPECT_EQ(log.nominal_rate_hz, 100);
  // pyxdf.load_xdf of the same bytes, with its default clock synchronisation and dejittering, in seconds to 1 ns.
  EXPECT_NEAR(static_cast<double>(log.samples[0].t_ns), 1005'500'221'707.0, 1.5);
  EXPECT_NEAR(static_cast<double>(log.samples[3].t_ns), 1005'530'534'214.0, 1.5);
  EXPECT_NEAR(static_cast<double>(log.samples[39].t_ns), 1005'894'284'293.0, 1.5);
  EXPECT_EQ(log.samples[4].u, 0.25 + 4.0 / 256);
  EXPECT_EQ(log.samples[5].validity, GazeValidity::lost);
}

TEST_F(GazeFormats, ADamagedXdfGoesOnAtTheNextBoundary) {
  const std::string good = gaze_xdf();
  const std::size_t header_end = good.find("</desc></info>") + 14;
  XdfBytes boundary;
  boundary.bytes = std::string("\x63\x00garbage", 9);
  boundary.chunk(5, "\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4");
  const GazeLog log = read("t.xdf", good.substr(0, header_end) + boundary.bytes + good.substr(header_end));
  EXPECT_EQ(log.samples.size(), 40U);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("damaged"));
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

TEST_F(GazeFormats, ColumnMapsAreSavedAndReused) {
  GazeColumns columns;
  columns.time = "Zeit";
  columns.time_unit = TimeUnit::ms;
  columns.left = {.x = "a",
                  .y = "b",
                  .z = "c",
                  .validity = "ok",
                  .confidence = "",
                  .pupil = "",
                  .openness = "o",
                  .origin_x = "",
                  .origin_y = "",
                  .origin_z = ""};
  columns.axes = GazeAxes::unity;
  columns.head_x = "hx";
  columns.valid_values = {"good", "1"};
  columns.valid_mask = 6;
  columns.head_m_per_unit = 0.01;
  const std::string path = files_.path("map.json");
  save_gaze_columns(columns, path);
  EXPECT_EQ(load_gaze_columns(path), columns);
  GazeColumns over;
  over.time = "t";
  const GazeColumns merged = merge_gaze_columns(columns, over);
  EXPECT_EQ(merged.time, "t");
  EXPECT_EQ(merged.left.x, "a");
  try {
    load_gaze_columns(files_.write("bad.json", R"({"tiem": "x"})"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown key 'tiem'; did you mean 'time'?"));
  }
  EXPECT_THROW(load_gaze_columns(files_.write("worse.json", R"({"axes": "left"})")), Error);
}

TEST_F(GazeFormats, FlagsMendWhatALogGotWrong) {
  const std::string text = "# display_px 1000 1000\nt[ms],x[px],y[px]\n0,0,0\n1,250,100\n";
  GazeReadOptions options;
  options.zero_is_missing = true;
  options.swap_xy = true;
  const GazeLog log = read("log.csv", text, options);
  EXPECT_EQ(log.samples[0].validity, GazeValidity::lost);
  EXPECT_EQ(log.samples[1].u, 0.1);
  EXPECT_EQ(log.samples[1].v, 0.25);
  // Also of formats that state their origin themselves.
  GazeReadOptions flipped;
  flipped.columns.origin = PositionOrigin::bottom_left;
  const GazeLog asc_log = read("a.asc", asc("SAMPLES\tGAZE\tLEFT\tRATE\t500", "100\t0\t270\t9\t...\n"), flipped);
  EXPECT_EQ(asc_log.samples[0].v, 0.75);
  EXPECT_THAT(asc_log.warnings.at(0), HasSubstr("--gaze-origin bottom-left was given and is used"));
}

}  // namespace
}  // namespace gazetrace
