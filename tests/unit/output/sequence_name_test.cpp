// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gazetrace/output.hpp"

namespace gazetrace::sequence_name_test {
namespace {

TEST(SequenceName, Table) {
  struct Row {
    const char* pattern;
    std::int32_t frame;
    const char* name;
  };
  constexpr Row kRows[]{
      {"beauty.####.exr", 7, "beauty.0007.exr"},
      {"beauty.####.exr", 12345, "beauty.12345.exr"},
      {"beauty.#.exr", 7, "beauty.7.exr"},
      {"beauty.%04d.exr", 7, "beauty.0007.exr"},
      {"beauty.%4d.exr", 7, "beauty.0007.exr"},
      {"beauty.%d.exr", 7, "beauty.7.exr"},
      {"beauty.<frame>.exr", 7, "beauty.7.exr"},
      {"out#1/50%/beauty.%03d.exr", 7, "out#1/50%/beauty.007.exr"},
      {"100%%.%02d.png", 7, "100%.07.png"},
      {"out/%04d/%04d.exr", 7, "out/0007/0007.exr"},
      {"a%%/shot<frame>/f.##.exr", 7, "a%%/shot7/f.07.exr"},
      {"shot_%d/a.png", 7, "shot_%d/a.png"},
      {"still.png", 7, "still.png"},
      {"####", 0, "0000"},
      {"a.%06d", 2147483647, "a.2147483647"},
  };
  for (const Row& row : kRows) {
    EXPECT_EQ(frame_file_name(row.pattern, row.frame), row.name) << row.pattern;
  }
  EXPECT_TRUE(has_frame_number("a.##.png"));
  EXPECT_FALSE(has_frame_number("a.png"));
  EXPECT_FALSE(has_frame_number("100%%.png"));
  EXPECT_FALSE(has_frame_number("shot_%d/a.png"));
}

TEST(SequenceName, TheFolderOfAllFrames) {
  EXPECT_EQ(folder_of_frames("out/beauty.####.exr"), "out");
  EXPECT_EQ(folder_of_frames("beauty.####.exr"), ".");
  EXPECT_EQ(folder_of_frames("/beauty.####.exr"), "/");
  EXPECT_EQ(folder_of_frames("out/%04d/%04d.exr"), "out");
  EXPECT_EQ(folder_of_frames("out/a/shot<frame>/b/%04d.exr"), "out/a");
  EXPECT_EQ(folder_of_frames("%04d/%04d.exr"), ".");
  EXPECT_EQ(folder_of_frames("shot_%d/still.exr"), "shot_%d");
}

TEST(SequenceName, TheNameOfARunIsThatOfItsPictures) {
  EXPECT_EQ(run_name_of("out/beauty.####.exr"), "out/beauty");
  EXPECT_EQ(run_name_of("out/beauty.####.png"), "out/beauty");
  EXPECT_EQ(run_name_of("beauty_%04d.exr"), "./beauty");
  EXPECT_EQ(run_name_of("out/beauty<frame>.exr"), "out/beauty");
  EXPECT_EQ(run_name_of("out/beauty.####.left.exr"), "out/beauty.left");
  EXPECT_EQ(run_name_of("out/####_left.exr"), "out/left");
  EXPECT_EQ(run_name_of("out/####.exr"), "out/");
  EXPECT_EQ(run_name_of("out/beauty.####"), "out/beauty");
  EXPECT_EQ(run_name_of("out/%04d/%04d.exr"), "out/");
  EXPECT_EQ(run_name_of("out/shot<frame>/a.b.##.exr"), "out/a.b");
  EXPECT_EQ(run_name_of("out/100%%.##.exr"), "out/100%");
  EXPECT_EQ(run_name_of("shot_%d/still.exr"), "shot_%d/still");
  EXPECT_EQ(run_name_of("still.v2.png"), "./still.v2");
  EXPECT_EQ(folder_of_run("out/beauty"), "out");
  EXPECT_EQ(folder_of_run("out/"), "out");
  EXPECT_EQ(folder_of_run("./beauty"), ".");
}

void expect_usage(const std::string& pattern, std::int32_t frame, bool require_number, const char* text) {
  try {
    frame_file_name(pattern, frame, require_number);
    FAIL() << pattern;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_THAT(e.what(), testing::HasSubstr(text)) << pattern;
    EXPECT_THAT(e.what(), testing::HasSubstr(pattern));
  }
}

TEST(SequenceName, WhatIsRefused) {
  expect_usage("a.##.##.png", 1, false, "more than one place");
  expect_usage("a.%d.<frame>.png", 1, false, "more than one place");
  expect_usage("a.png", 1, true, "same file");
  expect_usage("a.%s.png", 1, false, "is not a frame number");
  expect_usage("a.%", 1, false, "is not a frame number");
  expect_usage("a.##.png", -1, false, "negative");
}

TEST(SequenceName, SettingsAreCheckedBeforeTheFirstRay) {
  OutputSettings good;
  good.exr.pattern = "a.####.exr";
  good.exr.aovs = {"albedo", "eccentricity"};
  good.display.pattern = "a.####.jpg";
  good.map_pattern = "map.####.exr";
  EXPECT_NO_THROW(check_output_settings(good, true));
  const auto refused = [&](auto change, const char* text) {
    OutputSettings bad = good;
    change(bad);
    try {
      check_output_settings(bad, true);
      FAIL() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      EXPECT_THAT(e.what(), testing::HasSubstr(text));
    }
  };
  refused([](OutputSettings& s) { s.exr.pattern = "a.####.tif"; }, "must end in .exr");
  refused([](OutputSettings& s) { s.exr.pattern = "a.exr"; }, "same file");
  refused([](OutputSettings& s) { s.exr.compression = "pizz"; }, "did you mean 'piz'");
  refused([](OutputSettings& s) { s.exr.aovs = {"albdo"}; }, "did you mean 'albedo'");
  refused([](OutputSettings& s) { s.exr.aovs = {"depth", "depth"}; }, "named twice");
  refused([](OutputSettings& s) { s.exr.crypto_ranks = 5; }, "even number");
  refused([](OutputSettings& s) { s.exr.sky_depth_m = -1; }, "no depth");
  for (const char* lossy : {"pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    const auto mattes = [&](OutputSettings& s) {
      s.exr.aovs = {"crypto_material"};
      s.exr.compression = lossy;
    };
    refused(mattes, "identifiers");
    OutputSettings parts = good;
    mattes(parts);
    parts.exr.parts = ExrParts::multi;
    EXPECT_NO_THROW(check_output_settings(parts, true));
  }
  refused([](OutputSettings& s) { s.map_pattern = "map.####"; }, "must end in .exr");
  refused([](OutputSettings& s) { s.display.pattern = "a.####.gif"; }, ".png, .jpg");
  refused([](OutputSettings& s) { s.display.pattern = "a_####"; }, "needs a suffix");
  refused([](OutputSettings& s) { s.display.bits = 16; }, "JPEG holds 8 bits");
  refused([](OutputSettings& s) { s.display.bits = 12; }, "8 or 16 bits");
  refused([](OutputSettings& s) { s.display.quality = 0; }, "1..100");
}

TEST(SequenceName, BitsToAskFor) {
  DisplaySettings settings;
  settings.pattern = "a.PNG";
  EXPECT_EQ(display_image_bits(settings), 8);
  settings.bits = 16;
  EXPECT_EQ(display_image_bits(settings), 16);
  settings.bits = 8;
  settings.pattern = "a.dpx";
  EXPECT_EQ(display_image_bits(settings), 16);
}

}  // namespace
}  // namespace gazetrace::sequence_name_test
