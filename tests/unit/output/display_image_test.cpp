// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <ctime>

#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "support/full_disk.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::display_image_test {
namespace {

const std::string kDigest = "0123456789abcdef0123456789abcdef";

FrameHeader example_header() {
  FrameHeader header;
  header.frame = 7;
  header.t_video_ns = 1'234'567'890'123;
  header.settings_digest = kDigest;
  header.software = "gazetrace 0.1.0";
  return header;
}

// Smooth, so that JPEG keeps it; every code value occurs.
DisplayImage example_image(int bits) {
  DisplayImage image;
  image.width_px = 64;
  image.height_px = 48;
  image.bits = bits;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (const int value : {4 * x, 5 * y, 255 - 2 * (x + y)}) {
        image.bytes.push_back(static_cast<std::uint8_t>(value));
        if (bits == 16) {
          image.bytes.push_back(static_cast<std::uint8_t>(value));
        }
      }
    }
  }
  return image;
}

DisplaySettings settings(int bits) {
  DisplaySettings result;
  result.bits = bits;
  return result;
}

TEST(DisplayImage, EveryFormatKeepsPixelsAndDigest) {
  struct Row {
    const char* name;
    int bits;
    float tolerance;
  };
  // JPEG loses; DPX has 10 bits: half of one of 1023 steps.
  for (const Row& row :
       {Row{"a.png", 8, 0}, Row{"b.png", 16, 0}, Row{"c.tif", 8, 0}, Row{"d.tiff", 16, 0}, Row{"e.jpg", 8, 0.02F},
        Row{"f.jpeg", 8, 0.02F}, Row{"g.dpx", 16, 0.0005F}, Row{"H.PNG", 8, 0}}) {
    const TemporaryFolder folder;
    const std::string path = folder / row.name;
    const DisplayImage image = example_image(row.bits);
    write_display_image(path, image, example_header(), settings(row.bits));
    EXPECT_THAT(folder.names(), testing::ElementsAre(row.name));
    EXPECT_EQ(read_settings_digest(path), kDigest) << row.name;
    const ImageRgb back = read_picture(path).rgb;
    ASSERT_EQ(back.pixels.size(), 64U * 48U) << row.name;
    float worst = 0;
    for (std::size_t i = 0; i < back.pixels.size(); ++i) {
      const std::size_t step = static_cast<std::size_t>(row.bits) / 8;
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = c == 0 ? back.pixels[i].x : c == 1 ? back.pixels[i].y : back.pixels[i].z;
        const float wanted = static_cast<float>(image.bytes[(3 * i + c) * step]) / 255.0F;
        worst = std::max(worst, std::abs(value - wanted));
      }
    }
    EXPECT_LE(worst, row.tolerance + 1e-7F) << row.name;
  }
}

TEST(DisplayImage, TheSameBytesAgain) {
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.dpx"}) {
    const TemporaryFolder folder;
    const std::string path = folder / name;
    write_display_image(path, example_image(16), example_header(), settings(16));
    const std::string first = file_bytes(path);
    // TIFF would note the second of writing if it could; both files may well be of the same second.
    const std::time_t now = std::time(nullptr);
    std::array<char, 16> day{};
    std::strftime(day.data(), day.size(), "%Y:%m:", std::localtime(&now));
    EXPECT_EQ(first.find(day.data()), std::string::npos) << name;
    write_display_image(path, example_image(16), example_header(), settings(16));
    EXPECT_TRUE(file_bytes(path) == first) << name;
  }
}

TEST(DisplayImage, EmptyTextsAreLeftOut) {
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.dpx"}) {
    const TemporaryFolder folder;
    EXPECT_NO_THROW(write_display_image(folder / name, example_image(8), FrameHeader{}, settings(8))) << name;
    EXPECT_EQ(read_settings_digest(folder / name), "") << name;
  }
}

TEST(DisplayImage, QualityIsThatOfTheSettings) {
  const TemporaryFolder folder;
  DisplaySettings low = settings(8);
  low.quality = 20;
  write_display_image(folder / "low.jpg", example_image(8), example_header(), low);
  write_display_image(folder / "high.jpg", example_image(8), example_header(), settings(8));
  EXPECT_LT(file_bytes(folder / "low.jpg").size(), file_bytes(folder / "high.jpg").size());
}

TEST(DisplayImage, UnknownSuffixesGetTheKnownOnes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.gif", "a.exr", "a"}) {
    try {
      write_display_image(folder / name, example_image(8), example_header(), settings(8));
      FAIL() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      EXPECT_THAT(e.what(), testing::HasSubstr(".png, .jpg, .jpeg, .tif, .tiff or .dpx"));
    }
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(DisplayImage, AFullDiskLeavesNothingUnderTheName) {
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.dpx"}) {
    const TemporaryFolder folder;
    const FullDisk full(100);
    try {
      write_display_image(folder / name, example_image(8), example_header(), settings(8));
      FAIL() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::runtime);
      EXPECT_THAT(e.what(), testing::HasSubstr("File too large"));
    }
    EXPECT_TRUE(folder.names().empty());
  }
}

TEST(DisplayImage, ForeignAndBrokenFilesHaveNoDigest) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.png";
  write_text_atomically(path, "no picture");
  EXPECT_EQ(read_settings_digest(path), "");
  EXPECT_EQ(read_settings_digest(folder / "none.png"), "");
}

}  // namespace
}  // namespace gazetrace::display_image_test
