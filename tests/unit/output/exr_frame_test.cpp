// SPDX-License-Identifier: Apache-2.0
// Frames as EXR files, read back through OpenImageIO and our own readers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTimeCode.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "support/exr_probe.hpp"
#include "support/full_disk.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::exr_frame_test {
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

// What every frame can have.
const std::vector<std::string> kOfFrames{"albedo", "normal", "depth", "samples", "variance", "eccentricity"};

TEST(ExrFrame, FloatPixelsComeBackBitEqualFromEveryLosslessCompression) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(67, 35);
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    const std::string path = folder / (std::string(compression) + ".exr");
    EXPECT_EQ(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::float32, compression))
                  .clamped_values,
              0U);
    EXPECT_EQ(read_exr_rgb(path), frame.radiance) << compression;
    EXPECT_EQ(read_picture(path).rgb, frame.radiance) << compression;
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

// What is no number was not too large, and stays no number.
TEST(ExrFrame, NanIsNotClamped) {
  const TemporaryFolder folder;
  Frame frame = example_frame(5, 3);
  frame.radiance(1, 1) = {std::numeric_limits<float>::quiet_NaN(), 1e6F, 0.5F};
  const std::string path = folder / "nan.exr";
  EXPECT_EQ(write_frame_exr(path, frame, nullptr, example_header(), settings(ExrPixels::half, "zip")).clamped_values,
            1U);
  const ImageRgb back = read_exr_rgb(path);
  EXPECT_TRUE(std::isnan(back(1, 1).x));
  EXPECT_EQ(back(1, 1).y, 65504);
  EXPECT_EQ(back(1, 1).z, 0.5F);
}

TEST(ExrFrame, LayersKeepTheirTypes) {
  const TemporaryFolder folder;
  const Frame frame = example_frame(33, 17);
  ImageGray eccentricity(33, 17, 12.5F);
  const std::string path = folder / "layers.exr";
  write_frame_exr(path, frame, &eccentricity, example_header(), settings(ExrPixels::half, "zip", kOfFrames));
  EXPECT_THAT(exr_channels(path), testing::UnorderedElementsAre(
                                      "R half", "G half", "B half", "albedo.R half", "albedo.G half", "albedo.B half",
                                      "normal.X half", "normal.Y half", "normal.Z half", "depth.Z float",
                                      "samples.X float", "variance.X float", "eccentricity.X float"));
  EXPECT_EQ(exr_value(path, "albedo.B", 5, 5), 0.125F);
  EXPECT_EQ(exr_value(path, "normal.Y", 5, 5), -1.0F);
  EXPECT_EQ(exr_value(path, "depth.Z", 5, 5), 123456.789F);
  EXPECT_EQ(exr_value(path, "depth.Z", 32, 16), kInf);
  EXPECT_EQ(exr_value(path, "samples.X", 0, 0), 0.75F);
  EXPECT_EQ(exr_value(path, "variance.X", 0, 0), 1e-30F);
  EXPECT_EQ(exr_value(path, "eccentricity.X", 32, 0), 12.5F);
}

// A frame of 5 x 3 pixels with every layer.
FrameLayers example_layers(int ranks) {
  FrameLayers layers;
  auto tables = std::make_shared<std::vector<MatteTable>>();
  for (const std::string& name : cryptomatte_layers()) {
    tables->push_back({name, {}, R"({"floor":"7819c83c"})"});
    Coverage& coverage = layers.mattes.emplace_back();
    for (int rank = 0; rank < ranks; ++rank) {
      coverage.id.emplace_back(5, 3, std::bit_cast<float>(0x7819c83cU + static_cast<std::uint32_t>(rank)));
      coverage.share.emplace_back(5, 3, 0.5F / static_cast<float>(1 + rank));
    }
  }
  layers.tables = std::move(tables);
  layers.motion.forward_px = Image<Vec2f>(5, 3, {1.5F, -2});
  layers.motion.backward_px = Image<Vec2f>(5, 3, {-1.5F, 2});
  layers.motion.position_m = ImageRgb(5, 3, {1, 2, 3});
  for (std::size_t group = 0; group < kLightGroups; ++group) {
    layers.light.emplace_back(5, 3, Vec3f{static_cast<float>(group), 1, 1});
  }
  return layers;
}

