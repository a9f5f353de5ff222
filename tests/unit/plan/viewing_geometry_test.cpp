// SPDX-License-Identifier: Apache-2.0
// The screen of a recording and the screen it is watched on: where each comes from, whom to trust, and how gaze is
// carried from one to the other. Numbers are worked by hand.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/plan.hpp"
#include "support/text_file.hpp"

namespace gazetrace::viewing_geometry_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// 40 x 22.5 cm at 50 cm, and one of twice the size at the same distance.
constexpr DisplayGeometry kSmall{
    .width_px = 1920, .height_px = 1080, .width_cm = 40, .height_cm = 22.5, .distance_cm = 50};
constexpr DisplayGeometry kLarge{
    .width_px = 3840, .height_px = 2160, .width_cm = 80, .height_cm = 45, .distance_cm = 50};

GazeLog log_at(double u, double v) {
  GazeLog log;
  log.source = "gaze.csv";
  GazeSample sample;
  sample.u = u;
  sample.v = v;
  sample.row = 2;
  log.samples.push_back(sample);
  log.recording_geometry = kSmall;
  return log;
}

PlanSettings settings_for(const DisplayGeometry& display) {
  PlanSettings settings;
  settings.frames = {1};
  settings.width_px = 1920;
  settings.height_px = 1080;
  settings.display = display;
  return settings;
}

FramePlan plan(const GazeLog& log, const PlanSettings& settings) {
  return plan_frames(static_camera({}, {}), &log, settings);
}

