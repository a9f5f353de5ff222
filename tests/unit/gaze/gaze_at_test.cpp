// SPDX-License-Identifier: Apache-2.0
// Which rows a moment gets: hold, nearest, linear, gaps, policies and clocks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "gazetrace/gaze.hpp"

namespace gazetrace::gaze_at_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

GazeSample sample(std::int64_t t_ns, double u, std::int64_t row, GazeValidity validity = GazeValidity::ok) {
  GazeSample s;
  s.t_ns = t_ns;
  s.u = u;
  s.v = 1 - u;
  s.row = row;
  s.validity = validity;
  return s;
}

// 0, 10, 20 ms good; 30, 40 blink; 50, 60 good; a hole; 400 good.
GazeLog with_gaps() {
  GazeLog log;
  log.source = "log.csv";
  log.samples = {sample(0, 0.0, 2),
                 sample(10 * kMs, 0.1, 3),
                 sample(20 * kMs, 0.2, 4),
                 sample(30 * kMs, 0.3, 5, GazeValidity::blink),
                 sample(40 * kMs, 0.4, 6, GazeValidity::lost),
                 sample(50 * kMs, 0.5, 7, GazeValidity::off_screen),
                 sample(60 * kMs, 0.6, 8),
                 sample(400 * kMs, 0.9, 9)};
  return log;
}

GazeMapping mapping(GazeInterpolation mode) {
  GazeMapping m;
  m.interpolation = mode;
  return m;
}

struct Case {
  std::int64_t t_ns;
  GazeState state;
  double u;
  std::int64_t row_before, row_after, age_ns;
  std::string reason;
};

void expect_table(const GazeLog& log, const GazeMapping& m, const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    const GazeAtTime gaze = gaze_at(log, m, c.t_ns);
    EXPECT_EQ(gaze.state, c.state) << c.t_ns;
    EXPECT_NEAR(gaze.u, c.u, 1e-12) << c.t_ns;
    EXPECT_NEAR(gaze.v, 1 - c.u, 1e-12) << c.t_ns;
    EXPECT_EQ(gaze.row_before, c.row_before) << c.t_ns;
    EXPECT_EQ(gaze.row_after, c.row_after) << c.t_ns;
    EXPECT_EQ(gaze.age_ns, c.age_ns) << c.t_ns;
    EXPECT_EQ(gaze.reason, c.reason);
    EXPECT_EQ(gaze.t_log_ns, c.t_ns);
  }
}

TEST(GazeAt, Hold) {
  expect_table(with_gaps(), mapping(GazeInterpolation::hold),
               {{0, GazeState::measured, 0.0, 2, 0, 0, "hold: row 2"},
                {10 * kMs - 1, GazeState::measured, 0.0, 2, 0, 10 * kMs - 1, "hold: row 2"},
                {10 * kMs, GazeState::measured, 0.1, 3, 0, 0, "hold: row 3"},
                {35 * kMs, GazeState::held, 0.2, 4, 0, 15 * kMs, "blink at row 5: held row 4"},
                {45 * kMs, GazeState::held, 0.2, 4, 0, 25 * kMs, "lost at row 6: held row 4"},
                {52 * kMs, GazeState::measured, 0.5, 7, 0, 2 * kMs, "hold: row 7"},
                {135 * kMs, GazeState::measured, 0.6, 8, 0, 75 * kMs, "hold: row 8"},
                {135 * kMs + 1, GazeState::held, 0.6, 8, 0, 75 * kMs + 1, "gap of 340 ms: held row 8"},
                {480 * kMs, GazeState::held, 0.9, 9, 0, 80 * kMs, "80.0 ms after the log's last row: held row 9"},
                {901 * kMs, GazeState::held, 0.9, 9, 0, 501 * kMs,
                 "no gaze (501 ms after the log's last row, last usable row 9 is 501 ms old (limit 500 ms)): held it"},
                {-7 * kMs, GazeState::center, 0.5, 0, 0, 0,
                 "no gaze (before the log's first row): nothing to hold yet, center"}});
}

// What is yet to come steers nothing: an effect that precedes its cause would spoil a study of latency.
TEST(GazeAt, NothingFromTheFutureBeforeTheLogBegins) {
  for (const GazeInterpolation how : {GazeInterpolation::hold, GazeInterpolation::nearest, GazeInterpolation::linear}) {
    const GazeAtTime gaze = gaze_at(with_gaps(), mapping(how), -6 * kMs);
    EXPECT_TRUE(gaze.no_gaze);
    EXPECT_EQ(gaze.state, GazeState::center);
  }
}

