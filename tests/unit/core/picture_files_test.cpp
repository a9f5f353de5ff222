// SPDX-License-Identifier: Apache-2.0
// What the files of pictures state of them: primaries, the kinds of Radiance's pixels, segments of JPEG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/image_io.hpp"
#include "core/jpeg_file.hpp"
#include "core/primaries.hpp"
#include "core/radiance_file.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace::picture_files_test {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

void expect_near(const Vec3f& got, const Vec3f& expected, float tolerance) {
  EXPECT_NEAR(got.x, expected.x, tolerance);
  EXPECT_NEAR(got.y, expected.y, tolerance);
  EXPECT_NEAR(got.z, expected.z, tolerance);
}

// The first column of the matrix from Rec.709 to ACES2065-1 that the public ACES configurations have.
TEST(Primaries, OfAcesLeadBackToRec709) {
  const Primaries ap0{{0.7347, 0.2653}, {0, 1}, {0.0001, -0.077}, {0.32168, 0.33767}};
  const auto matrix = matrix_to_rec709(ap0);
  ASSERT_TRUE(matrix);
  expect_near(transformed(*matrix, {0.439632982F, 0.0897764430F, 0.0175411704F}), {1, 0, 0}, 1e-5F);
  expect_near(transformed(*matrix, {0.177378320F, 0.0967841284F, 0.870912277F}), {0, 0, 1}, 1e-5F);
  expect_near(transformed(*matrix, {1, 1, 1}), {1, 1, 1}, 1e-5F);
}

// IEC 61966-2-1 has X, Y and Z of the primaries.
TEST(Primaries, OfXyzAreTristimulusValues) {
  const auto matrix = matrix_to_rec709({{1, 0}, {0, 1}, {0, 0}, {1 / 3.0, 1 / 3.0}});
  ASSERT_TRUE(matrix);
  expect_near(transformed(*matrix, {0.4124F, 0.2126F, 0.0193F}), {1, 0, 0}, 1e-3F);
  expect_near(transformed(*matrix, {0.9505F, 1.0F, 1.0890F}), {1, 1, 1}, 1e-3F);
}

TEST(Primaries, OfRec709NeedNoMatrix) {
  EXPECT_FALSE(matrix_to_rec709(kRec709));
  EXPECT_FALSE(matrix_to_rec709({{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.31271, 0.32902}}));
  EXPECT_FALSE(is_space({{0.3, 0.3}, {0.4, 0.4}, {0.5, 0.5}, {0.3, 0.3}}));
}

Bytes radiance(const std::string& header, const std::string& size, const Bytes& pixels) {
  const std::string text = "#?RADIANCE\n" + header + "\n" + size + "\n";
  Bytes file(text.begin(), text.end());
  file.insert(file.end(), pixels.begin(), pixels.end());
  return file;
}

std::string refusal(const Bytes& file) {
  try {
    static_cast<void>(read_image_rgba(file, "place"));
    return "nothing was refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    return e.what();
  }
}

// Scanlines of 8 pixels and more hold each component by itself, in runs (above 128) and bytes as they are.
TEST(RadianceFile, ComponentsAreRunsAndBytes) {
  const Bytes line{2, 2, 0, 8, 136, 128, 8, 0, 16, 32, 64, 128, 64, 32, 16, 136, 0, 132, 129, 132, 130};
  const ImageRgba image = read_image_rgba(radiance("FORMAT=32-bit_rle_rgbe\n", "-Y 1 +X 8", line), "place");
  EXPECT_TRUE(image.is_linear);
  EXPECT_EQ(image.floats[0], 1.0F);
  EXPECT_EQ(image.floats[1], 0.0F);
  EXPECT_EQ(image.floats[4 * 3 + 1], 0.5F);
  EXPECT_EQ(image.floats[4 * 4], 2.0F);
}

