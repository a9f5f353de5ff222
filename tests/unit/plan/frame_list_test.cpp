// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>

#include "gazetrace/plan.hpp"
#include "job/judged_frames.hpp"

namespace gazetrace::frame_list_test {
namespace {

using Frames = std::vector<std::int32_t>;

TEST(FrameRate, IsAReducedFraction) {
  EXPECT_EQ(parse_frame_rate("24"), (FrameRate{24, 1}));
  EXPECT_EQ(parse_frame_rate(" 23.976 "), (FrameRate{2997, 125}));
  EXPECT_EQ(parse_frame_rate("24000/1001"), (FrameRate{24000, 1001}));
  EXPECT_EQ(parse_frame_rate("30000 / 1000"), (FrameRate{30, 1}));
  EXPECT_EQ(parse_frame_rate("0.5"), (FrameRate{1, 2}));
  EXPECT_EQ(parse_frame_rate("25.0"), (FrameRate{25, 1}));
  EXPECT_EQ(to_string(FrameRate{24000, 1001}), "24000/1001");
  EXPECT_EQ(to_string(FrameRate{24, 1}), "24");
}

TEST(FrameRate, RefusesWhatIsNone) {
  const std::string remedy = "; write frames per second as 24, 23.976 or 24000/1001";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "'' is not a frame rate"},
      {"abc", "'abc' is not a frame rate"},
      {"0", "'0' is not positive"},
      {"-24", "'-24' is not positive"},
      {"24/0", "'24/0' is not positive"},
      {"24/", "'24/' is not a fraction of two whole numbers"},
      {"1e3", "'1e3' is not a frame rate"},
      {"24.", ""},
      {"99999999999999999999", "'99999999999999999999' is not a frame rate"},
  };
  for (const auto& [text, message] : cases) {
    try {
      parse_frame_rate(text);
      EXPECT_EQ(message, "") << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), message + remedy);
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

TEST(FrameList, ReadsRangesStepsAndLists) {
  EXPECT_EQ(parse_frame_list("7"), (Frames{7}));
  EXPECT_EQ(parse_frame_list("3-6"), (Frames{3, 4, 5, 6}));
  EXPECT_EQ(parse_frame_list("1-10x4"), (Frames{1, 5, 9}));
  EXPECT_EQ(parse_frame_list("9-12, 1,5 ,10"), (Frames{1, 5, 9, 10, 11, 12}));
  EXPECT_EQ(parse_frame_list("2147483646-2147483647"), (Frames{2147483646, 2147483647}));
  EXPECT_EQ(parse_frame_list("1-2147483647x1000000000"), (Frames{1, 1000000001, 2000000001}));
  EXPECT_EQ(parse_frame_list("1-100x2").size(), 50U);
}

TEST(FrameList, FormatsRunsAndReadsThemBack) {
  EXPECT_EQ(format_frame_list({}), "");
  EXPECT_EQ(format_frame_list({1, 2}), "1-2");
  EXPECT_EQ(format_frame_list({1, 3}), "1,3");
  EXPECT_EQ(format_frame_list({1, 3, 5}), "1-5x2");
  EXPECT_EQ(format_frame_list({1, 5, 9, 10, 11, 12}), "1-9x4,10-12");
  Frames all(100);
  std::iota(all.begin(), all.end(), 1);
  EXPECT_EQ(format_frame_list(all), "1-100");
  // Every subset of eleven frames comes back.
  for (unsigned bits = 1; bits < 2048; ++bits) {
    Frames frames;
    for (int i = 0; i < 11; ++i) {
      if ((bits >> static_cast<unsigned>(i) & 1U) != 0) {
        frames.push_back(i + 1);
      }
    }
    ASSERT_EQ(parse_frame_list(format_frame_list(frames)), frames) << format_frame_list(frames);
  }
}

TEST(FrameList, RefusesWhatIsNone) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "'' names no frame"},
      {"1,,2", "'1,,2' has an empty part"},
      {"0", "'0' does not exist: frames are numbered from 1"},
      {"-3", "'-3' does not exist: frames are numbered from 1"},
      {"0-5", "'0-5' does not exist: frames are numbered from 1"},
      {"5-1", "'5-1' counts backwards"},
      {"1-5x0", "'1-5x0' has no step of 1 or more after its x"},
      {"1-5x-1", "'1-5x-1' has no step of 1 or more after its x"},
      {"1-5x", "'1-5x' has no step of 1 or more after its x"},
      {"5x2", "'5x2' has a step, but no range"},
      {"1-2147483647", "'1-2147483647' makes more than 1000000 frames"},
      {"1-900000,1-900000", "'1-900000' makes more than 1000000 frames"},
      {"99999999999", "'99999999999' is neither a frame from 1 to 2147483647 nor a range of them"},
      {"one", "'one' is neither a frame from 1 to 2147483647 nor a range of them"},
      {"1.5", "'1.5' is neither a frame from 1 to 2147483647 nor a range of them"},
      {"1-", "'1-' is neither a frame from 1 to 2147483647 nor a range of them"},
  };
  for (const auto& [text, message] : cases) {
    try {
      parse_frame_list(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), message + "; write frames as 1-100, 1-100x2 or 1,5,9-12");
    }
  }
}

// At 24 frames a second FovVideoVDP has six frames in view.
TEST(JudgedFrames, AreRunsThatTheMetricCanSeeWhole) {
  const FrameRate film{24, 1};
  EXPECT_EQ(judged_numbers(1, LaterFrames::as_early_ones, film).runs, (std::vector<Frames>{{1}, {2}, {3}, {4}}));
  EXPECT_EQ(judged_numbers(24, LaterFrames::as_early_ones, film).runs, (std::vector<Frames>{{1, 2, 3, 4, 5, 6, 7, 8}}));
  EXPECT_EQ(judged_numbers(5, LaterFrames::all_differ, film).runs, (std::vector<Frames>{{1, 2, 3, 4, 5}}));
  const JudgedNumbers moving = judged_numbers(101, LaterFrames::all_differ, film);
  EXPECT_EQ(moving.sequence_frames, 101);
  EXPECT_EQ(moving.runs, (std::vector<Frames>{
                             {1, 2, 3, 4, 5, 6, 7, 8}, {48, 49, 50, 51, 52, 53, 54}, {95, 96, 97, 98, 99, 100, 101}}));
  EXPECT_EQ(judged_numbers(24, LaterFrames::as_the_middle, film).runs,
            (std::vector<Frames>{{1, 2, 3, 4, 5, 6, 7, 8}, {9, 10, 11, 12, 13, 14, 15}}));
  // Where runs would meet there are fewer.
  EXPECT_EQ(judged_numbers(15, LaterFrames::all_differ, film).runs,
            (std::vector<Frames>{{1, 2, 3, 4, 5, 6, 7, 8}, {9, 10, 11, 12, 13, 14, 15}}));
  EXPECT_EQ(judged_numbers(30, LaterFrames::all_differ, {30, 1}).runs.front().size(), 10U);
}

}  // namespace
}  // namespace gazetrace::frame_list_test
