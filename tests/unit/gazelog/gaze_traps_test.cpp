// SPDX-License-Identifier: Apache-2.0
// Traps that have broken published pipelines, one test each, where no recording and no other test shows them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_traps_test {
namespace {

using ::testing::HasSubstr;

class GazeTraps : public GazeFormats {};

// "Wrong-format file (must name the likely format)."
TEST_F(GazeTraps, AFileOfAnotherFormatIsToldWhatItLooksLike) {
  const std::string lab =
      "Recording timestamp\tSensor\tParticipant name\tGaze point X\tGaze point Y\tRecording resolution "
      "width\tRecording resolution height\n1\tEye Tracker\tP\t5\t5\t1920\t1080\n";
  GazeReadOptions options;
  for (const std::string format : {"eyelink-asc", "arff", "xdf", "tobii-glasses-3", "smi"}) {
    options.format = format;
    EXPECT_THAT(refusal("log.tsv", lab, options), HasSubstr("it looks like `format` tobii-pro-lab")) << format;
  }
  // A broken file of the named format is only broken.
  options.format = "tobii-pro-lab";
  EXPECT_THAT(refusal("log.tsv", lab + "2\tEye Tracker\tP\tx\t5\t1920\t1080\n", options),
              ::testing::Not(HasSubstr("looks like")));
}

TEST_F(GazeTraps, EyeLinkCommentsAndPlacesBesideTheScreen) {
  const GazeLog log =
      read("a.asc",
           "** CONVERTED FROM a.edf using edfapi\nMSG\t1 GAZE_COORDS 0 0 1919 1079\n# comment\n; another\n/ a third\n\n"
           "START\t100 \tLEFT\tSAMPLES\tEVENTS\nSAMPLES\tGAZE\tLEFT\tRATE\t1000.00\n"
           "100\t-192.0\t 540.0\t 900.0\t...\n101\t 1.92e+03\t-5.4e+01\t 900.0\t...\n102\t 1.0E2\t .\t 0.0\t...\n"
           "ESACC L 100 102 3 . . 1.5e+02 900.0 4.5 3.1e+02\nEND\t103 \tSAMPLES\tEVENTS\n");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[0].u, -0.1);
  EXPECT_EQ(log.samples[0].validity, GazeValidity::off_screen);
  EXPECT_EQ(log.samples[1].u, 1.0);
  EXPECT_EQ(log.samples[1].v, -0.05);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
}

// Clocks that began before zero, and epochs beyond 2^53, in every unit.
TEST_F(GazeTraps, NegativeTimesAndLongEpochs) {
  const GazeLog log = read("log.csv", "t[us],u,v\n-1500.5,.5,.5\n-0.001,.5,.5\n0,.5,.5\n");
  EXPECT_EQ(log.samples[0].t_ns, -1'500'500);
  EXPECT_EQ(log.samples[1].t_ns, -1);
  const GazeLog epoch = read("epoch.csv", "t[ns],u,v\n1700000000000000001,.5,.5\n1700000000000000002,.5,.5\n");
  EXPECT_EQ(epoch.samples[1].t_ns - epoch.samples[0].t_ns, 1);
  EXPECT_EQ(read("s.csv", "t[s],u,v\n1700000000.000000001,.5,.5\n").samples[0].t_ns, 1'700'000'000'000'000'001);
}

TEST_F(GazeTraps, VarjoOfAnOlderExportAsksForItsTime) {
  EXPECT_THAT(refusal("old.csv",
                      "capture_time,status,gaze_forward_x,gaze_forward_y,gaze_forward_z,raw\n"
                      "2020:01:02:03:04:05:678,2,0,0,1,1\n",
                      [] {
                        GazeReadOptions options;
                        options.format = "varjo";
                        return options;
                      }()),
              HasSubstr("there is no column raw_timestamp; older exports have other times"));
}

// XrEyeGazeSampleTimeEXT: 0 is no time, so two of them are no repeat; a time to come is a time.
TEST_F(GazeTraps, OpenXrSampleTimesOfZeroAreNoRepeats) {
  const std::string header =
      "time[ns],sample_time,gaze_orientation_x,gaze_orientation_y,gaze_orientation_z,"
      "gaze_orientation_w,location_flags\n";
  // 15: all four bits; 3: valid, but tracked neither in place nor in turn.
  const GazeLog log = read("xr.csv", header + "10,0,0,0,0,1,15\n20,0,0,0,0,1,15\n30,99,0,0,0,1,3\n40,99,0,0,0,1,15\n");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::ok);
  EXPECT_EQ(log.samples[2].t_ns, 30);
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
}

