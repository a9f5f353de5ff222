// SPDX-License-Identifier: Apache-2.0
// What of an EXR is the picture: its display window, and the channels that are light. The files are written with
// OpenEXR itself, by this test's own code.
#include "core/exr_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <array>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>

#include "core/image_io.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/scene.hpp"
#include "output/exr.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::exr_reader_test {
namespace {

using testing::HasSubstr;

// The value of a channel at a pixel: another for each of both.
float value_at(std::size_t channel, int x, int y) {
  return static_cast<float>(channel + 1) + static_cast<float>(x) / 64.0F + static_cast<float>(y) / 1024.0F;
}

std::string write_exr(const std::string& path, const Imath::Box2i& display, const Imath::Box2i& data,
                      const std::vector<std::string>& channels, Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  Imf::Header header(display, data);
  header.compression() = compression;
  const int width = data.max.x - data.min.x + 1;
  const int height = data.max.y - data.min.y + 1;
  std::vector<std::vector<float>> planes;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
    std::vector<float>& plane = planes.emplace_back();
    for (int y = data.min.y; y <= data.max.y; ++y) {
      for (int x = data.min.x; x <= data.max.x; ++x) {
        plane.push_back(value_at(c, x, y));
      }
    }
  }
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    buffer.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, planes[c].data(), data));
  }
  if (compression == Imf::PIZ_COMPRESSION) {  // tiles, which are another way through OpenEXR
    header.setTileDescription(Imf::TileDescription(16, 16));
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, (width + 15) / 16 - 1, 0, (height + 15) / 16 - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  }
  return path;
}

Imath::Box2i box(int x0, int y0, int x1, int y1) {
  return {{x0, y0}, {x1, y1}};
}

const std::vector<std::string> kRgb{"R", "G", "B"};

void expect_display_window(const ImageRgb& image, const Imath::Box2i& display, const Imath::Box2i& data) {
  ASSERT_EQ(image.width_px, display.max.x - display.min.x + 1);
  ASSERT_EQ(image.height_px, display.max.y - display.min.y + 1);
  for (int j = 0; j < image.height_px; ++j) {
    for (int i = 0; i < image.width_px; ++i) {
      const int x = display.min.x + i;
      const int y = display.min.y + j;
      const bool there = x >= data.min.x && x <= data.max.x && y >= data.min.y && y <= data.max.y;
      const Vec3f expected = there ? Vec3f{value_at(0, x, y), value_at(1, x, y), value_at(2, x, y)} : Vec3f{0, 0, 0};
      ASSERT_EQ(image(i, j), expected) << i << ", " << j;
    }
  }
}

TEST(ExrReader, ThePictureIsTheDisplayWindow) {
  const TemporaryFolder folder;
  const std::vector<std::pair<Imath::Box2i, Imath::Box2i>> windows{
      {box(0, 0, 39, 19), box(0, 0, 39, 19)},      // the same
      {box(0, 0, 39, 19), box(8, 4, 23, 11)},      // a crop
      {box(0, 0, 39, 19), box(-4, -2, 43, 21)},    // an overscan
      {box(0, 0, 39, 19), box(-4, 10, 10, 30)},    // a crop that stands out
      {box(-10, -20, 29, 3), box(-7, -9, 40, 1)},  // with an origin of its own
  };
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    for (const auto& [display, data] : windows) {
      const std::string path = write_exr((folder / "picture.exr"), display, data, kRgb, compression);
      expect_display_window(read_exr_rgb(path), display, data);
      expect_display_window(read_picture(path).rgb, display, data);
      expect_display_window(load_environment(path).radiance, display, data);
      EXPECT_EQ(
          read_picture_channel(write_exr((folder / "gray.exr"), display, data, {"Y"}, compression), {"Y"})(10, 11),
          read_exr_rgb(path)(10, 11).x);
      std::ifstream stream(path, std::ios::binary);
      const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
      const ImageRgba texture = read_image_rgba(bytes, "a texture");
      EXPECT_EQ(texture.floats, read_image_rgba(path, "a texture").floats);
      EXPECT_EQ(read_picture_size(bytes, "a texture").width_px, display.max.x - display.min.x + 1);
      EXPECT_EQ(texture.floats[4 * (11 * 40 + 10)], read_exr_rgb(path)(10, 11).x);
    }
  }
}

TEST(ExrReader, DataBesideTheDisplayWindowAreNoPicture) {
  const TemporaryFolder folder;
  const std::string path = write_exr((folder / "aside.exr"), box(0, 0, 9, 9), box(10, 0, 19, 9), kRgb);
  try {
    static_cast<void>(read_exr_rgb(path));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("outside its display window"));
  }
}

