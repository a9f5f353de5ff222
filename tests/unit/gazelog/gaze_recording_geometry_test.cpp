// SPDX-License-Identifier: Apache-2.0
// What the user says of the recording's screen against what the log says: the eye's place, and pixels per degree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "gazetrace/gaze_inspect.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_recording_geometry_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GazeRecordingGeometry : public GazeFormats {
 protected:
  // The eye stands 10 cm left of and 5 above the center of a display of 40 x 20 cm, 50 away.
  static constexpr std::string_view kLog =
      "# gazetrace-gaze 1\n# display_px 1000 500\n# display_mm 400 200\n# distance_mm 500\n# eye_cm -10 5\n"
      "t[ns],u[1],v[1],valid,eye\n0,0.5,0.5,ok,cyclopean\n1000000,0.6,0.5,ok,cyclopean\n";
  GazeLog log_with(const GazeReadOptions& options) { return read("log.csv", kLog, options); }
};

TEST_F(GazeRecordingGeometry, AnotherDistanceLeavesTheEyeWhereItIs) {
  GazeReadOptions options;
  options.display = DisplayGeometry{.distance_cm = 50};
  GazeLog log = log_with(options);
  EXPECT_EQ(log.recording_geometry->eye_x_cm, -10);
  EXPECT_EQ(log.recording_geometry->eye_y_cm, 5);
  EXPECT_THAT(log.warnings, IsEmpty());
  options.display->distance_cm = 80;
  log = log_with(options);
  EXPECT_EQ(log.recording_geometry->eye_x_cm, -10);
  EXPECT_THAT(log.warnings, ElementsAre(HasSubstr("a distance of 50 cm; the given 80 cm are used")));
}

TEST_F(GazeRecordingGeometry, TheGivenPlaceOfTheEyeIsUsedWithAWarning) {
  GazeReadOptions options;
  options.eye_cm = Vec2d{0, 0};
  for (const bool with_display : {false, true}) {
    if (with_display) {
      options.display = DisplayGeometry{};
    }
    const GazeLog log = log_with(options);
    EXPECT_EQ(log.recording_geometry->eye_x_cm, 0);
    EXPECT_EQ(log.recording_geometry->eye_y_cm, 0);
    EXPECT_EQ(log.recording_geometry->distance_cm, 50);
    EXPECT_THAT(log.warnings,
                ElementsAre(AllOf(HasSubstr("the eye is -10, 5 cm off"), HasSubstr("the given 0, 0 cm"))));
  }
  options.eye_cm = Vec2d{-10.4, 5};
  const GazeLog close = log_with(options);
  EXPECT_EQ(close.recording_geometry->eye_x_cm, -10.4);
  EXPECT_THAT(close.warnings, IsEmpty());
  // A screen that says itself where the eye is, as a .json file may.
  options.eye_cm.reset();
  options.display = DisplayGeometry{.eye_x_cm = 3};
  EXPECT_EQ(log_with(options).recording_geometry->eye_x_cm, 3);
}

TEST_F(GazeRecordingGeometry, InspectionLooksFromTheEye) {
  GazeLog log;
  log.recording_geometry = DisplayGeometry{
      .width_px = 1000, .height_px = 500, .width_cm = 40, .height_cm = 20, .distance_cm = 50, .eye_x_cm = -10};
  for (int i = 0; i < 200; ++i) {
    GazeSample sample;
    sample.t_ns = i * 2'000'000;
    sample.u = sample.v = 0.5;
    log.samples.push_back(sample);
    // 1 cm beside each other, the right eye's gaze straight ahead of the eye.
    log.eyes.push_back({{{0.275, 0.5, 0}, 1, 3, GazeValidity::ok}, {{0.25, 0.5, 0}, 1, 3, GazeValidity::ok}});
  }
  log.order.rows = log.samples.size();
  const double expected_deg = std::atan2(1, 50) * kDegPerRad;
  EXPECT_NEAR(inspect_gaze(log, {}).disparity->horizontal, expected_deg, 1e-12);
  GazeInspectOptions options;
  options.display = DisplayGeometry{.distance_cm = 50};
  EXPECT_NEAR(inspect_gaze(log, options).disparity->horizontal, expected_deg, 1e-12);
}

TEST_F(GazeRecordingGeometry, PixelsPerDegreeAreHeldAgainstTheGivenScreen) {
  // RES 40 x 40 px/deg, 1920 x 1080 px.
  const std::string text = asc("SAMPLES\tGAZE\tLEFT\tRATE\t1000.00", "100\t1\t1\t9\t...\n101\t1\t1\t9\t...\n");
  const auto with = [&](double width_cm, double height_cm) {
    GazeReadOptions options;
    options.display = DisplayGeometry{.width_cm = width_cm, .height_cm = height_cm, .distance_cm = 100};
    return read("a.asc", text, options).warnings;
  };
  // 1920 px in 48 arc degrees at 100 cm are 83.8 cm, 1080 in 27 are 47.1.
  EXPECT_THAT(with(48 * kRadPerDeg * 100, 27 * kRadPerDeg * 100), IsEmpty());
  EXPECT_THAT(with(48 * kRadPerDeg * 101, 27 * kRadPerDeg * 100), IsEmpty());
  EXPECT_THAT(with(24 * kRadPerDeg * 100, 13.5 * kRadPerDeg * 100),
              ElementsAre(AllOf(HasSubstr("states 40 x 40 pixels a degree"), HasSubstr("has 80 x 80"))));
  EXPECT_THAT(with(48 * kRadPerDeg * 100, 26 * kRadPerDeg * 100), ElementsAre(HasSubstr("pixels a degree")));
}

TEST_F(GazeRecordingGeometry, APartThatDoesNothingIsTold) {
  const std::string text = asc("SAMPLES\tGAZE\tLEFT\tRATE\t1000.00", "100\t1\t1\t9\t...\n101\t1\t1\t9\t...\n");
  const auto with = [&](const DisplayGeometry& display, std::optional<Vec2d> eye_cm) {
    GazeReadOptions options;
    options.display = display;
    options.eye_cm = eye_cm;
    return read("a.asc", text, options).warnings;
  };
  EXPECT_THAT(with({}, Vec2d{10, 5}), ElementsAre(AllOf(HasSubstr("not used: the eye's place"), HasSubstr("40 x 40"))));
  EXPECT_THAT(with({.distance_cm = 57}, Vec2d{10, 5}), ElementsAre(HasSubstr("the distance and the eye's place")));
  EXPECT_THAT(with({.width_cm = 40, .height_cm = 30}, std::nullopt), ElementsAre(HasSubstr("the size in cm")));
  // Pixels alone are used, and with size and distance all is.
  EXPECT_THAT(with({.width_px = 1920, .height_px = 1080}, std::nullopt), IsEmpty());
  const double width_cm = 48 * kRadPerDeg * 100;
  const double height_cm = 27 * kRadPerDeg * 100;
  EXPECT_THAT(with({.width_cm = width_cm, .height_cm = height_cm, .distance_cm = 100}, Vec2d{10, 5}), IsEmpty());
  // A log without pixels per degree keeps what is given for whoever completes it.
  GazeReadOptions options;
  options.display = DisplayGeometry{.width_px = 1000, .height_px = 500, .distance_cm = 57};
  EXPECT_THAT(read("b.csv", "t[ms],x[px],y[px]\n0,500,250\n2,510,250\n", options).warnings, IsEmpty());
}

}  // namespace
}  // namespace gazetrace::gaze_recording_geometry_test
