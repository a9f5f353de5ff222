// SPDX-License-Identifier: Apache-2.0
// Frames as EXR files, read back through OpenImageIO and our own readers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "support/exr_probe.hpp"
#include "support/full_disk.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

Frame example_frame(int width, int height) {
  Frame frame;
  frame.radiance = ImageRgb(width, height);
  frame.albedo = ImageRgb(width, height, {0.5F, 0.25F, 0.125F});
  frame.normal = ImageRgb(width, height, {0, -1, 0});
  frame.depth_m = ImageGray(width, height, 123456.789F);
  frame.sample_count = ImageGray(width, height, 0.75F);
  frame.variance = ImageGray(width, height, 1e-30F);
  for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
    const auto t = static_cast<float>(i % 1000) * 0.001F;
    frame.radiance.pixels[i] = {t, 1 / 3.0F, 100 * t};
  }
  frame.depth_m.pixels.back() = kInf;
  return frame;
}

FrameHeader example_header() {
  FrameHeader header;
  header.frame = 42;
  header.t_video_ns = 9'007'199'254'740'993;  // no double holds it
  header.fps = {24000, 1001};
  header.camera.pose.position_m = {1, 2, 3};
  header.camera.projection.yfov_rad = 2 * std::atan(0.5);
  header.gaze_render.state = GazeState::held;
  header.gaze_render.u = 0.25;
  header.gaze_true.state = GazeState::measured;
  header.gaze_true.v = 0.75;
  header.exposure_ev = -0.1;
  header.seed = 18'446'744'073'709'551'615U;
  header.settings_digest = "0123456789abcdef0123456789abcdef";
  header.software = "gazetrace 0.1.0";
  return header;
}

ExrSettings settings(ExrPixels pixels, const std::string& compression, std::vector<std::string> aovs = {}) {
  ExrSettings result;
  result.pixels = pixels;
  result.compression = compression;
  result.aovs = std::move(aovs);
  return result;
}

TEST(ExrFrame, FloatPixelsComeBackBitEqualFromEveryLosslessCompression) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(67, 35);
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    const std::string path = folder / (std::string(compression) + ".exr");
    EXPECT_EQ(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::float32, compression))
                  .clamped_values,
              0U);
    EXPECT_EQ(read_exr_rgb(path), frame.radiance) << compression;
    EXPECT_EQ(read_image_rgb_float(path), frame.radiance) << compression;
  }
}

TEST(ExrFrame, EveryCompressionIsReadable) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(67, 35);
  for (const char* compression : {"pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    const std::string path = folder / (std::string(compression) + ".exr");
    write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::half, compression));
    const ImageRgb back = read_exr_rgb(path);
    ASSERT_EQ(back.pixels.size(), frame.radiance.pixels.size());
    EXPECT_NEAR(back(33, 17).y, 1 / 3.0F, 0.01F) << compression;
  }
  EXPECT_THROW(write_frame_exr(folder / "x.exr", frame, nullptr, example_header(), settings(ExrPixels::half, "lzma")),
               Error);
}

TEST(ExrFrame, HalfIsClampedAndCounted) {
  const TemporaryFolder folder;
  Frame frame = example_frame(4, 2);
  frame.radiance(0, 0) = {1e6F, -1e6F, kInf};
  frame.radiance(1, 0) = {65504, -65504, 65519};  // 65519 would round down, but is beyond the largest half
  const std::string path = folder / "half.exr";
  EXPECT_EQ(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::half, "piz")).clamped_values,
            4U);
  const ImageRgb back = read_exr_rgb(path);
  EXPECT_EQ(back(0, 0), (Vec3f{65504, -65504, 65504}));
  EXPECT_EQ(back(1, 0), (Vec3f{65504, -65504, 65504}));
  // 1/3 as a half: 1365 * 2^-12.
  EXPECT_EQ(back(2, 1).y, 1365.0F / 4096.0F);
  EXPECT_EQ(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::float32, "piz")).clamped_values,
            0U);
}

TEST(ExrFrame, LayersKeepTheirTypes) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(33, 17);
  ImageGray eccentricity(33, 17, 12.5F);
  const std::string path = folder / "layers.exr";
  write_frame_exr(path, frame, &eccentricity, example_header(), settings(ExrPixels::half, "zip", aov_names()));
  EXPECT_THAT(exr_channels(path),
              testing::UnorderedElementsAre("R half", "G half", "B half", "albedo.R half", "albedo.G half",
                                            "albedo.B half", "normal.X half", "normal.Y half", "normal.Z half",
                                            "depth.Z float", "samples float", "variance float", "eccentricity float"));
  EXPECT_EQ(exr_value(path, "albedo.B", 5, 5), 0.125F);
  EXPECT_EQ(exr_value(path, "normal.Y", 5, 5), -1.0F);
  EXPECT_EQ(exr_value(path, "depth.Z", 5, 5), 123456.789F);
  EXPECT_EQ(exr_value(path, "depth.Z", 32, 16), kInf);
  EXPECT_EQ(exr_value(path, "samples", 0, 0), 0.75F);
  EXPECT_EQ(exr_value(path, "variance", 0, 0), 1e-30F);
  EXPECT_EQ(exr_value(path, "eccentricity", 32, 0), 12.5F);
}

