// SPDX-License-Identifier: Apache-2.0
// Several recordings of one name in a BIDS folder: the eyes are joined where they say the same of themselves, others
// than gaze are left alone.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_bids_recordings_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GazeBidsRecordings : public GazeFormats {
 protected:
  void SetUp() override {
    put("dataset_description.json", "{}");
    put("task-x_events.json", R"({"StimulusPresentation": {"ScreenDistance": 1.0, "ScreenOrigin": ["top", "left"],
        "ScreenSize": [1.0, 0.5], "ScreenResolution": [1000, 500]}})");
  }
  // Two rows of an eye. Returns the table's path.
  std::string eye(const std::string& label, const std::string& which, const std::string& unit, const std::string& rest,
                  const std::string& rows = "2\t250\t125\t3\n4\t251\t125\t3\n") {
    put(fmt::format("task-x_recording-{}_physio.json", label),
        fmt::format(R"({{"Columns": ["timestamp", "x_coordinate", "y_coordinate", "pupil_size"],
            "SamplingFrequency": 500, "timestamp": {{"Units": "ms"}}, "RecordedEye": "{0}",
            "x_coordinate": {{"Units": "{1}"}}, "y_coordinate": {{"Units": "{1}"}}{2}}})",
                    which, unit, rest));
    return files_.write(fmt::format("task-x_recording-{}_physio.tsv", label), rows);
  }
};

TEST_F(GazeBidsRecordings, EyesOfOneUnitAreJoined) {
  const std::string left = eye("eye1", "left", "pixel", R"(, "PhysioType": "eyetrack")");
  eye("eye2", "right", "px", R"(, "SampleCoordinateSystem": "gaze-on-screen")");  // what is meant where nothing is said
  const GazeLog log = load_gaze_log(left, {});
  EXPECT_EQ(log.eyes.size(), 2U);
  EXPECT_EQ(log.eyes.front().right.at.x, 0.25);
}

TEST_F(GazeBidsRecordings, EyesOfOtherUnitsOrSpacesAreRefused) {
  const std::string left = eye("eye1", "left", "pixel", "");
  const std::string right = eye("eye2", "right", "deg", "");
  EXPECT_THAT(refusal_of(left), AllOf(HasSubstr("eye2_physio"), HasSubstr("'deg'"), HasSubstr("'pixel'")));
  EXPECT_THAT(refusal_of(right), AllOf(HasSubstr("eye1_physio"), HasSubstr("'deg'"), HasSubstr("'pixel'")));
  GazeReadOptions px;
  px.columns.position_unit = PositionUnit::px;
  EXPECT_EQ(refusal_of(left, px), "accepted");  // the user's word
  eye("eye2", "right", "rad", "");
  eye("eye1", "left", "deg", "");
  EXPECT_THAT(refusal_of(left), HasSubstr("'rad'"));
  eye("eye2", "right", "deg", R"(, "SampleCoordinateSystem": "eye-in-head")");
  EXPECT_THAT(refusal_of(left), AllOf(HasSubstr("eye2_physio"), HasSubstr("eye-in-head")));
  eye("eye2", "right", "", "");
  EXPECT_THAT(refusal_of(left), AllOf(HasSubstr("eye2_physio"), HasSubstr("Units")));
}

TEST_F(GazeBidsRecordings, OtherPhysiologyBesideGazeIsLeftAlone) {
  const std::string left = eye("eye1", "left", "pixel", "");
  put("task-x_recording-cardiac_physio.json", R"({"SamplingFrequency": 100, "StartTime": 0, "Columns": ["cardiac"]})");
  put("task-x_recording-cardiac_physio.tsv", "0.1\n0.2\n");
  put("task-x_recording-scanner_physio.json", R"({"PhysioType": "generic", "SamplingFrequency": 100})");
  put("task-x_recording-scanner_physio.tsv", "1\t2\n");
  const GazeLog log = load_gaze_log(left, {});
  EXPECT_EQ(log.samples.size(), 2U);
  EXPECT_TRUE(log.eyes.empty());
  EXPECT_THAT(log.warnings, IsEmpty());
  // Gaze of a type that is none is not dropped in silence.
  eye("eye2", "right", "pixel", R"(, "PhysioType": "generic")");
  const GazeLog warned = load_gaze_log(left, {});
  EXPECT_TRUE(warned.eyes.empty());
  ASSERT_EQ(warned.warnings.size(), 1U);
  EXPECT_THAT(warned.warnings[0], AllOf(HasSubstr("eye2_physio"), HasSubstr("PhysioType")));
}

TEST_F(GazeBidsRecordings, PupilsOfTwoUnitsAreSaid) {
  const std::string left = eye("eye1", "left", "pixel", R"(, "pupil_size": {"Units": "mm"})");
  eye("eye2", "right", "pixel", R"(, "pupil_size": {"Units": "arbitrary"})");
  EXPECT_THAT(load_gaze_log(left, {}).warnings, Contains(AllOf(HasSubstr("eye2_physio"), HasSubstr("pupil"),
                                                               HasSubstr("'mm'"), HasSubstr("'arbitrary'"))));
}

TEST_F(GazeBidsRecordings, GazeInTheHeadIsInAngles) {
  const std::string space = R"(, "SampleCoordinateSystem": "eye-in-head")";
  EXPECT_THAT(refusal_of(eye("eye1", "left", "pixel", space)),
              AllOf(HasSubstr("eye-in-head"), HasSubstr("in px"), HasSubstr("`unit` deg")));
  GazeReadOptions deg;
  deg.columns.position_unit = PositionUnit::deg;
  const std::string rows = "2\t10\t-5\t3\n4\t10\t-5\t3\n";
  EXPECT_EQ(load_gaze_log(eye("eye1", "left", "pixel", space, rows), deg).kind, GazeKind::direction);
  EXPECT_EQ(load_gaze_log(eye("eye1", "left", "deg", space, rows), {}).kind, GazeKind::direction);
  EXPECT_THAT(refusal_of(eye("eye1", "left", "m", space)), HasSubstr("eye-in-head"));
}

}  // namespace
}  // namespace gazetrace::gaze_bids_recordings_test
