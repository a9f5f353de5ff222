// SPDX-License-Identifier: Apache-2.0
// The log doctor on logs whose truth is known: noise of a stated size, eyes a stated angle apart, heads that turn while
// the eyes stay on a point of the world.
#include "gazetrace/gaze_inspect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "gazelog/log_file.hpp"

namespace gazetrace::gaze_inspect_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kMs = 1'000'000;

Vec3d direction(double azimuth_deg, double elevation_deg) {
  const double az = azimuth_deg * kRadPerDeg;
  const double el = elevation_deg * kRadPerDeg;
  return {std::sin(az) * std::cos(el), std::sin(el), -std::cos(az) * std::cos(el)};
}

GazeSample looking(std::int64_t t_ns, const Vec3d& at) {
  GazeSample sample;
  sample.t_ns = t_ns;
  sample.direction = at;
  return sample;
}

// Fixations of 300 ms, 10 degrees apart, at 500 Hz, with independent noise of `noise_deg` in each axis.
GazeLog fixations(double noise_deg, int count) {
  GazeLog log;
  log.kind = GazeKind::direction;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, noise_deg);
  for (int i = 0; i < count * 150; ++i) {
    const double at = (i / 150) % 2 == 0 ? -5 : 5;
    log.samples.push_back(looking(i * 2 * kMs, direction(at + noise(random), noise(random))));
  }
  log.order.rows = log.samples.size();
  return log;
}

TEST(GazeInspect, PrecisionIsThatOfTheNoise) {
  const double noise_deg = 0.05;
  const GazeInspection report = inspect_gaze(fixations(noise_deg, 40), {});
  ASSERT_TRUE(report.precision.has_value());
  EXPECT_EQ(report.unit, "deg");
  EXPECT_NEAR(static_cast<double>(report.precision->fixations), 40, 1);
  // Steps between independent samples have twice the variance, summed over both axes: 2 sigma. About 140 samples a
  // fixation and a median over 40: a relative standard error of about 1 %; four of them.
  EXPECT_NEAR(report.precision->rms_s2s, 2 * noise_deg, 0.04 * 2 * noise_deg);
  EXPECT_NEAR(report.precision->sd, std::sqrt(2.0) * noise_deg, 0.04 * std::sqrt(2.0) * noise_deg);
}

TEST(GazeInspect, DisparityIsLeftMinusRight) {
  GazeLog log = fixations(0.05, 4);
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const double at = 0.01 * static_cast<double>(i);
    BothEyes eyes;
    eyes.left = {direction(at + 1.5, 0.8), 1, 3, GazeValidity::ok};
    eyes.right = {direction(at, 0), 1, 3, GazeValidity::ok};
    log.eyes.push_back(eyes);
  }
  const GazeInspection report = inspect_gaze(log, {});
  ASSERT_TRUE(report.disparity.has_value());
  EXPECT_NEAR(report.disparity->horizontal, 1.5, 1e-9);
  EXPECT_NEAR(report.disparity->vertical, 0.8, 1e-9);
  EXPECT_NEAR(report.disparity->vertical_spread, 0, 1e-9);
  EXPECT_NEAR(report.disparity->horizontal_correlation, 1, 1e-9);
}

TEST(GazeInspect, LossesAndFrozenRuns) {
  GazeLog log = fixations(0.05, 4);
  const auto lose = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      log.samples[i].validity = GazeValidity::lost;
    }
  };
  lose(20, 30);    // 20 ms: too short for a blink
  lose(100, 160);  // 120 ms
  lose(200, 300);  // 200 ms
  for (std::size_t i = 400; i < 500; ++i) {
    log.samples[i].direction = log.samples[400].direction;  // 198 ms between first and last
  }
  const GazeInspection report = inspect_gaze(log, {});
  EXPECT_EQ(report.loss.usable, log.samples.size() - 170);
  EXPECT_EQ(report.loss.blink_like, 2U);
  EXPECT_EQ(report.loss.longer, 0U);
  EXPECT_EQ(report.loss.longest_ns, 200 * kMs);
  EXPECT_EQ(report.frozen.runs, 1U);
  EXPECT_EQ(report.frozen.samples, 100U);
  EXPECT_EQ(report.frozen.longest_ns, 198 * kMs);
}