TEST(GazeAt, Nearest) {
  expect_table(with_gaps(), mapping(GazeInterpolation::nearest),
               {{4 * kMs, GazeState::measured, 0.0, 2, 0, 4 * kMs, "nearest: row 2"},
                {5 * kMs, GazeState::measured, 0.0, 2, 0, 5 * kMs, "nearest: row 2"},  // a tie goes to the earlier
                {5 * kMs + 1, GazeState::measured, 0.1, 0, 3, -5 * kMs + 1, "nearest: row 3"},
                {46 * kMs, GazeState::measured, 0.5, 0, 7, -4 * kMs, "nearest: row 7"},
                {44 * kMs, GazeState::held, 0.2, 4, 0, 24 * kMs, "lost at row 6: held row 4"},
                {27 * kMs, GazeState::measured, 0.2, 4, 0, 7 * kMs, "hold: row 4, no usable row next to it"},
                {-2 * kMs, GazeState::measured, 0.0, 0, 2, -2 * kMs, "nearest: row 2"},
                {350 * kMs, GazeState::measured, 0.9, 0, 9, -50 * kMs, "nearest: row 9"},
                {300 * kMs, GazeState::held, 0.6, 8, 0, 240 * kMs, "gap of 340 ms: held row 8"}});
}

TEST(GazeAt, LinearOnlyBetweenNeighboringUsableRows) {
  expect_table(with_gaps(), mapping(GazeInterpolation::linear),
               {{10 * kMs, GazeState::measured, 0.1, 3, 0, 0, "linear: row 3"},
                {12'500'000, GazeState::measured, 0.125, 3, 4, 2'500'000, "linear: rows 3 and 4"},
                {25 * kMs, GazeState::measured, 0.2, 4, 0, 5 * kMs, "hold: row 4, no usable row next to it"},
                {45 * kMs, GazeState::held, 0.2, 4, 0, 25 * kMs, "lost at row 6: held row 4"},
                {55 * kMs, GazeState::measured, 0.55, 7, 8, 5 * kMs, "linear: rows 7 and 8"},
                {100 * kMs, GazeState::measured, 0.6, 8, 0, 40 * kMs, "hold: row 8, no usable row next to it"},
                {200 * kMs, GazeState::held, 0.6, 8, 0, 140 * kMs, "gap of 340 ms: held row 8"}});
  GazeMapping wide = mapping(GazeInterpolation::linear);
  wide.max_interpolation_gap_ns = 340 * kMs;
  EXPECT_NEAR(gaze_at(with_gaps(), wide, 230 * kMs).u, 0.75, 1e-12);
  wide.max_interpolation_gap_ns -= 1;
  EXPECT_EQ(gaze_at(with_gaps(), wide, 230 * kMs).u, 0.6);
}

TEST(GazeAt, LinearDirectionsFollowTheGreatCircle) {
  GazeLog log;
  log.kind = GazeKind::direction;
  log.samples = {sample(0, 0, 2), sample(10, 0, 3)};
  log.samples[0].direction = {0, 0, -1};
  log.samples[1].direction = {std::sin(1.2), 0, -std::cos(1.2)};
  const GazeAtTime gaze = gaze_at(log, mapping(GazeInterpolation::linear), 3);
  EXPECT_EQ(gaze.kind, GazeKind::direction);
  EXPECT_NEAR(angle_between_rad(gaze.direction, {0, 0, -1}), 0.36, 1e-15);
  EXPECT_NEAR(gaze.direction.x, std::sin(0.36), 1e-15);
  EXPECT_NEAR(length(gaze.direction), 1, 1e-15);
}

TEST(GazeAt, Policies) {
  GazeLog log = with_gaps();
  GazeMapping m;
  m.max_age_ns = 12 * kMs;
  m.no_gaze = NoGazePolicy::center;
  GazeAtTime gaze = gaze_at(log, m, 45 * kMs);
  EXPECT_EQ(gaze.state, GazeState::center);
  EXPECT_EQ(gaze.u, 0.5);
  EXPECT_EQ(gaze.v, 0.5);
  EXPECT_EQ(gaze.row_before, 0);
  EXPECT_EQ(gaze.reason, "no gaze (lost at row 6, last usable row 4 is 25.0 ms old (limit 12.0 ms)): center");
  m.no_gaze = NoGazePolicy::uniform;
  gaze = gaze_at(log, m, 45 * kMs);
  EXPECT_EQ(gaze.state, GazeState::none);
  EXPECT_EQ(gaze.reason, "no gaze (lost at row 6, last usable row 4 is 25.0 ms old (limit 12.0 ms)): uniform");
  m.no_gaze = NoGazePolicy::hold;
  EXPECT_EQ(gaze_at(log, m, 45 * kMs).u, 0.2);
  m.no_gaze = NoGazePolicy::error;
  try {
    gaze_at(log, m, 45 * kMs);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_STREQ(
        error.what(),
        "log.csv: no gaze at log time 45000000 ns (lost at row 6, last usable row 4 is 25.0 ms old (limit 12.0 "
        "ms)); choose `gaze-missing` hold, center or uniform, or render other frames");
  }
  try {
    gaze_at(log, m, -45 * kMs);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "log.csv: no gaze at log time -45000000 ns (before the log's first row, first usable row 2 comes 45.0 ms "
        "later); choose `gaze-missing` hold, center or uniform, or render other frames");
  }
}

