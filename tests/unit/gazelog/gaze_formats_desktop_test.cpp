// SPDX-License-Identifier: Apache-2.0
// Formats on files of our own, made after their documentation: trackers below a screen, and gaze on surfaces.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_formats_desktop_test {
namespace {

using ::testing::HasSubstr;

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

// The display of a block is the one that was stated before it: 612.5 - 100 = 512.5 and 434 - 50 = 384, of 1024 x 768.
TEST_F(GazeFormats, EyeLinkWhoseCornerMovesBetweenBlocks) {
  const auto block = [](const std::string& corners, int from, const std::string& rows) {
    return "MSG\t" + std::to_string(from - 1) + " DISPLAY_COORDS " + corners + "\nSTART\t" + std::to_string(from) +
           " \tLEFT\tSAMPLES\tEVENTS\nSAMPLES\tGAZE\tLEFT\tRATE\t1000.00\n" + rows + "END\t" +
           std::to_string(from + 50) + " \tSAMPLES\tEVENTS\tRES\t 40\t 40\n";
  };
  const std::string text =
      "** CONVERTED FROM a.edf using edfapi\n** EYELINK II 1\n" +
      block("100 50 1123 817", 100, "100\t 612.5\t 434.0\t 900.0\t...\n101\t 99\t 50\t 900.0\t...\n") +
      block("0 0 1023 767", 200, "200\t 612.5\t 434.0\t 900.0\t...\n201\t 0\t 0\t 900.0\t...\n");
  const GazeLog log = read("a.asc", text);
  ASSERT_EQ(log.samples.size(), 4U);
  EXPECT_EQ(log.samples[0].u, 512.5 / 1024);
  EXPECT_EQ(log.samples[0].v, 384.0 / 768);
  EXPECT_EQ(log.samples[1].u, -1.0 / 1024);
  EXPECT_EQ(log.samples[1].v, 0);
  EXPECT_EQ(log.samples[1].validity, GazeValidity::off_screen);
  EXPECT_EQ(log.samples[2].u, 612.5 / 1024);
  EXPECT_EQ(log.samples[2].v, 434.0 / 768);
  EXPECT_EQ(log.samples[3].validity, GazeValidity::ok);
}

// Rows that the user calls missing are lost, also where the tracker has flags of its own for them, and no part of the
// means that are held against the tracker's: without them both agree exactly.
TEST_F(GazeFormats, EyeLinkRowsThatAreCalledMissing) {
  std::string rows;
  for (int fixation = 0; fixation < 5; ++fixation) {
    const int x = 400 + 100 * fixation;
    const int y = fixation % 2 == 0 ? 300 : 600;
    const int t = 100 + 10 * fixation;
    rows += fmt::format("{}\t {}\t {}\t 900.0\t...\n{}\t {}\t {}\t 900.0\t...\n", t, x - 5, y, t + 1, x + 5, y);
    rows += fixation == 3 ? fmt::format("{}\t 0\t 0\t 900.0\t.CR\n", t + 2) : "";
    rows += fmt::format("EFIX L   {}\t{}\t3\t  {}.0\t  {}.0\t    900\n", t, t + 2, x, y);
  }
  const std::string text = asc("SAMPLES\tGAZE\tLEFT\tRATE\t1000.00", rows);
  GazeReadOptions options;
  const GazeLog as_written = read("a.asc", text, options);
  ASSERT_EQ(as_written.samples.size(), 11U);
  EXPECT_EQ(as_written.samples[8].validity, GazeValidity::low_confidence);
  ASSERT_EQ(as_written.witnesses.size(), 1U);
  EXPECT_LT(as_written.witnesses[0].xx, 0.9);
  const auto expect_lost = [&] {
    const GazeLog log = read("a.asc", text, options);
    EXPECT_EQ(log.samples[8].validity, GazeValidity::lost);
    EXPECT_TRUE(std::isnan(log.samples[8].u));
    ASSERT_EQ(log.witnesses.size(), 1U);
    EXPECT_NEAR(log.witnesses[0].xx, 1, 1e-12);
    EXPECT_NEAR(log.witnesses[0].yy, 1, 1e-12);
  };
  options.missing_value = 0;
  expect_lost();
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

}  // namespace
}  // namespace gazetrace::gaze_formats_desktop_test
