// SPDX-License-Identifier: Apache-2.0
// The steps between a file and a log: the numbers as they stand there, what is concluded of them, and the log of both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

#include "gazetrace/gaze_inspect.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_raw.hpp"
#include "support/gaze_format_files.hpp"
#include "support/gaze_log_text.hpp"

namespace gazetrace::gaze_interpret_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GazeInterpret : public GazeFormats {
 protected:
  RawGaze read_raw(const std::string& text) { return read_raw_gaze(files_.write("log.csv", text), options_); }

  GazeReadOptions options_;
};

constexpr const char* kPixels = "time[ms],x[px],y[px]\n0,480,270\n16,960,540\n33,0,0\n50,1440,810\n";

TEST_F(GazeInterpret, RawNumbersAreThoseOfTheFile) {
  const RawGaze raw = read_raw(kPixels);
  ASSERT_EQ(raw.rows.size(), 4U);
  EXPECT_EQ(raw.rows[0].at.x, 480);
  EXPECT_EQ(raw.rows[0].at.y, 270);
  EXPECT_EQ(raw.rows[3].t_ns, 50'000'000);
  EXPECT_EQ(raw.declared.unit.value, PositionUnit::px);
  EXPECT_EQ(raw.declared.unit.evidence, Evidence::header);
  EXPECT_EQ(raw.declared.time_exponent.value, 6);
}

TEST_F(GazeInterpret, LoadingIsTheThreeStepsInTurn) {
  options_.display = DisplayGeometry{.width_px = 1920, .height_px = 1080};
  const RawGaze raw = read_raw(kPixels);
  const GazeLog steps = interpret(raw, conclude_conventions(raw, options_));
  const GazeLog loaded = load_gaze_log(files_.path("log.csv"), options_);
  EXPECT_EQ(everything_of(steps), everything_of(loaded));
  EXPECT_EQ(steps.samples[0].u, 0.25);
  EXPECT_EQ(steps.samples[3].v, 0.75);
  // Both eyes, events, a display, and warnings.
  options_.columns.origin = PositionOrigin::bottom_left;
  const std::string both = asc("SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t1000.00",
                               "100\t 480.0\t 270.0\t 900.0\t 500.0\t 280.0\t 800.0\t.....\n"
                               "101\t 481.0\t 270.0\t 900.0\t .\t .\t 0.0\t...CR\n"
                               "EBLINK R 101\t101\t1\n");
  const RawGaze raw_both = read_raw_gaze(files_.write("both.asc", both), options_);
  const std::string text = everything_of(interpret(raw_both, conclude_conventions(raw_both, options_)));
  EXPECT_EQ(text, everything_of(load_gaze_log(files_.path("both.asc"), options_)));
  EXPECT_THAT(text, HasSubstr("`origin` bottom-left was given and is used"));
  EXPECT_THAT(text, HasSubstr("'diameter'"));
}

TEST_F(GazeInterpret, AUnitThatIsLeftOpenIsRefused) {
  const RawGaze raw = read_raw("time[ms],x,y\n0,4,2\n16,9,5\n");
  try {
    interpret(raw, raw.declared);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("the unit of the positions is not settled"));
  }
}

// A pipe can be read once only, also where what was read turns out to be of no use.
TEST_F(GazeInterpret, APipeIsOpenedOnce) {
  const std::string pipe = files_.path("pipe.csv");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe) << kPixels; });
  options_.format = "generic";
  EXPECT_THAT(refusal_of(pipe, options_), HasSubstr("the size in pixels of the display of the recording is not known"));
  writer.join();
}

TEST_F(GazeInterpret, TheSameNumbersUnderOtherConventions) {
  options_.display = DisplayGeometry{.width_px = 1920, .height_px = 1080};
  const RawGaze raw = read_raw(kPixels);
  Conventions conventions = conclude_conventions(raw, options_);
  EXPECT_EQ(interpret(raw, conventions).samples[2].validity, GazeValidity::ok);
  conventions.zero_is_missing = true;
  EXPECT_EQ(interpret(raw, conventions).samples[2].validity, GazeValidity::lost);
  conventions.zero_is_missing = false;
  conventions.origin.value = PositionOrigin::bottom_left;
  EXPECT_EQ(interpret(raw, conventions).samples[0].v, 0.75);
  conventions.flip_x = true;
  EXPECT_EQ(interpret(raw, conventions).samples[0].u, 0.75);
}