TEST(ExrFrame, EveryLayerHasAGroupOfItsOwn) {
  const TemporaryFolder folder;
  const std::string path = folder / "all.exr";
  write_frame_exr(path, example_frame(5, 3), nullptr, example_header(), settings(ExrPixels::half, "zip", aov_names()),
                  1, example_layers(6));
  const std::vector<std::string> channels = exr_channels(path);
  EXPECT_EQ(channels.size(), 3U + 3 + 3 + 1 + 6 * 3 + 3 + 2 + 2 + 3 * 12 + 3);
  for (const std::string& channel : channels) {
    const bool is_picture = channel.starts_with("R ") || channel.starts_with("G ") || channel.starts_with("B ");
    EXPECT_EQ(channel.find('.') == std::string::npos, is_picture) << channel;
  }
  EXPECT_EQ(exr_value(path, "forward.u", 4, 2), 1.5F);
  EXPECT_EQ(exr_value(path, "forward.v", 4, 2), -2);
  EXPECT_EQ(exr_value(path, "backward.u", 0, 0), -1.5F);
  EXPECT_EQ(exr_value(path, "position.Z", 0, 0), 3);
  EXPECT_EQ(exr_value(path, "specular_indirect.R", 0, 0), 3);
  EXPECT_EQ(exr_value(path, "background.R", 0, 0), 5);
  // Rank 3 is the second one of the second layer.
  EXPECT_EQ(std::bit_cast<std::uint32_t>(exr_value(path, "crypto_material01.B", 4, 2)), 0x7819c83fU);
  EXPECT_EQ(exr_value(path, "crypto_material01.A", 4, 2), 0.125F);
  EXPECT_EQ(exr_attributes(path).at("cryptomatte/f834d0a/manifest"), R"({"floor":"7819c83c"})");
  EXPECT_EQ(exr_attributes(path).at("cryptomatte/f834d0a/conversion"), "uint32_to_float32");
}

TEST(ExrFrame, EveryLayerIsAPartWhereThatIsAskedFor) {
  const TemporaryFolder folder;
  const std::string path = folder / "parts.exr";
  ExrSettings parts = settings(ExrPixels::half, "dwaa", {"albedo", "crypto_object", "depth"});
  parts.parts = ExrParts::multi;
  const Frame frame = example_frame(5, 3);
  write_frame_exr(path, frame, nullptr, example_header(), parts, 2, example_layers(2));
  const Imf::MultiPartInputFile file(path.c_str(), 0);
  ASSERT_EQ(file.parts(), 4);
  const std::array<const char*, 4> names{"beauty", "albedo", "crypto_object", "depth"};
  const std::array<Imf::Compression, 4> packed{Imf::DWAA_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::ZIP_COMPRESSION,
                                               Imf::ZIP_COMPRESSION};
  for (int part = 0; part < 4; ++part) {
    EXPECT_EQ(file.header(part).name(), names.at(static_cast<std::size_t>(part)));
    EXPECT_EQ(file.header(part).compression(), packed.at(static_cast<std::size_t>(part)));
    EXPECT_TRUE(Imf::hasTimeCode(file.header(part)));
  }
  EXPECT_NE(file.header(2).channels().findChannel("crypto_object00.A"), nullptr);
  EXPECT_NE(file.header(2).findTypedAttribute<Imf::StringAttribute>("cryptomatte/f834d0a/name"), nullptr);
  EXPECT_NEAR(read_exr_rgb(path)(3, 1).y, 1 / 3.0F, 0.01F);
  EXPECT_EQ(read_settings_digest(path), example_header().settings_digest);
  // A file that was cut behind its first part is not finished.
  const auto whole = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, whole - 8);
  EXPECT_EQ(read_settings_digest(path), "");
}

TEST(ExrFrame, TheSkyHasTheDepthThatIsAskedFor) {
  const TemporaryFolder folder;
  const std::string path = folder / "depth.exr";
  ExrSettings depth = settings(ExrPixels::half, "zip", {"depth"});
  const Frame frame = example_frame(5, 3);
  write_frame_exr(path, frame, nullptr, example_header(), depth);
  EXPECT_EQ(exr_value(path, "depth.Z", 4, 2), kInf);
  EXPECT_EQ(exr_attributes(path).at("gazetrace:sky_depth_m"), "inf");
  depth.sky_depth_m = 10000;
  write_frame_exr(path, frame, nullptr, example_header(), depth);
  EXPECT_EQ(exr_value(path, "depth.Z", 4, 2), 10000);
  EXPECT_EQ(exr_value(path, "depth.Z", 0, 0), 123456.789F);
  EXPECT_EQ(exr_attributes(path).at("gazetrace:sky_depth_m"), "10000");
}

