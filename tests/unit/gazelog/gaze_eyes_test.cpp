// SPDX-License-Identifier: Apache-2.0
// One gaze out of two eyes: which, and what happens while one of them is lost.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_write.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_eyes_test {
namespace {

using ::testing::HasSubstr;

class GazeEyes : public ::testing::Test {
 protected:
  GazeLog read(const std::string& text, EyeChoice eye) {
    GazeReadOptions options;
    options.eye = eye;
    return load_gaze_log(files_.write("log.csv", text), options);
  }
  TextFiles files_;
};

constexpr const char* kPreamble =
    "# gazetrace-gaze 1\n# display_px 1000 1000\n# display_mm 500 500\n# distance_mm 500\n";

// The right eye is lost from row 20 on; the left one lies 0.02 to its right all the time.
std::string log_with_dropout() {
  std::string text = std::string(kPreamble) + "t[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 40; ++i) {
    text += fmt::format("{},0.51,0.5,ok,left\n", i * 10'000'000LL);
    text += i < 20 ? fmt::format("{},0.49,0.5,ok,right\n", i * 10'000'000LL)
                   : fmt::format("{},,,lost,right\n", i * 10'000'000LL);
  }
  return text;
}

TEST_F(GazeEyes, ALostEyeMakesNoJump) {
  const GazeLog mean = read(log_with_dropout(), EyeChoice::mean);
  ASSERT_EQ(mean.samples.size(), 40U);
  for (const GazeSample& s : mean.samples) {
    EXPECT_NEAR(s.u, 0.5, 1e-12) << s.row;
    EXPECT_EQ(s.validity, GazeValidity::ok);
  }
  const GazeLog right = read(log_with_dropout(), EyeChoice::right);
  EXPECT_EQ(right.samples[39].validity, GazeValidity::lost);  // that eye alone
  ASSERT_EQ(right.eyes.size(), 40U);
  EXPECT_EQ(right.eyes[39].left.at.x, 0.51);
}

TEST_F(GazeEyes, BeforeTheSecondEyeIsFoundItsOffsetIsKnownFromLater) {
  std::string text = "t[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 20; ++i) {
    text +=
        fmt::format("{0},0.6,0.5,ok,left\n{0},{1}\n", i * 10'000'000LL, i < 10 ? ",,lost,right" : "0.4,0.5,ok,right");
  }
  EXPECT_NEAR(read(text, EyeChoice::mean).samples[0].u, 0.5, 1e-12);
}

// Eyes that differ more and more: over a short absence the difference is taken from both ends, not from what was.
TEST_F(GazeEyes, AShortAbsenceJumpsAtNeitherEnd) {
  std::string text = "t[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 40; ++i) {
    const bool lost = i >= 20 && i < 25;  // 60 ms between the pairs
    text += fmt::format("{},{},0.5,ok,left\n", i * 10'000'000LL, 0.5 + 0.001 * i);
    text += lost ? fmt::format("{},,,lost,right\n", i * 10'000'000LL)
                 : fmt::format("{},{},0.5,ok,right\n", i * 10'000'000LL, 0.5 - 0.001 * i);
  }
  for (const GazeSample& s : read(text, EyeChoice::mean).samples) {
    EXPECT_NEAR(s.u, 0.5, 1e-12) << s.row;
  }
}

TEST_F(GazeEyes, TheMeanIsOneOfAnglesNotOfPlaces) {
  // At 50 cm from a screen of 50 cm: the right edge is at 26.565 deg, its middle at 0. Half of the angle is not half
  // way.
  const GazeLog log = read(std::string(kPreamble) + "t[ns],u[1],v[1],valid,eye\n0,1,0.5,ok,left\n0,0.5,0.5,ok,right\n",
                           EyeChoice::mean);
  const double half_deg = 0.5 * std::atan(0.5) * 180 / M_PI;
  EXPECT_NEAR(log.samples[0].u, 0.5 + std::tan(half_deg * M_PI / 180), 1e-12);
  EXPECT_GT(std::abs(log.samples[0].u - 0.75), 0.01);
}

