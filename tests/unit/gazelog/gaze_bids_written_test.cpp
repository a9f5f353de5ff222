// SPDX-License-Identifier: Apache-2.0
// What is hard to write as BIDS or gazetrace CSV comes back all the same: the ends of what is counted, numbers that no
// metres give, texts with line ends, and what the standard has no names for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "gazetrace/gaze_synth.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/gaze_format_files.hpp"

namespace gazetrace::gaze_bids_written_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GazeBidsWritten : public GazeFormats {};

GazeLog log_with_event(std::int64_t begin_ns, std::int64_t end_ns) {
  GazeLog log = synthesize_gaze({}).log;
  log.events = {{GazeEventType::fixation, Eye::cyclopean, begin_ns, end_ns, "", 0}};
  return log;
}

TEST_F(GazeBidsWritten, LongEventsKeepTheirEnds) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  for (const auto& [begin_ns, end_ns] : std::initializer_list<std::pair<std::int64_t, std::int64_t>>{
           {0, 1}, {0, 2'000'000'000'000'001}, {-5, 1'700'000'000'123'456'789}, {0, kMost}, {7, 7}, {kLeast, kMost}}) {
    const GazeLog log = log_with_event(begin_ns, end_ns);
    write_gaze_bids(log, files_.path("sub-1_physio.tsv.gz"));
    const GazeLog back = load_gaze_log(files_.path("sub-1_recording-cyclopean_physio.tsv.gz"), {});
    ASSERT_EQ(back.events.size(), 1U);
    EXPECT_EQ(back.events[0].begin_ns, begin_ns);
    // The longest that can be counted: others have to subtract them.
    EXPECT_EQ(back.events[0].end_ns, begin_ns == kLeast ? -1 : end_ns);
  }
}

TEST_F(GazeBidsWritten, EventsLongerThanCanBeCountedAreRefused) {
  const auto text = [](const std::string& times) {
    return "# gazetrace-gaze 1\n# event segment left " + times + "\nt[ns],u[1],v[1]\n1,0.5,0.5\n2,0.5,0.5\n";
  };
  EXPECT_THAT(refusal("log.csv", text("-9223372036854775808 9223372036854775807")),
              AllOf(HasSubstr("log.csv:2"), HasSubstr("event")));
  EXPECT_EQ(refusal("log.csv", text("-5 1700000000123456789")), "accepted");
}

TEST_F(GazeBidsWritten, WhatBidsHasNoNamesForComesBack) {
  GazeLog log = synthesize_gaze({}).log;
  log.sample_age_unknown = true;
  log.calibrations = {{1'700'000'000'123'456'789, Eye::right, 0.1, 1.0 / 3.0, 0},
                      {-7, Eye::left, std::numeric_limits<double>::quiet_NaN(), 0.7, 0}};
  write_gaze_bids(log, files_.path("sub-1_physio.tsv.gz"));
  const GazeLog back = load_gaze_log(files_.path("sub-1_recording-cyclopean_physio.tsv.gz"), {});
  EXPECT_TRUE(back.sample_age_unknown);
  ASSERT_EQ(back.calibrations.size(), 2U);
  EXPECT_EQ(back.calibrations[0].t_ns, 1'700'000'000'123'456'789);
  EXPECT_EQ(back.calibrations[0].eye, Eye::right);
  EXPECT_EQ(back.calibrations[0].mean_error_deg, 0.1);
  EXPECT_EQ(back.calibrations[0].max_error_deg, 1.0 / 3.0);
  EXPECT_EQ(back.calibrations[1].t_ns, -7);
  EXPECT_EQ(back.calibrations[1].eye, Eye::left);
  EXPECT_TRUE(std::isnan(back.calibrations[1].mean_error_deg));
  EXPECT_EQ(back.calibrations[1].max_error_deg, 0.7);
  // And a log without them stays one.
  write_gaze_bids(synthesize_gaze({}).log, files_.path("sub-2_physio.tsv.gz"));
  const GazeLog plain = load_gaze_log(files_.path("sub-2_recording-cyclopean_physio.tsv.gz"), {});
  EXPECT_FALSE(plain.sample_age_unknown);
  EXPECT_THAT(plain.calibrations, IsEmpty());
}

TEST_F(GazeBidsWritten, EveryBitOfTheGeometryComesBack) {
  GazeLog log = synthesize_gaze({}).log;
  // Of many numbers of centimetres between 100 and 128 no number of metres gives them back.
  double cm = 110.0;
  for (int i = 0; i < 20; ++i) {
    log.recording_geometry->width_cm = cm = std::nextafter(cm, 128.0);
    log.recording_geometry->height_cm = cm = std::nextafter(cm, 128.0);
    log.recording_geometry->distance_cm = cm = std::nextafter(cm, 128.0);
    log.recording_geometry->eye_x_cm = -(cm = std::nextafter(cm, 128.0));
    log.recording_geometry->eye_y_cm = cm = std::nextafter(cm, 128.0);
    write_gaze_bids(log, files_.path("sub-1_physio.tsv.gz"));
    const GazeLog back = load_gaze_log(files_.path("sub-1_recording-cyclopean_physio.tsv.gz"), {});
    EXPECT_EQ(back.recording_geometry->width_cm, log.recording_geometry->width_cm);
    EXPECT_EQ(back.recording_geometry->height_cm, log.recording_geometry->height_cm);
    EXPECT_EQ(back.recording_geometry->distance_cm, log.recording_geometry->distance_cm);
    EXPECT_EQ(back.recording_geometry->eye_x_cm, log.recording_geometry->eye_x_cm);
    EXPECT_EQ(back.recording_geometry->eye_y_cm, log.recording_geometry->eye_y_cm);
  }
}

TEST_F(GazeBidsWritten, LineEndsInTextsDoNotBreakTheCsv) {
  GazeLog log = synthesize_gaze({}).log;
  log.clock = "system clock\nsecond line\r# display_px 1 1";
  log.pupil_unit = "a,b\nc";
  log.samples.front().pupil = 3;
  write_gaze_csv(log, files_.path("log.csv"));
  const GazeLog back = load_gaze_log(files_.path("log.csv"), {});
  EXPECT_EQ(back.clock, "system clock second line # display_px 1 1");
  EXPECT_EQ(back.pupil_unit, "a b c");
  EXPECT_EQ(back.samples.size(), log.samples.size());
  EXPECT_EQ(back.samples.front().pupil, 3);
}

}  // namespace
}  // namespace gazetrace::gaze_bids_written_test