// Ten degrees are (0, sin 10, -cos 10): up in a table, whatever its columns count from, and down where the user says of
// a log of another kind that it counts from the top left.
TEST_F(GazeInterpret, WhichWayDegreesGrow) {
  options_.frame = GazeFrame::head;
  options_.columns.origin = PositionOrigin::top_left;
  const double sine = std::sin(10 * kRadPerDeg);
  const std::string table = files_.write("table.csv", "time[ms],x[deg],y[deg]\n0,0,10\n16,0,0\n33,0,10\n");
  EXPECT_NEAR(load_gaze_log(table, options_).samples[0].direction.y, sine, 1e-15);
  options_.columns.position_unit = PositionUnit::deg;
  const std::string eyelink = asc("SAMPLES\tGAZE\tLEFT\tRATE\t1000.00", "100\t 0\t 10\t 900.0\t...\n");
  const GazeLog log = load_gaze_log(files_.write("a.asc", eyelink), options_);
  EXPECT_NEAR(log.samples[0].direction.y, -sine, 1e-15);
}

TEST_F(GazeInterpret, EvidenceSaysWhoSaidIt) {
  const RawGaze raw = read_raw("time[ms],x,y\n0,480,270\n16,960,540\n33,100,1000\n");
  options_.guess_display = true;
  const Conventions guessed = conclude_conventions(raw, options_);
  EXPECT_EQ(guessed.unit.value, PositionUnit::px);
  EXPECT_EQ(guessed.unit.evidence, Evidence::statistics);
  ASSERT_TRUE(guessed.display);
  EXPECT_EQ(guessed.display->evidence, Evidence::statistics);
  EXPECT_THAT(guessed.unit.detail, HasSubstr("90 % of x lie in"));
  options_.columns.position_unit = PositionUnit::px;
  options_.columns.origin = PositionOrigin::center;
  const Conventions given = conclude_conventions(read_raw("time[ms],x[mm],y[mm]\n0,4,2\n16,9,5\n33,1,1\n"), options_);
  EXPECT_EQ(given.unit.value, PositionUnit::px);
  EXPECT_EQ(given.unit.evidence, Evidence::option);
  EXPECT_EQ(given.origin.evidence, Evidence::option);
}

TEST_F(GazeInterpret, TimesOfDayAreTakenOff) {
  GazeLog log;
  log.clock = "computer, 2022/09/19 13:34:49.156";
  log.warnings = {"started 13:34:49"};
  log.conventions.warnings = {"guessed on 19.09.2022"};
  log.order.first_backward_row = 7;
  log.order.first_backward_ns = 1'700'000'000'000'000'000;
  log.order.before_ns = 1'700'000'000'016'000'000;
  for (const std::int64_t t_ns : {1'700'000'000'000'000'000, 1'700'000'000'016'000'000}) {
    log.samples.emplace_back().t_ns = t_ns;
  }
  const LogWithoutTimesOfDay hidden = without_times_of_day(log);
  EXPECT_EQ(hidden.taken_off_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(hidden.log.samples[0].t_ns, 0);
  EXPECT_EQ(hidden.log.samples[1].t_ns, 16'000'000);
  EXPECT_EQ(hidden.log.clock, "computer, (date)");
  EXPECT_EQ(hidden.log.warnings[0], "started (date)");
  EXPECT_EQ(hidden.log.conventions.warnings[0], "guessed on (date)");
  EXPECT_EQ(hidden.log.order.first_backward_ns, 0);
  EXPECT_EQ(hidden.log.order.before_ns, 16'000'000);
  EXPECT_EQ(hidden.log.order.first_duplicate_ns, 0);  // there is none
  log.order.first_duplicate_row = 9;
  log.order.first_duplicate_ns = 1'700'000'000'016'000'000;
  EXPECT_EQ(without_times_of_day(log).log.order.first_duplicate_ns, 16'000'000);
  // What is reported of the log shows them only where times of day may be seen.
  const GazeInspection shown = inspect_gaze(log, {.display = {}, .keep_ids = true});
  EXPECT_EQ(shown.order.before_ns, 1'700'000'000'016'000'000);
  const GazeOrder reported = inspect_gaze(log, {}).order;
  EXPECT_EQ(reported.first_backward_ns, 0);
  EXPECT_EQ(reported.before_ns, 0);
  EXPECT_EQ(reported.first_duplicate_ns, 0);
  EXPECT_EQ(reported.first_backward_row, 7);
  // A copy keeps its stamps, but says no dates.
  GazeLog copy = log;
  leave_out_identities(copy);
  EXPECT_EQ(copy.clock, "computer, (date)");
  EXPECT_EQ(copy.warnings[0], "started (date)");
  EXPECT_EQ(copy.conventions.warnings[0], "guessed on (date)");
  log.samples.front().t_ns = 5;
  EXPECT_FALSE(without_times_of_day(log).taken_off_ns);
}

// More rows than make a block of packed rows, with all that files hold: decimals, doubles with all their digits, marks,
// minus zero, stamps from end to end of int64, lines that jump.
std::vector<RawSample> rows_of_every_kind(std::size_t count) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<RawSample> rows;
  std::uint64_t random = 1;
  for (std::size_t i = 0; i < count; ++i) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    RawSample row;
    row.t_ns = i == 9000   ? std::numeric_limits<std::int64_t>::min()
               : i == 9001 ? std::numeric_limits<std::int64_t>::max()
                           : static_cast<std::int64_t>(i) * 333'333;
    row.at = {static_cast<double>(random >> 44U) / 1e6, i < 8192 ? 540.25 : std::sqrt(static_cast<double>(i)), 0};
    row.at.x = i % 50 == 7 ? kNan : i == 5000 ? -0.0 : i == 13000 ? 1e300 : row.at.x;
    row.at.z = i < 16000 ? 0 : -1 / (1 + static_cast<double>(i));
    row.validity = i > 4096 && i % 7 == 0 ? GazeValidity::lost : GazeValidity::ok;
    row.eye = static_cast<Eye>(i % 3);
    row.confidence = i < 6000 ? std::numeric_limits<float>::quiet_NaN() : 0.25F * static_cast<float>(i % 5);
    row.pupil = static_cast<float>(i) * 0.3F;
    row.row = static_cast<std::int64_t>(i) * (i > 12000 ? 70'000 : 1);
    rows.push_back(row);
  }
  return rows;
}