TEST_F(GazeEyes, EyesThatDifferVerticallyAreNotMeantWithoutBeingTold) {
  std::string text = std::string(kPreamble) + "t[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 10; ++i) {
    text += fmt::format("{0},0.5,0.5,ok,left\n{0},0.5,0.51,ok,right\n", i * 10'000'000LL);  // 0.57 deg
  }
  const GazeLog log = read(text, EyeChoice::automatic);
  EXPECT_THAT(log.warnings.at(0), HasSubstr("the eyes differ vertically by 0.57 deg in the median"));
  EXPECT_EQ(log.samples[0].v, 0.5);
  EXPECT_NEAR(read(text, EyeChoice::mean).samples[0].v, 0.505, 1e-6);
}

// Of eyes that differ vertically the one with more usable samples is taken; where it is lost, the other one, moved.
TEST_F(GazeEyes, TheOtherEyeStandsInForTheBetterOne) {
  std::string text = std::string(kPreamble) + "t[ns],u[1],v[1],valid,eye\n";
  for (int i = 0; i < 40; ++i) {
    text += fmt::format("{},{},left\n", i * 10'000'000LL, i < 20 ? "0.51,0.5,ok" : ",,lost");
    text += fmt::format("{},{},right\n", i * 10'000'000LL, i == 12 ? ",,lost" : "0.49,0.52,ok");
  }
  const GazeLog log = read(text, EyeChoice::automatic);
  EXPECT_EQ(log.samples[0].u, 0.49);
  EXPECT_EQ(log.samples[12].eye, Eye::right);
  EXPECT_NEAR(log.samples[12].u, 0.49, 1e-6);  // not 0.51, where the left eye is
  EXPECT_NEAR(log.samples[12].v, 0.52, 1e-6);
  EXPECT_EQ(log.samples[12].validity, GazeValidity::ok);
}

TEST_F(GazeEyes, TheLogsOwnGazeIsTakenUnlessAnotherIsAskedFor) {
  const std::string text =
      "t[ns],u[1],v[1],valid,eye\n0,0.7,0.5,ok,both\n0,0.2,0.5,ok,left\n0,0.4,0.5,ok,right\n1,,,lost,both\n"
      "1,0.2,0.5,ok,left\n1,0.4,0.5,ok,right\n";
  const GazeLog own = read(text, EyeChoice::automatic);
  EXPECT_EQ(own.samples[0].u, 0.7);
  EXPECT_EQ(own.samples[1].validity, GazeValidity::lost);
  EXPECT_NEAR(read(text, EyeChoice::mean).samples[0].u, 0.3, 1e-15);
}

TEST_F(GazeEyes, BothEyesSurviveWritingAndReading) {
  const GazeLog log = read(log_with_dropout(), EyeChoice::mean);
  write_gaze_csv(log, files_.path("out.csv"));
  const GazeLog back = load_gaze_log(files_.path("out.csv"), {});
  ASSERT_EQ(back.samples.size(), log.samples.size());
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    EXPECT_EQ(back.samples[i].t_ns, log.samples[i].t_ns);
    EXPECT_EQ(back.samples[i].u, log.samples[i].u);
    EXPECT_EQ(back.eyes[i].left.at, log.eyes[i].left.at);
    EXPECT_EQ(back.eyes[i].right.validity, log.eyes[i].right.validity);
  }
}

TEST_F(GazeEyes, PupilUnitAndOriginsSurviveWriting) {
  GazeReadOptions options;
  options.columns.left = {.x = "lx",
                          .y = "ly",
                          .z = "lz",
                          .validity = "",
                          .confidence = "",
                          .pupil = "lp[mm]",
                          .openness = "",
                          .origin_x = "lox",
                          .origin_y = "loy",
                          .origin_z = "loz"};
  options.columns.right = {.x = "rx",
                           .y = "ry",
                           .z = "rz",
                           .validity = "",
                           .confidence = "",
                           .pupil = "rp[mm]",
                           .openness = "",
                           .origin_x = "rox",
                           .origin_y = "roy",
                           .origin_z = "roz"};
  const GazeLog log = load_gaze_log(
      files_.write("hmd.csv",
                   "t[ms],lx,ly,lz,lp[mm],lox,loy,loz,rx,ry,rz,rp[mm],rox,roy,roz\n"
                   "1,0,0,-1,3.5,-31,1,2,0.6,0,-0.8,4.5,32,1,2\n2,0,0,-1,3.25,-31.5,1,2,0.6,0,-0.8,4,32,1,2\n"),
      options);
  EXPECT_EQ(log.kind, GazeKind::direction);
  EXPECT_EQ(log.pupil_unit, "mm");
  ASSERT_EQ(log.origins.size(), 2U);
  EXPECT_EQ(log.origins[1].left_mm, (Vec3f{-31.5F, 1, 2}));
  write_gaze_csv(log, files_.path("out.csv"));
  const GazeLog back = load_gaze_log(files_.path("out.csv"), {});
  EXPECT_EQ(back.pupil_unit, "mm");
  ASSERT_EQ(back.origins.size(), 2U);
  EXPECT_EQ(back.origins[1].left_mm, log.origins[1].left_mm);
  EXPECT_EQ(back.origins[0].right_mm, log.origins[0].right_mm);
  EXPECT_EQ(back.eyes[1].right.pupil, 4.0F);
}