// By SMPTE 12M: hours, minutes, seconds and frames; from 31 frames a second on, pairs of frames.
TEST(ExrFrame, TheTimeCodeCountsFrames) {
  const TemporaryFolder folder;
  const std::string path = folder / "time.exr";
  const auto code = [&](FrameRate fps, std::int32_t frame) -> std::string {
    FrameHeader header = example_header();
    header.fps = fps;
    header.frame = frame;
    write_frame_exr(path, example_frame(4, 2), nullptr, header, settings(ExrPixels::half, "zip"));
    const Imf::InputFile file(path.c_str(), 0);
    if (!Imf::hasTimeCode(file.header())) {
      return "none";
    }
    const Imf::TimeCode& t = Imf::timeCode(file.header());
    return fmt::format("{:02}:{:02}:{:02}:{:02}{}", t.hours(), t.minutes(), t.seconds(), t.frame(),
                       t.fieldPhase() ? "+" : "");
  };
  EXPECT_EQ(code({24, 1}, 1), "00:00:00:00");
  EXPECT_EQ(code({24, 1}, 25), "00:00:01:00");
  EXPECT_EQ(code({24, 1}, 24 * 3600 * 25 + 24 * 61 + 24), "01:01:01:23");
  EXPECT_EQ(code({30000, 1001}, 31), "00:00:01:00");
  EXPECT_EQ(code({60, 1}, 60), "00:00:00:29+");
  EXPECT_EQ(code({50, 1}, 53), "00:00:01:01");
  EXPECT_EQ(code({120, 1}, 53), "none");
  EXPECT_EQ(code({47, 2}, 25), "00:00:01:00") << "23.5 counts as 24";
  EXPECT_EQ(code({9223372036854775800, 384307168202282325}, 25), "00:00:01:00") << "24, by numbers that are too large";
  EXPECT_EQ(code({9223372036854775807, 2}, 25), "none");
}

TEST(ExrFrame, GazeIsInTheHeaderAsNumbers) {
  const TemporaryFolder folder;
  const std::string path = folder / "gaze.exr";
  FrameHeader header = example_header();
  header.gaze = {0.25, 0.75, 1};
  write_frame_exr(path, example_frame(4, 2), nullptr, header, settings(ExrPixels::half, "zip"));
  const Imf::InputFile file(path.c_str(), 0);
  EXPECT_EQ(file.header().typedAttribute<Imf::FloatAttribute>("gaze.u").value(), 0.25F);
  EXPECT_EQ(file.header().typedAttribute<Imf::FloatAttribute>("gaze.v").value(), 0.75F);
  EXPECT_EQ(file.header().typedAttribute<Imf::IntAttribute>("gaze.valid").value(), 1);
  write_frame_exr(path, example_frame(4, 2), nullptr, example_header(), settings(ExrPixels::half, "zip"));
  const Imf::InputFile without(path.c_str(), 0);
  EXPECT_TRUE(std::isnan(without.header().typedAttribute<Imf::FloatAttribute>("gaze.u").value()));
  EXPECT_EQ(without.header().typedAttribute<Imf::IntAttribute>("gaze.valid").value(), 0);
}

TEST(ExrFrame, MissingLayersAreNamed) {
  const TemporaryFolder folder;
  Frame frame = example_frame(4, 4);
  frame.albedo = {};
  for (const char* aov : {"albedo", "colour", "forward", "position", "crypto_asset", "emission"}) {
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
  EXPECT_TRUE(std::isnan(exr_value(path, "eccentricity.X", 3, 3)));
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
  // The frame's middle moves to what was at 0.75, 0.75: (0.5, -0.25) m from the axis at distance 1.
  header.camera.projection.middle_m = {0.5, -0.25};
  write_frame_exr(path, example_frame(40, 20), nullptr, header, settings(ExrPixels::half, "zip"));
  const auto middle = exr_transform(path, "worldToNDC", {1 + 2, 2 - 1, -1});
  EXPECT_NEAR(middle[0], 0.5, 1e-5);
  EXPECT_NEAR(middle[1], 0.5, 1e-5);
  header.camera.projection.middle_m = {};
  header.camera.projection.kind = ProjectionKind::orthographic;
  header.camera.projection.ymag_m = 2;
  write_frame_exr(path, example_frame(40, 20), nullptr, header, settings(ExrPixels::half, "zip"));
  const auto flat = exr_transform(path, "worldToNDC", {1 + 2, 2 - 1, -100});
  EXPECT_NEAR(flat[0], 0.75, 1e-5);
  EXPECT_NEAR(flat[1], 0.75, 1e-5);
  header.camera.projection.middle_m = {2, -1};
  write_frame_exr(path, example_frame(40, 20), nullptr, header, settings(ExrPixels::half, "zip"));
  EXPECT_NEAR(exr_transform(path, "worldToNDC", {1 + 2, 2 - 1, -100})[0], 0.5, 1e-5);
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
  using Kinds = std::map<std::string, ErrorKind>;
  for (const auto& [path, kind] :
       Kinds{{folder / "none/frame.exr", ErrorKind::runtime}, {folder / "taken.exr", ErrorKind::input}}) {
    try {
      write_frame_exr(path, example_frame(4, 4), nullptr, example_header(), settings(ExrPixels::half, "zip"));
      FAIL() << path;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), kind) << path;
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
}  // namespace gazetrace::exr_frame_test