// A header of a few hundred bytes would otherwise ask for gigabytes of black.
TEST(ExrReader, AHugeDisplayWindowAroundFewPixelsIsRefused) {
  const TemporaryFolder folder;
  const std::string path = write_exr((folder / "huge.exr"), box(0, 0, 30000, 30000), box(0, 0, 1, 1), kRgb);
  EXPECT_THROW(static_cast<void>(read_exr_rgb(path)), Error);
  EXPECT_THROW(static_cast<void>(load_environment(path)), Error);
  const std::string crop = write_exr((folder / "crop.exr"), box(0, 0, 2047, 1023), box(9, 5, 10, 6), kRgb);
  EXPECT_EQ(load_environment(crop).radiance(10, 6).x, value_at(0, 10, 6));
}

TEST(ExrReader, GrayIsYOrRAlone) {
  const TemporaryFolder folder;
  const Imath::Box2i window = box(0, 0, 3, 1);
  for (const auto& names : std::vector<std::vector<std::string>>{{"R"}, {"Y"}, {"R", "A"}, {"Y", "Z"}}) {
    const std::string path = write_exr((folder / "gray.exr"), window, window, names);
    for (const ImageRgb& image : {read_exr_rgb(path), read_picture(path).rgb}) {
      const float value = value_at(0, 2, 1);
      EXPECT_EQ(image(2, 1), (Vec3f{value, value, value})) << names[0];
    }
    const ImageRgba texture = read_image_rgba(path, "a texture");
    EXPECT_EQ(texture.floats[1], texture.floats[0]);
    EXPECT_EQ(texture.floats[3], names.back() == "A" ? value_at(1, 0, 0) : 1.0F);
  }
}

TEST(ExrReader, ColorHasAnyOrderOfChannelsAndMayBeALayer) {
  const TemporaryFolder folder;
  const Imath::Box2i window = box(0, 0, 3, 1);
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"R", "G", "B", "A", "Z", "AO"}, {"view.R", "view.G", "view.B", "view.A", "Z", "normal.X"}}) {
    const std::string path = write_exr((folder / "color.exr"), window, window, names);
    const Vec3f expected{value_at(0, 1, 1), value_at(1, 1, 1), value_at(2, 1, 1)};
    EXPECT_EQ(read_exr_rgb(path)(1, 1), expected);
    EXPECT_EQ(load_environment(path).radiance(1, 1), expected);
    EXPECT_EQ(read_image_rgba(path, "a texture").floats[3], value_at(3, 0, 0));
  }
}

TEST(ExrReader, OfSeveralLayersTheOneThatIsSeenIsTaken) {
  const TemporaryFolder folder;
  const Imath::Box2i window = box(0, 0, 3, 1);
  using Names = std::vector<std::string>;
  for (const auto& names : std::vector<Names>{
           {"r", "g", "b", "a", "N.R", "N.G", "N.B"},
           {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Combined.A",
            "ViewLayer.DiffDir.R", "ViewLayer.DiffDir.G", "ViewLayer.DiffDir.B", "ViewLayer.Depth.Z"},
           {"Beauty.r", "Beauty.g", "Beauty.b", "Beauty.a", "albedo.r", "albedo.g", "albedo.b"},
           {"rgba.R", "rgba.G", "rgba.B", "rgba.A", "a.R", "a.G", "a.B"}}) {
    const std::string path = write_exr((folder / "layers.exr"), window, window, names);
    const Vec3f expected{value_at(0, 1, 1), value_at(1, 1, 1), value_at(2, 1, 1)};
    EXPECT_EQ(read_exr_rgb(path)(1, 1), expected) << names[0];
    EXPECT_EQ(read_image_rgba(path, "a texture").floats[3], value_at(3, 0, 0)) << names[0];
  }
  const std::string two =
      write_exr((folder / "two.exr"), window, window,
                {"A.Combined.R", "A.Combined.G", "A.Combined.B", "B.Combined.R", "B.Combined.G", "B.Combined.B"});
  EXPECT_THROW(static_cast<void>(read_exr_rgb(two)), Error);
}

// The message of the refusal.
std::string refusal(const std::function<void()>& read) {
  try {
    read();
    return "nothing was refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input) << e.what();
    return e.what();
  }
}

// One part of several: its name, its channels, and the value of all its pixels.
struct Part {
  std::string name;
  std::vector<std::string> channels;
  float value = 0;
};

std::string write_parts(const std::string& path, const std::vector<Part>& parts) {
  std::vector<Imf::Header> headers;
  for (const Part& part : parts) {
    Imf::Header& header = headers.emplace_back(4, 2);
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    for (const std::string& channel : part.channels) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    }
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::array<float, 8> values{};
    values.fill(parts[p].value);
    Imf::FrameBuffer buffer;
    for (const std::string& channel : parts[p].channels) {
      buffer.insert(channel,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float), 4 * sizeof(float)));
    }
    Imf::OutputPart part(file, static_cast<int>(p));
    part.setFrameBuffer(buffer);
    part.writePixels(2);
  }
  return path;
}