// Rows in order are joined while they are read, others once they are sorted: both give one log.
TEST_F(GazeEyes, RowsInOrderAndOthersGiveOneLog) {
  std::vector<std::string> times;
  for (int i = 0; i < 60; ++i) {
    std::string rows;
    for (const char* const eye : {"left", "right", "cyclopean"}) {
      const bool is_there = !(eye[0] == 'c' && i % 7 == 0) && !(eye[0] == 'r' && i % 11 == 0);
      const bool is_lost = eye[0] == 'l' && i % 5 == 0;
      rows += !is_there ? ""
              : is_lost
                  ? fmt::format("{},,,lost,{},\n", i * 10'000'000LL, eye)
                  : fmt::format("{},{},{},ok,{},{}\n", i * 10'000'000LL, 0.3 + 0.001 * i + (eye[0] == 'r' ? 0.01 : 0),
                                i % 13 == 0 ? 1.2 : 0.5, eye, 3 + 0.01 * i);
    }
    times.push_back(rows);
  }
  const auto text = [&] {
    std::string all = std::string(kPreamble) + "t[ns],u[1],v[1],valid,eye,pupil[mm]\n";
    for (const std::string& rows : times) {
      all += rows;
    }
    return all;
  };
  for (const EyeChoice eye : {EyeChoice::automatic, EyeChoice::left, EyeChoice::mean}) {
    GazeReadOptions options;
    options.eye = eye;
    options.unordered = UnorderedPolicy::sort;
    const GazeLog in_order = load_gaze_log(files_.write("log.csv", text()), options);
    std::swap(times[20], times[40]);
    const GazeLog sorted = load_gaze_log(files_.write("log.csv", text()), options);
    std::swap(times[20], times[40]);
    ASSERT_EQ(in_order.samples.size(), 60U);
    ASSERT_EQ(sorted.samples.size(), in_order.samples.size());
    ASSERT_EQ(sorted.eyes.size(), in_order.eyes.size());
    EXPECT_EQ(sorted.order.rows, in_order.order.rows);
    const auto same = [](auto a, auto b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    for (std::size_t i = 0; i < in_order.samples.size(); ++i) {
      const GazeSample& a = in_order.samples[i];
      const GazeSample& b = sorted.samples[i];
      EXPECT_EQ(a.t_ns, b.t_ns);
      EXPECT_EQ(a.eye, b.eye);
      EXPECT_EQ(a.validity, b.validity) << i;
      EXPECT_TRUE(same(a.u, b.u) && same(a.v, b.v) && same(a.pupil, b.pupil)) << i;
      EXPECT_TRUE(same(in_order.eyes[i].right.at.x, sorted.eyes[i].right.at.x)) << i;
      EXPECT_EQ(in_order.eyes[i].left.validity, sorted.eyes[i].left.validity) << i;
    }
  }
}

TEST_F(GazeEyes, WhatIsNotThereCannotBeChosen) {
  const std::string left_only = "t[ns],u[1],v[1],valid,eye\n0,0.7,0.5,ok,left\n";
  try {
    read(left_only, EyeChoice::right);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no rows of the right eye"));
    EXPECT_EQ(error.kind(), ErrorKind::usage);
  }
}

}  // namespace
}  // namespace gazetrace::gaze_eyes_test
