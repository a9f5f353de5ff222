// SPDX-License-Identifier: Apache-2.0
// What BIDS sidecars say of positions: units and origins that are understood, and those that are refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_bids_units_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class GazeBidsUnits : public GazeFormats {
 protected:
  // One row at (x, y) on a screen of 1000 x 500 px and 1 x 0.5 m, seen from 1 m.
  std::string recording(const std::string& units, const std::string& origin, const std::string& row,
                        const std::string& space = "gaze-on-screen", const std::string& distance = "1.0") {
    put("dataset_description.json", "{}");
    put("task-x_events.json", fmt::format(R"({{"StimulusPresentation": {{"ScreenDistance": {}, {}
        "ScreenSize": [1.0, 0.5], "ScreenResolution": [1000, 500]}}}})",
                                          distance, origin.empty() ? "" : "\"ScreenOrigin\": " + origin + ","));
    put("task-x_physio.json",
        fmt::format(R"({{"Columns": ["timestamp", "x_coordinate", "y_coordinate"], "SamplingFrequency": 500,
            "timestamp": {{"Units": "ms"}}, {} "SampleCoordinateSystem": "{}"}})",
                    units, space));
    return files_.write("task-x_physio.tsv", "2\t" + row + "\n4\tn/a\tn/a\n");
  }
  static std::string units(const std::string& x, const std::string& y) {
    return fmt::format(R"("x_coordinate": {{"Units": "{}"}}, "y_coordinate": {{"Units": "{}"}},)", x, y);
  }
};

TEST_F(GazeBidsUnits, RadiansAreAngles) {
  const GazeLog screen = load_gaze_log(recording(units("rad", "rad"), "", "0.25\t-0.1"), {});
  // From straight ahead, right and up: tan(angle) metres on a screen of 1 x 0.5 m at 1 m.
  EXPECT_NEAR(screen.samples[0].u, 0.5 + std::tan(0.25), 1e-12);
  EXPECT_NEAR(screen.samples[0].v, 0.5 + std::tan(0.1) / 0.5, 1e-12);
  const GazeLog head = load_gaze_log(recording(units("rad", "rad"), "", "0.25\t-0.1", "eye-in-head"), {});
  ASSERT_EQ(head.kind, GazeKind::direction);
  EXPECT_NEAR(std::atan2(head.samples[0].direction.x, -head.samples[0].direction.z), 0.25, 1e-12);
  EXPECT_NEAR(std::atan2(head.samples[0].direction.y, -head.samples[0].direction.z), -0.1, 1e-12);
}

TEST_F(GazeBidsUnits, MetresAndWordsForDegrees) {
  const GazeLog metres = load_gaze_log(recording(units("m", "m"), R"(["top", "left"])", "0.25\t0.125"), {});
  EXPECT_NEAR(metres.samples[0].u, 0.25, 1e-15);
  EXPECT_NEAR(metres.samples[0].v, 0.25, 1e-15);
  const GazeLog degrees = load_gaze_log(recording(units("degrees of visual angle", "deg"), "", "10\t0"), {});
  EXPECT_NEAR(degrees.samples[0].u, 0.5 + std::tan(10 * kRadPerDeg), 1e-12);
}

TEST_F(GazeBidsUnits, OthersAreRefusedUnlessTheUserSays) {
  GazeReadOptions px;
  px.columns.position_unit = PositionUnit::px;
  for (const std::string& text :
       {units("arbitrary", "arbitrary"), units("pixel", "mm"), units("m", "cm"), units("rad", "deg"), std::string()}) {
    const std::string path = recording(text, R"(["top", "left"])", "250\t125");
    EXPECT_THAT(refusal_of(path), AllOf(HasSubstr("Units"), HasSubstr("`unit`"))) << text;
    const GazeLog log = load_gaze_log(path, px);
    EXPECT_EQ(log.samples[0].u, 0.25) << text;
    EXPECT_EQ(log.samples[0].v, 0.25) << text;
  }
  // Against metres, too, his unit is that of the numbers as they stand.
  EXPECT_EQ(load_gaze_log(recording(units("m", "m"), R"(["top", "left"])", "250\t125"), px).samples[0].u, 0.25);
  EXPECT_THAT(refusal_of(recording(units("arbitrary", "arbitrary"), "", "1\t1")), HasSubstr("'arbitrary'"));
}

TEST_F(GazeBidsUnits, OriginsOnTheRightAreRefusedOrTurned) {
  const auto path = [&](const std::string& origin) { return recording(units("pixel", "pixel"), origin, "250\t100"); };
  EXPECT_EQ(load_gaze_log(path(R"(["left", "BOTTOM"])"), {}).samples[0].v, 0.8);
  EXPECT_EQ(load_gaze_log(path(R"(["top", "left"])"), {}).samples[0].v, 0.2);
  EXPECT_THAT(refusal_of(path(R"(["top", "right"])")), AllOf(HasSubstr("top, right"), HasSubstr("`flip-x`")));
  GazeReadOptions flip;
  flip.flip_x = true;
  EXPECT_EQ(load_gaze_log(path(R"(["top", "right"])"), flip).samples[0].u, 0.75);
  EXPECT_EQ(load_gaze_log(path(R"(["bottom", "right"])"), flip).samples[0].v, 0.8);
  EXPECT_THAT(refusal_of(path(R"(["center", "left"])")), HasSubstr("`origin`"));
  GazeReadOptions given;
  given.columns.origin = PositionOrigin::bottom_left;
  EXPECT_EQ(load_gaze_log(path(R"(["center", "left"])"), given).samples[0].v, 0.8);
}

TEST_F(GazeBidsUnits, TheEyesPlaceIsNotDroppedInSilence) {
  const GazeLog log = load_gaze_log(
      recording(units("pixel", "pixel"), R"(["top", "left"])", "1\t1", "gaze-on-screen", "[0.1, 0, 0.8]"), {});
  EXPECT_EQ(log.recording_geometry->distance_cm, 80);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], AllOf(HasSubstr("ScreenDistance [0.1, 0, 0.8]"), HasSubstr("`screen-eye-cm`")));
}

}  // namespace
}  // namespace gazetrace::gaze_bids_units_test
