// SPDX-License-Identifier: Apache-2.0
// Sampling maps that follow a picture: counts, totals, blocks, budgets, and what is refused.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "support/map_consistency.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::density_picture_test {
namespace {

constexpr int kWidth = 190, kHeight = 101;

FoveationSettings by_picture() {
  FoveationSettings settings;
  settings.sampling = density_of_picture();
  return settings;
}

PlanarView view() {
  return view_of_perspective(1, kWidth, kHeight);
}

MapContext follow(const ImageGray& density) {
  MapContext context;
  context.density = &density;
  context.seed = 7;
  return context;
}

SamplingMap map_of(const ImageGray& density, const FoveationSettings& settings = by_picture()) {
  return make_sampling_map(settings, view(), std::nullopt, follow(density));
}

// Whole and broken rates of 1/4 to 40 samples without any order.
ImageGray noise() {
  std::mt19937 random(3);
  ImageGray density(kWidth, kHeight);
  for (float& value : density.pixels) {
    value = std::exp2(std::uniform_real_distribution<float>(-2, 5.3F)(random));
    value = value > 10 ? std::round(value) : value;
  }
  return density;
}

double sum_of(const ImageGray& density) {
  double sum = 0;
  for (const float value : density.pixels) {
    sum += static_cast<double>(value);
  }
  return sum;
}

TEST(DensityPicture, EverySiteGetsWhatItsPixelsAskForAndNotOneSampleMoreOrLess) {
  const ImageGray density = noise();
  const SamplingMap map = map_of(density);
  expect_consistent(map);
  std::vector<PixelIndex> pixels;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    pixels_of_site(map, map.sites[i], pixels);
    double asked = 0;
    for (const PixelIndex& pixel : pixels) {
      asked += static_cast<double>(density(pixel.x, pixel.y));
    }
    ASSERT_NEAR(map.expected(i), asked, 1e-5 * asked);
    ASSERT_LT(std::abs(map.sites[i].samples - asked), 1);
  }
  EXPECT_NEAR(static_cast<double>(map.samples()), sum_of(density), 1);
  const ImageGray spp = samples_per_pixel(map);
  EXPECT_EQ(*std::max_element(spp.pixels.begin(), spp.pixels.end()), 39);  // 2^5.3, rounded
}

TEST(DensityPicture, WholeRatesAreExactAndSparseOnesBecomeBlocks) {
  ImageGray density(kWidth, kHeight, 12);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 96; x < kWidth; ++x) {
      density(x, y) = 0.125F;
    }
  }
  const SamplingMap map = map_of(density);
  expect_consistent(map);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int side = map.regions[map.region(x, y)].block_px;
      if (x < 95) {
        ASSERT_EQ(side, 1) << x << ',' << y;
      } else if (x >= 112) {
        ASSERT_EQ(side, 8) << x << ',' << y;  // the smallest that expects 8 samples
      }
    }
  }
  const ImageGray rates = samples_per_pixel(map);
  EXPECT_EQ(rates(3, 3), 12.0F);
  EXPECT_EQ(rates(130, 40), 0.125F);
}

TEST(DensityPicture, AnySizeIsStretchedOverTheFrame) {
  ImageGray density(2, 1);
  density.pixels = {4, 1};
  const ImageGray rates = *density_image(by_picture(), view(), {0, 0, -1}, follow(density));
  EXPECT_EQ(rates(20, 50), 1.0F);    // left of the first texel's centre
  EXPECT_EQ(rates(180, 50), 0.25F);  // right of the second's
  EXPECT_EQ(rates(95, 50), rates(95, 5));
  EXPECT_NEAR(rates(94, 50), 0.625, 0.01);  // between them
  EXPECT_EQ(map_of(ImageGray(1, 1, 3)).samples(), 3U * kWidth * kHeight);
}

TEST(DensityPicture, OnABudgetOnlyProportionsCount) {
  const ImageGray density = noise();
  ImageGray faint = density;
  for (float& value : faint.pixels) {
    value *= 0x1p-30F;
  }
  FoveationSettings settings = by_picture();
  settings.spp = 1.5;
  const SamplingMap map = map_of(density, settings);
  expect_consistent(map);
  EXPECT_NEAR(static_cast<double>(map.samples()), 1.5 * kWidth * kHeight, 1.01);
  const SamplingMap same = map_of(faint, settings);
  ASSERT_EQ(map.sites.size(), same.sites.size());
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    ASSERT_EQ(map.sites[i].samples, same.sites[i].samples);
  }
}

TEST(DensityPicture, ZerosKeepTheFloorSoThatNoPlaceIsLeftOut) {
  ImageGray density(kWidth, kHeight, 0);
  density(100, 50) = 64;
  const SamplingMap map = map_of(density);
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    ASSERT_GE(map.expected(i) / map.sites[i].pixels, 64.0 / 512 * (1 - 1e-6));
  }
}