TEST(ExrFrame, MissingLayersAreNamed) {
  const TemporaryFolder folder;
  Frame frame = example_frame(4, 4);
  frame.albedo = {};
  for (const char* aov : {"albedo", "colour"}) {
    try {
      write_frame_exr(folder / "a.exr", frame, nullptr, example_header(), settings(ExrPixels::half, "zip", {aov}));
      FAIL() << aov;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(aov));
    }
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(ExrFrame, AFrameWithoutGazeKeepsTheChannel) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.exr";
  write_frame_exr(path, example_frame(4, 4), nullptr, example_header(),
                  settings(ExrPixels::half, "zip", {"eccentricity"}));
  EXPECT_TRUE(std::isnan(exr_value(path, "eccentricity", 3, 3)));
}

TEST(ExrFrame, TheHeaderSaysHowItWasMade) {
  const TemporaryFolder folder;
  const std::string path = folder / "header.exr";
  write_frame_exr(path, example_frame(40, 20), nullptr, example_header(), settings(ExrPixels::half, "zip"));
  const auto text = exr_attributes(path);
  EXPECT_EQ(text.at("chromaticities"), "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329");
  EXPECT_EQ(text.at("colorSpace"), "lin_rec709");
  EXPECT_EQ(text.at("software"), "gazetrace 0.1.0");
  EXPECT_EQ(text.at("framesPerSecond"), "24000/1001");
  EXPECT_EQ(text.at("gazetrace:frame"), "42");
  EXPECT_EQ(text.at("gazetrace:t_video_ns"), "9007199254740993");
  EXPECT_EQ(text.at("gazetrace:seed"), "18446744073709551615");
  EXPECT_EQ(text.at("gazetrace:exposure_ev"), "-0.1");
  EXPECT_EQ(text.at("gazetrace:settings_digest"), "0123456789abcdef0123456789abcdef");
  EXPECT_THAT(text.at("gazetrace:gaze_render"), testing::HasSubstr("state=held u=0.25"));
  EXPECT_THAT(text.at("gazetrace:gaze_true"), testing::HasSubstr("state=measured u=0.5 v=0.75 t_log_ns"));
  EXPECT_THAT(text.at("gazetrace:camera"), testing::HasSubstr("position_m=1,2,3"));
  EXPECT_THAT(text.at("gazetrace:camera"), testing::Not(testing::HasSubstr("aperture")));
  EXPECT_EQ(text.count("gazetrace:shutter_ns"), 0U);
  EXPECT_EQ(text.count("capDate"), 0U);
  EXPECT_EQ(read_settings_digest(path), "0123456789abcdef0123456789abcdef");
}

TEST(ExrFrame, TheHeaderTellsOfLensAndShutter) {
  const TemporaryFolder folder;
  const std::string path = folder / "lens.exr";
  FrameHeader header = example_header();
  header.camera.lens = {0.025, 4.5};
  header.shutter_open_ns = -7;
  header.shutter_close_ns = 9'007'199'254'740'993;
  write_frame_exr(path, example_frame(4, 2), nullptr, header, settings(ExrPixels::half, "zip"));
  const auto text = exr_attributes(path);
  EXPECT_THAT(text.at("gazetrace:camera"), testing::HasSubstr("aperture_radius_m=0.025 focus_distance_m=4.5"));
  EXPECT_EQ(text.at("gazetrace:shutter_ns"), "-7,9007199254740993");
}

TEST(ExrFrame, MatricesTakeTheWorldToTheScreen) {
  const TemporaryFolder folder;
  const std::string path = folder / "matrix.exr";
  FrameHeader header = example_header();
  // At (1, 2, 3), looking along -z, 2 atan(1/2) high and twice as wide: at distance 4 the view is 8 x 4 m.
  write_frame_exr(path, example_frame(40, 20), nullptr, header, settings(ExrPixels::half, "zip"));
  EXPECT_THAT(exr_transform(path, "worldToCamera", {1, 2, -1}),
              testing::Pointwise(testing::FloatNear(1e-5F), {0.F, 0.F, 4.F}));
  const auto corner = exr_transform(path, "worldToNDC", {1 - 4, 2 + 2, -1});
  EXPECT_NEAR(corner[0], 0.0, 1e-5);
  EXPECT_NEAR(corner[1], 0.0, 1e-5);
  const auto inside = exr_transform(path, "worldToNDC", {1 + 2, 2 - 1, -1});
  EXPECT_NEAR(inside[0], 0.75, 1e-5);
  EXPECT_NEAR(inside[1], 0.75, 1e-5);
  header.camera.projection.kind = ProjectionKind::orthographic;
  header.camera.projection.ymag_m = 2;
  write_frame_exr(path, example_frame(40, 20), nullptr, header, settings(ExrPixels::half, "zip"));
  const auto flat = exr_transform(path, "worldToNDC", {1 + 2, 2 - 1, -100});
  EXPECT_NEAR(flat[0], 0.75, 1e-5);
  EXPECT_NEAR(flat[1], 0.75, 1e-5);
}