TEST_F(GazeTraps, BidsDraftsHaveOtherNamesAndCentimetres) {
  put("dataset_description.json", "{}");
  put("sub-1_task-x_eyetrack.json",
      R"({"Columns": ["eye_timestamp", "eye1_x_coordinate", "eye1_y_coordinate"], "SamplingFrequency": 1000,
          "SampleCoordinateSystem": "gaze-on-screen", "SampleCoordinateUnit": "pixel"})");
  put("sub-1_task-x_events.json", R"({"StimulusPresentation": {"ScreenDistance": 60, "ScreenSize": [53, 30],
          "ScreenResolution": [1920, 1080], "ScreenOrigin": ["center", "center"]}})");
  const GazeLog log = read("sub-1_task-x_eyetrack.tsv", "time\tx\ty\n1\t0\t0\n2\t480\t270\n");
  ASSERT_EQ(log.samples.size(), 2U);  // the header line is no sample
  EXPECT_EQ(log.samples[0].u, 0.5);
  EXPECT_EQ(log.samples[1].u, 0.75);
  EXPECT_EQ(log.samples[1].v, 0.25);  // up from the centre
  EXPECT_EQ(log.recording_geometry->width_cm, 53);
  EXPECT_EQ(log.recording_geometry->distance_cm, 60);
  EXPECT_EQ(log.warnings.size(), 2U);
}

// Spreadsheets write TIMETICK as 5.88E+12: the stamps are all the same then, and say so instead of being used.
TEST_F(GazeTraps, GazepointTicksThatASpreadsheetRounded) {
  const std::string text =
      "MEDIA_ID,MEDIA_NAME,CNT,TIME(2022/09/19 13:34:49.156),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,"
      "BPOGX,BPOGY,BPOGV,\n0,a,1,0.00000,5.88E+12,.5,.5,0,0,1,1,0.25,0.75,1,\n"
      "0,a,2,0.01642,5.88E+12,.5,.5,0,0,1,1,0.25,0.75,1,\n";
  EXPECT_EQ(read("a.csv", text).samples[1].t_ns, 16'420'000);  // TIME is believed
  GazeReadOptions options;
  options.columns.time = "TIMETICK(f=10000000)";
  EXPECT_THAT(refusal("b.csv", text, options), HasSubstr("b.csv:3: time 588000000000000 ns repeats that of line 2"));
}

TEST_F(GazeTraps, ProLabInvalidEyesAreLostWhateverTheirPlace) {
  const GazeLog log =
      read("lab.tsv",
           "Recording timestamp [ms]\tSensor\tEvent\tParticipant name\tGaze point X\tGaze point Y\t"
           "Gaze point left X\tGaze point left Y\tGaze point right X\tGaze point right Y\tValidity left\t"
           "Validity right\tRecording resolution width\tRecording resolution height\n"
           "0\tEye Tracker\t\tP\t960\t540\t960\t540\t960\t540\tValid\tValid\t1920\t1080\n"
           "4\t\tImageStimulusStart\tP\t\t\t\t\t\t\t\t\t1920\t1080\n"
           "8\tEye Tracker\t\tP\t960\t540\t960\t540\t960\t540\tInvalid\tValid\t1920\t1080\n"
           "12\tEye Tracker\t\tP\t960\t540\t960\t540\t960\t540\tInvalid\tInvalid\t1920\t1080\n");
  ASSERT_EQ(log.samples.size(), 3U);
  ASSERT_EQ(log.eyes.size(), 3U);
  EXPECT_EQ(log.eyes[1].left.validity, GazeValidity::lost);
  EXPECT_EQ(log.eyes[1].right.validity, GazeValidity::ok);
  EXPECT_FALSE(is_usable(log.eyes[2].right.validity));
  ASSERT_EQ(log.events.size(), 1U);
  EXPECT_EQ(log.events[0].text, "ImageStimulusStart");
  EXPECT_EQ(log.events[0].begin_ns, 4'000'000);
}

// Logs in which the eye was never found are read and say so; a frame then follows the policy for missing gaze.
TEST_F(GazeTraps, AllSamplesInvalid) {
  const GazeLog log = read("log.csv", "t[ms],u,v,valid\n0,0,0,0\n4,0,0,0\n");
  EXPECT_EQ(log.samples.size(), 2U);
  EXPECT_FALSE(is_usable(log.samples[0].validity) || is_usable(log.samples[1].validity));
  EXPECT_THAT(log.warnings.at(0), HasSubstr("no row is valid by column 'valid'"));
  EXPECT_EQ(gaze_at(log, {}, 0).state, GazeState::none);
}

TEST_F(GazeTraps, SdkPairsAndMissingEyes) {
  const GazeLog log = read(
      "sdk.csv",
      "device_time_stamp,left_gaze_point_on_display_area,left_gaze_point_validity,right_gaze_point_on_display_area,"
      "right_gaze_point_validity\n0,\"(0.2, 0.5)\",1,\"(0.4, 0.5)\",1\n3333,\"(nan, nan)\",0,\"(0.4, 0.5)\",1\n"
      "6666,\"(nan, nan)\",0,\"(nan, nan)\",0\n");
  ASSERT_EQ(log.samples.size(), 3U);
  EXPECT_EQ(log.eyes[1].left.validity, GazeValidity::lost);
  EXPECT_NEAR(log.samples[1].u, log.samples[0].u, 0.03);  // the other eye stands in without a jump
  EXPECT_EQ(log.samples[2].validity, GazeValidity::lost);
}

}  // namespace
}  // namespace gazetrace::gaze_traps_test