// The head turns to and fro about one axis while the eyes stay on points of the world, with noise; every two seconds
// the eyes go to another point.
GazeLog turning_head(char axis, double amplitude_deg) {
  GazeLog log;
  log.kind = GazeKind::direction;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (int i = 0; i < 1200; ++i) {
    const std::int64_t t_ns = i * 8 * kMs;
    const double turn_deg = amplitude_deg * std::sin(2 * kPi * 0.5 * static_cast<double>(t_ns) * 1e-9);
    const double half = 0.5 * turn_deg * kRadPerDeg;
    const Quatd head = axis == 'x' ? Quatd{0, std::sin(half), 0, std::cos(half)}   // yaw moves gaze along x
                                   : Quatd{std::sin(half), 0, 0, std::cos(half)};  // pitch along y
    const double aim = 4.0 * ((i / 250) % 3 - 1);
    const Vec3d in_world = direction(aim + noise(random), 0.5 * aim + noise(random));
    log.samples.push_back(looking(t_ns, rotate(Quatd{-head.x, -head.y, -head.z, head.w}, in_world)));
    log.head.push_back({t_ns, {}, head});
  }
  log.order.rows = log.samples.size();
  return log;
}

AxisVerdict verdict_of(const GazeInspection& report, char axis) {
  for (const GazeAxisTest& test : report.axes) {
    if (test.axis == axis) {
      return test.verdict;
    }
  }
  return AxisVerdict::undecided;
}

TEST(GazeInspect, VestibuloOcularReflexTellsTheSignOfAnAxis) {
  for (const char axis : {'x', 'y'}) {
    const char other = axis == 'x' ? 'y' : 'x';
    GazeLog log = turning_head(axis, 15);
    GazeInspection report = inspect_gaze(log, {});
    EXPECT_EQ(verdict_of(report, axis), AxisVerdict::confirmed) << axis;
    EXPECT_EQ(verdict_of(report, other), AxisVerdict::undecided) << axis << ": the head does not turn about the other";
    EXPECT_TRUE(report.settings.empty());

    for (GazeSample& sample : log.samples) {
      (axis == 'x' ? sample.direction.x : sample.direction.y) *= -1;
    }
    report = inspect_gaze(log, {});
    EXPECT_EQ(verdict_of(report, axis), AxisVerdict::flipped) << axis;
    EXPECT_THAT(report.settings, ::testing::ElementsAre(std::string("`flip-") + axis + "`"));
    EXPECT_EQ(report.findings.front().kind, FindingKind::suspicion);
  }
}

TEST(GazeInspect, WithoutHeadMovementTheReflexDecidesNothing) {
  GazeLog log = turning_head('x', 0.2);
  EXPECT_EQ(verdict_of(inspect_gaze(log, {}), 'x'), AxisVerdict::undecided);
  // Eyes that stand still in the turning head say nothing either: both signs are equally unsteady.
  log = turning_head('x', 15);
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (GazeSample& sample : log.samples) {
    sample.direction = direction(noise(random), noise(random));
  }
  EXPECT_EQ(verdict_of(inspect_gaze(log, {}), 'x'), AxisVerdict::undecided);
}

TEST(GazeInspect, TimesOfDayAreLeftOutUnlessKept) {
  GazeLog log = fixations(0.05, 2);
  log.clock = "host, 2022/09/19 13:34:49.156";
  log.facts.push_back({"time column", "TIME(2022/09/19 13:34:49.156)", Evidence::header, "13:34:49"});
  EXPECT_FALSE(is_wall_clock(log));
  for (GazeSample& sample : log.samples) {
    sample.t_ns += 1'698'682'600'011'534'600;
  }
  EXPECT_TRUE(is_wall_clock(log));
  const GazeInspection hidden = inspect_gaze(log, {});
  for (const std::string& text : {inspection_text(hidden), inspection_json(hidden)}) {
    EXPECT_THAT(text, Not(HasSubstr("16986826")));
    EXPECT_THAT(text, Not(HasSubstr("2022")));
    EXPECT_THAT(text, Not(HasSubstr("13:34")));
  }
  GazeInspectOptions keep;
  keep.keep_ids = true;
  EXPECT_THAT(inspection_text(inspect_gaze(log, keep)), HasSubstr("1698682600011534600"));

  EXPECT_EQ(count_from_first_sample(log), 1'698'682'600'011'534'600);
  EXPECT_EQ(log.samples.front().t_ns, 0);
  EXPECT_EQ(log.samples[1].t_ns, 2 * kMs);
}

TEST(GazeInspect, ColumnsOfOneNameAreNotTakenByChance) {
  const auto path = std::filesystem::temp_directory_path() / "gazetrace_two_columns.csv";
  std::ofstream(path) << "t[ms],x[px],y[px],x[px]\n0,1,2,3\n4,1,2,3\n";
  GazeReadOptions options;
  options.display = DisplayGeometry{.width_px = 100, .height_px = 100};
  try {
    load_gaze_log(path.string(), options);
    ADD_FAILURE() << "took one of two columns silently";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(":1: columns 2 ('x[px]') and 4 ('x[px]') have one name"));
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
  options.columns.x = "4";
  EXPECT_EQ(load_gaze_log(path.string(), options).samples[0].u, 0.03);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace gazetrace::gaze_inspect_test