TEST(RadianceFile, DamageIsRefused) {
  const std::string size = "-Y 1 +X 8";
  const Bytes flat(8 * 4, 100);
  EXPECT_EQ(refusal(radiance("", size, flat)), "nothing was refused");
  EXPECT_THAT(refusal(radiance("", size, {2, 2, 0, 8, 137, 1})), HasSubstr("damaged"));      // a run beyond its line
  EXPECT_THAT(refusal(radiance("", size, {2, 2, 0, 8, 0, 1})), HasSubstr("damaged"));        // a run of nothing
  EXPECT_THAT(refusal(radiance("", size, {2, 2, 0, 8, 9, 1, 1})), HasSubstr("damaged"));     // bytes beyond it
  EXPECT_THAT(refusal(radiance("", size, {1, 1, 1, 8})), HasSubstr("damaged"));              // nothing to repeat
  EXPECT_THAT(refusal(radiance("", size, {9, 9, 9, 9, 1, 1, 1, 8})), HasSubstr("damaged"));  // repeated beyond it
  EXPECT_THAT(refusal(radiance("", size, Bytes(31, 100))), HasSubstr("damaged"));
  for (const char* const wrong :
       {"-Y 1", "-Y 1 -Y 8", "-Y 0 +X 8", "-Y one +X 8", "Y1 1 +X 8", "-Y 1 +X 99999999999"}) {
    EXPECT_THAT(refusal(radiance("", wrong, flat)), HasSubstr("damaged")) << wrong;
  }
  for (const char* const wrong :
       {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=x\n", "COLORCORR=1 1\n", "PRIMARIES=1 2\n"}) {
    EXPECT_THAT(refusal(radiance(wrong, size, flat)), HasSubstr("damaged")) << wrong;
  }
  EXPECT_THAT(refusal(radiance("PRIMARIES=.3 .3 .4 .4 .5 .5 .3 .3\n", size, flat)), HasSubstr("primaries"));
  // Programs that know of none write zeros.
  EXPECT_EQ(refusal(radiance("PRIMARIES=0 0 0 0 0 0 0 0\n", size, flat)), "nothing was refused");
}

Bytes jpeg() {
  Bytes rgb(3 * 16 * 16);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgb[i] = static_cast<std::uint8_t>(i * 7);
  }
  EncodeOptions options;
  options.note = "a note";
  return encode_image("a.jpg", 16, 16, 8, rgb, options);
}

Bytes inserted(const Bytes& file, std::size_t at, const Bytes& segment, int times) {
  Bytes out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(at));
  for (int i = 0; i < times; ++i) {
    out.insert(out.end(), segment.begin(), segment.end());
  }
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(at), file.end());
  return out;
}

// libjpeg walks a list of them for each: 100 kB took seconds.
TEST(JpegFile, SegmentsThatDoNotConcernThePictureAreLeftOut) {
  const Bytes file = jpeg();
  const Bytes essential = essential_jpeg(file, "place");
  EXPECT_THAT(std::string(essential.begin(), essential.end()), HasSubstr("a note"));
  for (const Bytes& segment : {Bytes{0xFF, 0xFE, 0, 2}, Bytes{0xFF, 0xE3, 0, 3, 9}, Bytes{0xFF, 0xFF, 0xED, 0, 2}}) {
    EXPECT_EQ(essential_jpeg(inserted(file, 2, segment, 500), "place"), essential);
    EXPECT_EQ(essential_jpeg(inserted(file, file.size() - 2, segment, 500), "place"), essential);
  }
  EXPECT_EQ(read_image_rgba(file, "place").bytes, read_image_rgba(essential, "place").bytes);
  EXPECT_THAT(refusal(inserted(file, file.size() - 2, {0xFF, 0xDA, 0, 2}, 101)), HasSubstr("scans"));
  // Whatever is cut, the copy is no longer than the file.
  for (std::size_t length = 0; length <= file.size(); ++length) {
    EXPECT_LE(essential_jpeg(std::span(file).first(length), "place").size(), length);
  }
}

}  // namespace
}  // namespace gazetrace::picture_files_test
