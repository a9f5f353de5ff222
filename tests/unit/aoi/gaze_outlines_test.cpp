// SPDX-License-Identifier: Apache-2.0
// Outlines of numbers in an image, against the even-odd rule at the middle of every pixel, and by hand.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <utility>

#include "gazetrace/gaze_outlines.hpp"

namespace gazetrace::gaze_outlines_test {
namespace {

using Ring = std::vector<PixelCorner>;

Image<std::uint32_t> image_of(const std::vector<std::string>& rows) {
  Image<std::uint32_t> image(static_cast<int>(rows.front().size()), static_cast<int>(rows.size()));
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const char c = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      image(x, y) = c == '.' ? 0 : static_cast<std::uint32_t>(c - '0');
    }
  }
  return image;
}

// Whether a ray from the middle of a pixel to the left crosses the rings an odd number of times.
bool holds(const OutlinePolygon& polygon, int x, int y) {
  int crossings = 0;
  for (const Ring& ring : polygon.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const PixelCorner& a = ring[i];
      const PixelCorner& b = ring[(i + 1) % ring.size()];
      crossings += a.x == b.x && a.x <= x && std::min(a.y, b.y) <= y && std::max(a.y, b.y) > y ? 1 : 0;
    }
  }
  return crossings % 2 == 1;
}

double area_of(const Ring& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const PixelCorner& a = ring[i];
    const PixelCorner& b = ring[(i + 1) % ring.size()];
    twice += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return twice / 2;
}

void expect_outlines_are_the_image(const Image<std::uint32_t>& image) {
  const auto outlines = outlines_of(image);
  Image<std::uint32_t> again(image.width_px, image.height_px);
  for (std::size_t number = 1; number < outlines.size(); ++number) {
    for (const OutlinePolygon& polygon : outlines[number]) {
      ASSERT_FALSE(polygon.rings.empty());
      for (std::size_t r = 0; r < polygon.rings.size(); ++r) {
        const Ring& ring = polygon.rings[r];
        EXPECT_EQ(area_of(ring) > 0, r == 0) << "the border is clockwise and first, holes are not";
        std::set<std::pair<int, int>> corners;
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const PixelCorner& a = ring[i];
          const PixelCorner& b = ring[(i + 1) % ring.size()];
          const PixelCorner& c = ring[(i + 2) % ring.size()];
          EXPECT_TRUE(corners.emplace(a.x, a.y).second) << "a corner is met once";
          EXPECT_NE(a.x == b.x, a.y == b.y) << "along sides of pixels";
          EXPECT_NE(a.x == b.x, b.x == c.x) << "turns at every corner";
        }
      }
      for (int y = 0; y < image.height_px; ++y) {
        for (int x = 0; x < image.width_px; ++x) {
          if (holds(polygon, x, y)) {
            EXPECT_EQ(again(x, y), 0U) << "one polygon for a pixel";
            again(x, y) = static_cast<std::uint32_t>(number);
          }
        }
      }
    }
  }
  EXPECT_EQ(again, image);
}

TEST(GazeOutlines, ByHand) {
  const auto outlines = outlines_of(image_of({"11..", "1122", "..22"}));
  ASSERT_EQ(outlines.size(), 3U);
  EXPECT_TRUE(outlines[0].empty());
  ASSERT_EQ(outlines[1].size(), 1U);
  EXPECT_EQ(outlines[1][0].rings, (std::vector<Ring>{{{2, 0}, {2, 2}, {0, 2}, {0, 0}}}));
  EXPECT_EQ(outlines[2][0].rings, (std::vector<Ring>{{{4, 1}, {4, 3}, {2, 3}, {2, 1}}}));
}

TEST(GazeOutlines, HolesAndWhatHidesAnObject) {
  // Within the hole of 1 another 1, and a 2 in front of all that cuts it apart.
  const Image<std::uint32_t> image = image_of({"1111111", "1.....1", "1.1.2.1", "1.....1", "1111111"});
  const auto outlines = outlines_of(image);
  ASSERT_EQ(outlines[1].size(), 2U);
  EXPECT_EQ(outlines[1][0].rings.size(), 2U);
  EXPECT_EQ(area_of(outlines[1][0].rings[1]), -15);
  EXPECT_EQ(outlines[1][1].rings.size(), 1U);
  expect_outlines_are_the_image(image);
  expect_outlines_are_the_image(image_of({"1121", "1121", "2222", "1121"}));
  EXPECT_EQ(outlines_of(image_of({"1121", "1121", "2222", "1121"}))[1].size(), 4U);
}

TEST(GazeOutlines, PixelsThatTouchByACorner) {
  // Two pieces; one piece whose bay touches itself; two holes that touch.
  EXPECT_EQ(outlines_of(image_of({"1.", ".1"}))[1].size(), 2U);
  for (const auto& rows : {std::vector<std::string>{"111", "1.1", "11."},
                           {"11111", "1.111", "11.11", "11111"},
                           {"1.1", "111", ".1."},
                           {"1111", "1.1.", "1111", ".1.1"}}) {
    expect_outlines_are_the_image(image_of(rows));
  }
  EXPECT_EQ(outlines_of(image_of({"11111", "1.111", "11.11", "11111"}))[1][0].rings.size(), 3U);
}

TEST(GazeOutlines, OfNoiseAreTheNoise) {
  std::mt19937 random(1);
  for (const std::uint32_t kinds : {2U, 3U, 7U}) {
    for (int turn = 0; turn < 20; ++turn) {
      Image<std::uint32_t> image(23, 17);
      for (std::uint32_t& pixel : image.pixels) {
        pixel = static_cast<std::uint32_t>(random()) % kinds;
      }
      expect_outlines_are_the_image(image);
    }
  }
  expect_outlines_are_the_image(Image<std::uint32_t>(5, 4, 3));
  EXPECT_TRUE(outlines_of(Image<std::uint32_t>(5, 4)).empty());
}

}  // namespace
}  // namespace gazetrace::gaze_outlines_test