TEST(GazeAt, LogsWithoutAnyUsableRow) {
  GazeLog log;
  EXPECT_EQ(gaze_at(log, {}, 5).state, GazeState::none);
  log.samples = {sample(0, 0.5, 2, GazeValidity::lost)};
  const GazeAtTime gaze = gaze_at(log, {}, 5);
  EXPECT_EQ(gaze.state, GazeState::none);
  EXPECT_EQ(gaze.reason, "no gaze (the log has no usable row): uniform");
}

TEST(GazeAt, OneRowIsAGazeThatNeverMoves) {
  GazeLog log;
  log.samples = {sample(0, 0.25, 1)};
  GazeMapping m;
  m.max_age_ns = std::numeric_limits<std::int64_t>::max();
  const GazeAtTime gaze = gaze_at(log, m, 3'600'000 * kMs);
  EXPECT_EQ(gaze.state, GazeState::measured);
  EXPECT_EQ(gaze.u, 0.25);
}

// Every time gets the last usable row at or before it, as a plain walk finds it.
TEST(GazeAt, HoldEqualsALinearScan) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    GazeLog log;
    std::int64_t t = -200;
    for (int i = 0; i < 60; ++i) {
      t += 1 + static_cast<std::int64_t>(random() % 20);
      log.samples.push_back(
          sample(t, static_cast<double>(i), i + 2, random() % 4 == 0 ? GazeValidity::blink : GazeValidity::ok));
    }
    GazeMapping m;
    m.event_ns = 0;
    m.no_gaze = NoGazePolicy::uniform;
    m.max_age_ns = 30;
    for (std::int64_t at = -250; at < t + 60; ++at) {
      const GazeSample* expected = nullptr;
      for (const GazeSample& s : log.samples) {
        if (s.t_ns <= at && is_usable(s.validity)) {
          expected = &s;
        }
      }
      const GazeAtTime gaze = gaze_at(log, m, at);
      if (expected == nullptr || at - expected->t_ns > m.max_age_ns) {
        ASSERT_EQ(gaze.state, GazeState::none) << at;
      } else {
        ASSERT_EQ(gaze.row_before, expected->row) << at;
        ASSERT_EQ(gaze.age_ns, at - expected->t_ns);
        ASSERT_EQ(gaze.u, expected->u);
      }
    }
  }
}

TEST(GazeClock, OffsetAndEventAreExact) {
  GazeLog log;
  log.samples = {sample(1'700'000'000'000'000'001, 0, 2)};
  GazeMapping m;
  EXPECT_EQ(log_time_ns(log, m, 0), 1'700'000'000'000'000'001);
  m.offset_ns = -3;
  EXPECT_EQ(log_time_ns(log, m, 41'666'666), 1'700'000'000'041'666'670);
  m.event_ns = std::numeric_limits<std::int64_t>::max() - 3;
  EXPECT_EQ(log_time_ns(log, m, 0), std::numeric_limits<std::int64_t>::max());
  EXPECT_THROW(log_time_ns(log, m, 1), Error);
  m.event_ns = 0;
  m.offset_ns = std::numeric_limits<std::int64_t>::min();
  EXPECT_THROW(log_time_ns(log, m, 0), Error);
  EXPECT_EQ(log_time_ns(log, m, -1), std::numeric_limits<std::int64_t>::max());
}

TEST(GazeClock, ScaleIsExactInWideIntegers) {
  GazeLog log;
  log.samples = {sample(1000, 0, 2)};
  GazeMapping m;
  m.scale = 2.0;  // video runs through two seconds while the log runs through one
  EXPECT_EQ(log_time_ns(log, m, 10), 1005);
  EXPECT_EQ(log_time_ns(log, m, 11), 1006);  // 5.5 to the nearest, halves up
  EXPECT_EQ(log_time_ns(log, m, -11), 995);
  m.scale = 0.5;
  EXPECT_EQ(log_time_ns(log, m, 10), 1020);
  // 100 ppm over 100 days: 8.64e15 ns / 1.0001, against 80-bit arithmetic of the same double.
  m.scale = 1.0001;
  const std::int64_t t = 8'640'000'000'000'000;
  const long double expected = static_cast<long double>(t) / static_cast<long double>(1.0001);
  EXPECT_LE(std::abs(static_cast<long double>(log_time_ns(log, m, t) - 1000) - expected), 0.501L);
  // The inverse lands on the same nanosecond: scale * result is within half a scale of t.
  for (const std::int64_t ns : {1LL, 41'666'666LL, 123'456'789'012'345LL, -5'000'000'001LL}) {
    const long double back =
        (static_cast<long double>(log_time_ns(log, m, ns)) - 1000) * static_cast<long double>(m.scale);
    EXPECT_LE(std::abs(back - static_cast<long double>(ns)), 0.5002L) << ns;
  }
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    m.scale = bad;
    EXPECT_THROW(log_time_ns(log, m, 1), Error) << bad;
  }
  m.scale = 1e-300;
  EXPECT_THROW(log_time_ns(log, m, 1), Error);
  m.scale = 1e300;
  EXPECT_EQ(log_time_ns(log, m, t), 1000);
}

}  // namespace
}  // namespace gazetrace::gaze_at_test