TEST(ExrReader, OfSeveralPartsTheOneThatIsLightIsTaken) {
  const TemporaryFolder folder;
  for (const auto& parts :
       std::vector<std::vector<Part>>{{{"depth", {"Z"}, 7}, {"rgba", kRgb, 2}},
                                      {{"depth", {"Y"}, 7}, {"picture", kRgb, 2}},
                                      {{"normal", kRgb, 7}, {"ViewLayer.Combined", kRgb, 2}},
                                      {{"normal", kRgb, 7}, {"beauty", {"beauty.R", "beauty.G", "beauty.B"}, 2}},
                                      {{"albedo", {"albedo.R", "albedo.G", "albedo.B"}, 7}, {"picture", kRgb, 2}}}) {
    const std::string path = write_parts(folder / "parts.exr", parts);
    EXPECT_EQ(read_exr_rgb(path)(3, 1), (Vec3f{2, 2, 2})) << parts[1].name;
    EXPECT_EQ(read_picture(path).facts.part, parts[1].name);
    EXPECT_EQ(read_image_rgba(path, "a texture").floats[0], 2);
  }
  const std::string views = write_parts(folder / "views.exr", {{"left", kRgb, 1}, {"right", kRgb, 2}});
  EXPECT_THAT(refusal([&] { static_cast<void>(read_exr_rgb(views)); }), HasSubstr("left:B, left:G, left:R, right:B"));
  EXPECT_THAT(refusal([&] { static_cast<void>(read_exr_rgb(views)); }), HasSubstr("several layers of color"));
  const std::string depths = write_parts(folder / "depths.exr", {{"depth", {"Y"}, 1}, {"far", {"Z"}, 2}});
  EXPECT_THAT(refusal([&] { static_cast<void>(load_environment(depths)); }), HasSubstr("none of which are its light"));
  const std::string maps = write_parts(folder / "maps.exr", {{"map", {"samples_per_pixel"}, 3}, {"x", {"Z"}, 2}});
  EXPECT_EQ(read_picture_channel(maps, {"Y", "samples_per_pixel"})(1, 1), 3);
}

void write_deep(const std::string& path, const std::vector<std::string>& channels) {
  Imf::Header header(2, 1);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::NO_COMPRESSION;
  std::array<unsigned, 2> counts{1, 1};
  float value = 1;
  std::array<float*, 2> samples{&value, &value};
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 2 * sizeof(unsigned)));
  for (const std::string& name : channels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()), sizeof(float*),
                                       2 * sizeof(float*), sizeof(float)));
  }
  Imf::DeepScanLineOutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(1);
}

TEST(ExrReader, DeepAndSubsampledFilesAreRefusedByTheirKind) {
  const TemporaryFolder folder;
  const std::string deep = folder / "deep.exr";
  const std::string with_depth = folder / "depth.exr";
  write_deep(deep, kRgb);
  write_deep(with_depth, {"R", "G", "B", "A", "Z"});
  const std::string subsampled = folder / "subsampled.exr";
  {
    Imf::Header header(4, 2);
    std::array<float, 8> values{};
    Imf::FrameBuffer buffer;
    for (const auto& [name, step] : std::map<std::string, int>{{"R", 1}, {"G", 1}, {"B", 2}}) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT, step, step));
      buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                     4 * sizeof(float), step, step));
    }
    Imf::OutputFile file(subsampled.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  for (const auto& [path, words] : std::map<std::string, std::string>{
           {deep, "deepscanline"}, {with_depth, "deepscanline"}, {subsampled, "B is subsampled"}}) {
    EXPECT_THAT(refusal([&] { static_cast<void>(read_exr_rgb(path)); }), HasSubstr(words));
    EXPECT_THAT(refusal([&] { static_cast<void>(load_environment(path)); }), HasSubstr(words));
    EXPECT_THAT(refusal([&] { static_cast<void>(read_image_rgba(path, "a texture")); }), HasSubstr(words));
  }
  EXPECT_THAT(refusal([&] { static_cast<void>(read_picture_channel(deep, {"Y"})); }), HasSubstr("deepscanline"));
}

TEST(ExrReader, WhatIsNoLightIsRefusedByItsChannels) {
  const TemporaryFolder folder;
  const Imath::Box2i window = box(0, 0, 3, 1);
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"Z"}, {"R", "G"}, {"A"}, {"a.R", "a.G", "a.B", "b.R", "b.G", "b.B"}, {"X", "Y", "Z"}}) {
    const std::string path = write_exr((folder / "other.exr"), window, window, names);
    for (const auto& read : std::vector<std::function<void()>>{
             [&] { static_cast<void>(read_exr_rgb(path)); }, [&] { static_cast<void>(load_environment(path)); },
             [&] { static_cast<void>(read_image_rgba(path, "a texture")); }}) {
      try {
        read();
        ADD_FAILURE() << names[0];
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::input);
        EXPECT_THAT(e.what(), HasSubstr("has the channels"));
        EXPECT_THAT(e.what(), HasSubstr(names[0]));
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::exr_reader_test