bool same_bits(const RawSample& a, const RawSample& b) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  const auto bits_of_float = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return a.t_ns == b.t_ns && bits(a.at.x) == bits(b.at.x) && bits(a.at.y) == bits(b.at.y) &&
         bits(a.at.z) == bits(b.at.z) && a.validity == b.validity && a.eye == b.eye &&
         bits_of_float(a.confidence) == bits_of_float(b.confidence) &&
         bits_of_float(a.pupil) == bits_of_float(b.pupil) && a.row == b.row;
}

TEST(RawRows, GiveBackWhatWasPutIn) {
  std::vector<RawSample> rows = rows_of_every_kind(20'000);
  RawRows packed;
  for (const RawSample& row : rows) {
    packed.push_back(row);
  }
  for (const std::size_t i : {std::size_t{3}, std::size_t{4100}, std::size_t{19'999}}) {
    rows[i].validity = GazeValidity::blink;
    packed.set_validity(i, GazeValidity::blink);
  }
  ASSERT_EQ(packed.size(), rows.size());
  std::size_t i = 0;
  for (const RawSample row : packed) {
    ASSERT_TRUE(same_bits(row, rows[i])) << i;
    ASSERT_EQ(packed.t_ns(i), rows[i].t_ns);
    ASSERT_EQ(packed.eye(i), rows[i].eye);
    ++i;
  }
  RawRows twice = packed;
  twice.append(packed);
  twice.sort_by_time();
  ASSERT_EQ(twice.size(), 2 * rows.size());
  EXPECT_EQ(twice.t_ns(1), std::numeric_limits<std::int64_t>::min());
  EXPECT_TRUE(same_bits(twice[2], rows[0]));
  twice.keep_if([](const RawSample& row) { return row.eye == Eye::right; });
  EXPECT_EQ(twice.size(), 2 * (rows.size() / 3 + 1));
}

// What an hour of three rows a time needs: 10.8 million rows of this kind in less than 256 MiB.
TEST(RawRows, TakeLittleMemory) {
  RawRows packed;
  constexpr std::size_t kRows = 100'000;
  for (std::size_t i = 0; i < kRows; ++i) {
    RawSample row;
    row.t_ns = 5'000'000'000'000 + static_cast<std::int64_t>(i / 3) * 1'000'000;
    row.at = {static_cast<double>(i * 7919 % 1'000'000) / 1e6, static_cast<double>(i * 104'729 % 1'000'000) / 1e6, 0};
    row.eye = static_cast<Eye>(i % 3);
    row.confidence = std::numeric_limits<float>::quiet_NaN();
    row.pupil = 1094 + static_cast<float>(i % 40);
    row.row = static_cast<std::int64_t>(i) + 6;
    packed.push_back(row);
  }
  constexpr double kHour = 10.8e6;
  EXPECT_LT(static_cast<double>(packed.packed_bytes()) / kRows * kHour, 256.0 * 1024 * 1024);
}

}  // namespace
}  // namespace gazetrace::gaze_interpret_test