TEST(DensityPicture, GazeHasNoPartInIt) {
  const ImageGray density = noise();
  const SamplingMap without = map_of(density);
  const SamplingMap with = make_sampling_map(by_picture(), view(), view().direction(3, 90), follow(density));
  ASSERT_EQ(without.sites.size(), with.sites.size());
  for (std::size_t i = 0; i < without.sites.size(); ++i) {
    ASSERT_EQ(without.sites[i].samples, with.sites[i].samples);
  }
}

void write_exr(const std::string& path, const ImageGray& image, const char* channel) {
  Imf::Header header(image.width_px, image.height_px);
  header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  Imf::OutputFile file(path.c_str(), header, 0);
  Imf::FrameBuffer buffer;
  const auto row = sizeof(float) * static_cast<std::size_t>(image.width_px);
  // OpenEXR writes from what it takes for changeable memory.
  buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(image.pixels.data())),
                                    sizeof(float), row));
  file.setFrameBuffer(buffer);
  file.writePixels(image.height_px);
}

std::string said(const std::string& file, std::int32_t frame = 1) {
  FoveationSettings settings;
  settings.sampling = parse_density(file);
  try {
    read_density_picture(settings, frame);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(DensityPicture, WhatIsWrongWithAFileIsNamed) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/density.exr";
  ImageGray density(5, 4, 1);
  write_exr(path, density, "density");  // a single channel may have any name
  EXPECT_EQ(said(path), "");
  density(3, 2) = -0.5F;
  write_exr(path, density, "Y");
  EXPECT_NE(said(path).find(path + ": pixel 3,2 has the value -0.5"), std::string::npos) << said(path);
  density(3, 2) = std::numeric_limits<float>::quiet_NaN();
  write_exr(path, density, "Y");
  EXPECT_NE(said(path).find(path + ": pixel 3,2 has the value nan"), std::string::npos) << said(path);
  density(3, 2) = std::numeric_limits<float>::infinity();
  write_exr(path, density, "Y");
  EXPECT_NE(said(path).find("pixel 3,2 has the value inf"), std::string::npos) << said(path);
  density(3, 2) = 2e6F;
  write_exr(path, density, "Y");
  EXPECT_NE(said(path).find("1e+06 samples a pixel"), std::string::npos) << said(path);
  write_exr(path, ImageGray(5, 4, 0), "Y");
  EXPECT_NE(said(path).find("no pixel has a value above 0"), std::string::npos) << said(path);
  EXPECT_NE(said(folder.path() + "/other.exr").find("no such file"), std::string::npos);
}

TEST(DensityPicture, SizesThatFilesOnlyClaimAreRefusedBeforeThereIsMemoryForThem) {
  const TemporaryFolder folder;
  const std::string path = folder / "map.exr";
  write_exr(path, ImageGray(8, 40, 1), "Y");
  std::string bytes = file_bytes(path);
  const std::string before("dataWindow\0box2i\0\20\0\0\0", 21);
  const std::size_t at = bytes.find(before);
  ASSERT_NE(at, std::string::npos);
  for (const auto& [width, height, words] :
       {std::tuple{60000, 100, "60000 x 100 pixels and "}, std::tuple{65000, 64, "65000 x 64 pixels and "},
        std::tuple{1'000'000, 4, "a window of 1000000 x 4 pixels"}}) {
    const std::array<std::int32_t, 4> window{0, 0, width - 1, height - 1};
    std::memcpy(bytes.data() + at + before.size(), window.data(), sizeof window);
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_NE(said(path).find(words), std::string::npos) << said(path);
  }
  const std::string compression("compression\0compression\0", 24);
  const std::int32_t claimed = 0x72000000;
  std::memcpy(bytes.data() + bytes.find(compression) + compression.size(), &claimed, sizeof claimed);
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_NE(said(path).find("its attribute 'compression' states 1912602624 bytes"), std::string::npos) << said(path);
}

TEST(DensityPicture, APatternHasOneFileForEachFrame) {
  const TemporaryFolder folder;
  FoveationSettings settings;
  settings.sampling = parse_density(folder.path() + "/d.####.exr");
  write_exr(folder.path() + "/d.0002.exr", ImageGray(1, 1, 2), "R");
  write_exr(folder.path() + "/d.0010.exr", ImageGray(1, 1, 10), "R");
  EXPECT_EQ(read_density_picture(settings, 10)(0, 0), 10.0F);
  EXPECT_EQ(density_picture_files(settings),
            (std::vector<std::string>{folder.path() + "/d.0002.exr", folder.path() + "/d.0010.exr"}));
  EXPECT_NE(said(folder.path() + "/d.####.exr", 3).find("d.0003.exr"), std::string::npos);
}

TEST(DensityPicture, ModelsThatFollowAPictureNeedOne) {
  EXPECT_THROW(make_sampling_map(by_picture(), view(), std::nullopt), Error);
  EXPECT_THROW(density_image(by_picture(), view(), {0, 0, -1}), Error);
}

}  // namespace
}  // namespace gazetrace::density_picture_test