std::string refusal(const GazeLog& log, const PlanSettings& settings) {
  try {
    plan(log, settings);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "accepted";
}

TEST(GazeTransfer, MustBeChosenWhereTheScreensDiffer) {
  const GazeLog log = log_at(0.75, 0.5);
  // 2 atan(20 / 50) = 43.6 deg and 2 atan(40 / 50) = 77.3 deg.
  EXPECT_EQ(
      refusal(log, settings_for(kLarge)),
      "gaze.csv: recorded on a display 43.6 deg wide and shown on one 77.3 deg wide; choose with `gaze-transfer`: "
      "fraction keeps positions on the display (angles near its center change by a factor of 2.00), angle keeps "
      "angles; or, where the log states its display wrongly, say with `recording-screen` which it was");
  // The same angles at another size are no difference, nor are 1.9 %.
  EXPECT_THAT(
      plan(log, settings_for({.width_px = 640, .height_px = 360, .width_cm = 80, .height_cm = 45, .distance_cm = 100}))
          .warnings,
      IsEmpty());
  DisplayGeometry near = kSmall;
  near.distance_cm = 50 / 1.019;
  EXPECT_THAT(plan(log, settings_for(near)).warnings, IsEmpty());
  near.distance_cm = 50 / 1.021;
  EXPECT_THAT(refusal(log, settings_for(near)), HasSubstr("`gaze-transfer`"));
  // Nor may the eye stand elsewhere: 2 cm of 40.
  DisplayGeometry aside = kSmall;
  aside.eye_x_cm = 2;
  EXPECT_THAT(refusal(log, settings_for(aside)), HasSubstr("`gaze-transfer`"));
}

TEST(GazeTransfer, KeepsPlacesOrAngles) {
  const GazeLog log = log_at(0.75, 0.25);
  PlanSettings settings = settings_for(kLarge);
  settings.transfer = GazeTransfer::fraction;
  FramePlan result = plan(log, settings);
  EXPECT_EQ(result.frames[0].gaze_render.u, 0.75);
  // 20 cm to the right and 11.25 up, 50 away.
  EXPECT_LT(angle_between_rad(*result.frames[0].gaze_direction_render, {20, 11.25, -50}), 1e-15);
  EXPECT_THAT(result.warnings,
              ElementsAre(HasSubstr("as a fraction of the display, so angles near its center change by "
                                    "a factor of 2.00")));
  settings.transfer = GazeTransfer::angle;
  result = plan(log, settings);
  // 10 cm and 5.625 up on the recording's screen, and so on this one: 0.5 + 10 / 80 and 0.5 - 5.625 / 45.
  EXPECT_NEAR(result.frames[0].gaze_render.u, 0.625, 1e-15);
  EXPECT_NEAR(result.frames[0].gaze_render.v, 0.375, 1e-15);
  EXPECT_NEAR(result.frames[0].gaze_true.u, 0.625, 1e-15);
  EXPECT_LT(angle_between_rad(*result.frames[0].gaze_direction_render, {10, 5.625, -50}), 1e-15);
  EXPECT_THAT(result.warnings,
              ElementsAre(HasSubstr("by angle, so distances on the display change by a factor of 0.50")));
  // With the eye 5 cm to the right the same direction meets the screen at 15 cm: 0.5 + 15 / 80.
  settings.display->eye_x_cm = 5;
  result = plan(log, settings);
  EXPECT_NEAR(result.frames[0].gaze_render.u, 0.6875, 1e-15);
  EXPECT_LT(angle_between_rad(*result.frames[0].gaze_direction_render, {10, 5.625, -50}), 1e-15);
  // Pixels of the recording need not be known for that, its size and distance must.
  GazeLog without = log;
  without.recording_geometry->width_px = without.recording_geometry->height_px = 0;
  EXPECT_NEAR(plan(without, settings).frames[0].gaze_render.u, 0.6875, 1e-15);
  without.recording_geometry->distance_cm = 0;
  EXPECT_THAT(refusal(without, settings), HasSubstr("the size and distance of the recording's screen are not known"));
  without.recording_geometry.reset();
  settings.transfer.reset();
  EXPECT_EQ(plan(without, settings).frames[0].gaze_render.u, 0.75);
}

// EyeLink states pixels per degree and no size: that is an angle, too.
TEST(GazeTransfer, PixelsPerDegreeAreAGeometryAsWell) {
  GazeLog log = log_at(0.75, 0.25);
  log.recording_geometry = DisplayGeometry{.width_px = 1000, .height_px = 500};
  log.pixels_per_degree = Vec2d{40, 40};
  PlanSettings settings = settings_for(kLarge);
  // 25 degrees as an arc, 2 atan(25 pi / 360) = 24.6 as an angle, on a display of 77.3.
  EXPECT_THAT(refusal(log, settings), HasSubstr("recorded on a display 24.6 deg wide and shown on one 77.3 deg wide"));
  settings.transfer = GazeTransfer::angle;
  // 250 px right of the center and 125 up are tan = 6.25 and 3.125 pi / 180, times 50 cm on 80 x 45.
  const FramePlan result = plan(log, settings);
  EXPECT_NEAR(result.frames[0].gaze_render.u, 0.5 + 6.25 * kPi / 180 * 50 / 80, 1e-12);
  EXPECT_NEAR(result.frames[0].gaze_render.v, 0.5 - 3.125 * kPi / 180 * 50 / 45, 1e-12);
}

TEST(ScreenLogs, HaveNoAnglesWithoutSizeAndDistance) {
  GazeLog log = log_at(0.5, 0.5);
  log.recording_geometry.reset();
  PlanSettings settings = settings_for(kSmall);
  settings.display.reset();
  EXPECT_THAT(refusal(log, settings), HasSubstr("cannot be turned into angles without the screen's size and distance"));
  settings.display = DisplayGeometry{.width_px = 1920, .height_px = 1080, .width_cm = 40, .height_cm = 22.5};
  EXPECT_THAT(refusal(log, settings), HasSubstr("distance from the eye in cm is not stated"));
}

// Whom a reader trusts for pixels: the user, then the file, then the screen that the gaze is to be shown on.
TEST(ScreenLogs, OrderOfTrust) {
  const TextFiles files;
  const std::string bare = files.write("bare.csv", "t[ms],x[px],y[px]\n0,480,270\n4,480,270\n");
  const std::string stated = files.write("stated.csv",
                                         "# display_px 1920 1080\n# display_mm 400 225\n# distance_mm 500\n"
                                         "t[ms],x[px],y[px]\n0,480,270\n4,480,270\n");
  GazeReadOptions options;
  options.fallback_display = kLarge;
  EXPECT_EQ(load_gaze_log(bare, options).samples[0].u, 0.125);  // 480 / 3840
  EXPECT_FALSE(load_gaze_log(bare, options).recording_geometry.has_value());
  EXPECT_EQ(load_gaze_log(stated, options).samples[0].u, 0.25);  // 480 / 1920, as the file says
  EXPECT_THAT(load_gaze_log(stated, options).warnings, IsEmpty());
  options.display = DisplayGeometry{.width_px = 960, .height_px = 540, .distance_cm = 60};
  const GazeLog given = load_gaze_log(stated, options);
  EXPECT_EQ(given.samples[0].u, 0.5);
  ASSERT_EQ(given.warnings.size(), 2U);
  EXPECT_THAT(given.warnings[0], HasSubstr("the log states a display of 1920x1080 px; the given 960x540 px are used"));
  EXPECT_THAT(given.warnings[1], HasSubstr("the log states a distance of 50 cm; the given 60 cm are used"));
  EXPECT_EQ(given.recording_geometry->width_cm, 40);
  EXPECT_EQ(given.recording_geometry->distance_cm, 60);
  options.display = DisplayGeometry{.width_px = 1920, .height_px = 1080, .width_cm = 50, .height_cm = 22.5};
  EXPECT_THAT(load_gaze_log(stated, options).warnings,
              ElementsAre(HasSubstr("states a display of 40 x 22.5 cm; the given 50 x 22.5 cm are used")));
}

TEST(DisplayFile, HasTheNamesOfTheFields) {
  const TextFiles files;
  const DisplayGeometry display = load_display(files.write(
      "lab.json", R"({"name": "lab", "description": "room 3", "width_px": 2560, "height_px": 1440, "width_cm": 59.7,
                      "height_cm": 33.6, "distance_cm": 70.5, "eye_x_cm": -1.5, "eye_y_cm": 2, "luminance_cd_m2": 120})"));
  EXPECT_EQ(display.width_px, 2560);
  EXPECT_EQ(display.height_px, 1440);
  EXPECT_EQ(display.width_cm, 59.7);
  EXPECT_EQ(display.height_cm, 33.6);
  EXPECT_EQ(display.distance_cm, 70.5);
  EXPECT_EQ(display.eye_x_cm, -1.5);
  EXPECT_EQ(display.eye_y_cm, 2);
  EXPECT_EQ(display.luminance_cd_m2, 120);
  const auto refusal_of = [&](const std::string& text) {
    try {
      load_display(files.write("bad.json", text));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return files.without_folder(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal_of("[1]"), HasSubstr("bad.json: is not a JSON object that describes a display"));
  EXPECT_THAT(refusal_of("{"), HasSubstr("bad.json: is not a JSON object that describes a display"));
  EXPECT_THAT(refusal_of(R"({"width_pix": 3})"), HasSubstr("unknown key 'width_pix'; did you mean 'width_px'?"));
  EXPECT_THAT(refusal_of(R"({"width_px": 3.5})"), HasSubstr("'width_px' is not a whole number of pixels"));
  EXPECT_THAT(refusal_of(R"({"width_px": 30, "height_px": 20, "width_cm": "a"})"),
              HasSubstr("'width_cm' is not a finite"));
  EXPECT_THAT(refusal_of(R"({"width_px": 30, "height_px": 20, "width_cm": 3, "height_cm": 2})"),
              HasSubstr("bad.json: the display's distance from the eye in cm is not stated"));
  EXPECT_THAT(refusal_of(R"({"width_px": 30, "height_px": 20, "width_cm": 3, "height_cm": 2, "distance_cm": 1,
                             "luminance_cd_m2": -1})"),
              HasSubstr("'luminance_cd_m2' is negative"));
  EXPECT_THROW(load_display(files.path("absent.json")), Error);
}

TEST(PixelsPerDegree, StandForSizeAndDistance) {
  const DisplayGeometry display = display_of_pixels_per_degree(1024, 768, {35.19, 37});
  EXPECT_NEAR(pixels_per_degree(display), 35.19, 1e-12);
  // One degree at the middle is 37 px down: 37 / 768 of the height over the distance is pi / 180.
  EXPECT_NEAR(display.height_cm / display.distance_cm * 37 / 768, kRadPerDeg, 1e-15);
}

}  // namespace
}  // namespace gazetrace::viewing_geometry_test