TEST(ExrFrame, TheSameBytesFromAnyNumberOfThreadsAndAtAnyTime) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(513, 257);
  for (const char* compression : {"zip", "piz", "dwaa"}) {
    std::string first;
    for (const int threads : {1, 2, 3, 2}) {
      const std::string path = folder / "same.exr";
      write_frame_exr(path, frame, nullptr, example_header(),
                      settings(ExrPixels::half, compression, {"depth", "normal"}), threads);
      const std::string bytes = file_bytes(path);
      first = first.empty() ? bytes : first;
      EXPECT_TRUE(bytes == first) << compression << ' ' << threads;
    }
  }
}

TEST(ExrFrame, AFullDiskLeavesNothingUnderTheName) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(200, 200);
  const std::string path = folder / "frame.exr";
  {
    const FullDisk full(10'000);
    try {
      write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::float32, "none"));
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::runtime);
      EXPECT_THAT(e.what(), testing::StartsWith(path + ": cannot write the file: File too large"));
    }
  }
  EXPECT_TRUE(folder.names().empty());
  // An older file stays as it was.
  write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::half, "none"));
  const std::string before = file_bytes(path);
  {
    const FullDisk full(10'000);
    EXPECT_THROW(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::float32, "none")), Error);
  }
  EXPECT_TRUE(file_bytes(path) == before);
  EXPECT_THAT(folder.names(), testing::ElementsAre("frame.exr"));
}

TEST(ExrFrame, UnusableNames) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "taken.exr");
  for (const std::string& path : {folder / "none/frame.exr", folder / "taken.exr"}) {
    try {
      write_frame_exr(path, example_frame(4, 4), nullptr, example_header(), settings(ExrPixels::half, "zip"));
      FAIL() << path;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::runtime);
      EXPECT_THAT(e.what(), testing::StartsWith(path));
    }
  }
  EXPECT_THAT(folder.names(), testing::ElementsAre("taken.exr"));
}

TEST(ExrFrame, AnIncompleteFileHasNoDigest) {
  const TemporaryFolder folder;
  const std::string path = folder / "frame.exr";
  write_frame_exr(path, example_frame(64, 64), nullptr, example_header(), settings(ExrPixels::half, "zip"));
  const std::string whole = file_bytes(path);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{3}, std::size_t{200}, whole.size() / 2, whole.size() - 1}) {
    write_text_atomically(path, whole.substr(0, size));
    EXPECT_EQ(read_settings_digest(path), "") << size;
  }
  write_text_atomically(path, whole);
  EXPECT_NE(read_settings_digest(path), "");
  EXPECT_EQ(read_settings_digest(folder / "none.exr"), "");
  EXPECT_THROW(read_exr_rgb(folder / "none.exr"), Error);
}

TEST(ExrFrame, SamplingMap) {
  const TemporaryFolder folder;
  SamplingMap map;
  map.width_px = 2;
  map.height_px = 1;
  map.region = Image<std::uint8_t>(2, 1);
  map.region(1, 0) = 1;
  map.regions = {{"fovea", 1, 1, 1, 32, 32}, {"intermediate", 2, 1, 1, 16, 4}};
  map.sites = {{0, 0, 32, 1, 0}, {0, 0, 16, 1, 1}};
  map.tiles = {{0, 0, 2, 1, 0, 2, 48}};
  const ImageGray eccentricity(2, 1, 3.5F);
  const std::string path = folder / "map.exr";
  write_sampling_map_exr(path, map, &eccentricity);
  EXPECT_THAT(exr_channels(path),
              testing::UnorderedElementsAre("region float", "samples_per_pixel float", "eccentricity float"));
  EXPECT_EQ(exr_value(path, "region", 1, 0), 1.0F);
  EXPECT_EQ(exr_value(path, "samples_per_pixel", 0, 0), 32.0F);
  EXPECT_EQ(exr_value(path, "samples_per_pixel", 1, 0), 16.0F);
  EXPECT_EQ(exr_value(path, "eccentricity", 1, 0), 3.5F);
  EXPECT_EQ(exr_attributes(path).at("gazetrace:region_1"), "intermediate");
}

}  // namespace
}  // namespace gazetrace
