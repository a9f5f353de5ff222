// SPDX-License-Identifier: Apache-2.0
// Pixels that an edge may cross, against the definition of Guides::edge_rays written down pixel by pixel.
#include "trace/guides/crossed_pixels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gazetrace::crossed_pixels_test {
namespace {

struct View {
  Guides guides;
  Image<RoughNormal> smooth;
};

// Few surfaces in long runs, so that most neighbours are alike and each rule is what decides somewhere.
View random_view(int width, int height, bool perspective, unsigned seed) {
  std::mt19937 random(seed);
  const auto seldom = [&](unsigned one_in) { return random() % one_in == 0; };
  View view;
  view.guides.camera.perspective = perspective;
  view.guides.depth_m = ImageGray(width, height);
  view.guides.object = Image<std::uint32_t>(width, height);
  view.guides.material = Image<std::uint32_t>(width, height);
  view.guides.kind = Image<SurfaceKind>(width, height);
  view.smooth = Image<RoughNormal>(width, height);
  for (std::size_t i = 0; i < view.smooth.pixels.size(); ++i) {
    const bool miss = seldom(30);
    view.guides.kind.pixels[i] = miss ? SurfaceKind::miss : seldom(40) ? SurfaceKind::glossy : SurfaceKind::diffuse;
    view.guides.object.pixels[i] = miss ? 0 : 1 + (seldom(40) ? 1U : 0U);
    view.guides.material.pixels[i] = miss ? 0 : 1 + (seldom(40) ? 1U : 0U);
    const float depth_m = 3 + (seldom(30) ? 0.5F : 0.0F);
    view.guides.depth_m.pixels[i] = miss ? std::numeric_limits<float>::infinity() : depth_m;
    const float turn = seldom(40) ? 0.6F : 0.0F;
    view.smooth.pixels[i] = miss ? RoughNormal{} : rough_normal({std::sin(turn), 0, std::cos(turn)});
  }
  return view;
}

bool differ(const View& view, int ax, int ay, int bx, int by) {
  const Guides& g = view.guides;
  if (bx < 0 || by < 0 || bx >= g.kind.width_px || by >= g.kind.height_px) {
    return false;
  }
  return g.object(ax, ay) != g.object(bx, by) || g.material(ax, ay) != g.material(bx, by) ||
         g.kind(ax, ay) != g.kind(bx, by) ||
         (g.kind(ax, ay) != SurfaceKind::miss && facing(view.smooth(ax, ay), view.smooth(bx, by)) < kEdgeNormal);
}

bool off_line(const View& view, int x, int y, int dx, int dy) {
  const Guides& g = view.guides;
  if (x - dx < 0 || y - dy < 0 || x + dx >= g.kind.width_px || y + dy >= g.kind.height_px) {
    return false;
  }
  const auto linear = [&](int px, int py) {
    return g.camera.perspective ? 1.0F / g.depth_m(px, py) : g.depth_m(px, py);
  };
  return std::fabs(linear(x - dx, y - dy) + linear(x + dx, y + dy) - 2 * linear(x, y)) >
         0.02F * std::fabs(linear(x, y));
}

bool expected(const View& view, int x, int y) {
  return differ(view, x, y, x - 1, y) || differ(view, x, y, x + 1, y) || differ(view, x, y, x, y - 1) ||
         differ(view, x, y, x, y + 1) ||
         (view.guides.kind(x, y) != SurfaceKind::miss && (off_line(view, x, y, 1, 0) || off_line(view, x, y, 0, 1)));
}

// Whatever row it starts from, and for frames of a pixel, a row, a column.
TEST(CrossedPixels, AreThoseOfTheDefinition) {
  struct Size {
    int width, height;
  };
  std::size_t found = 0;
  std::size_t all = 0;
  for (const Size size : {Size{1, 1}, Size{1, 40}, Size{2, 7}, Size{53, 1}, Size{67, 40}}) {
    for (const bool perspective : {true, false}) {
      for (unsigned seed = 0; seed < 4; ++seed) {
        const View view = random_view(size.width, size.height, perspective, seed);
        for (const int first : {0, 1, size.height / 2, size.height - 1}) {
          if (first >= size.height) {
            continue;
          }
          CrossedPixels pixels(view.guides, view.smooth, first);
          for (int y = first; y < size.height; ++y) {
            const std::vector<std::uint8_t>& row = pixels.next_row();
            for (int x = 0; x < size.width; ++x) {
              ASSERT_EQ(row[static_cast<std::size_t>(x)] != 0, expected(view, x, y))
                  << size.width << 'x' << size.height << " from row " << first << ": " << x << ',' << y;
              found += row[static_cast<std::size_t>(x)];
              ++all;
            }
          }
        }
      }
    }
  }
  // Neither nearly none nor nearly all.
  EXPECT_GT(found, all / 5);
  EXPECT_LT(found, all * 4 / 5);
}

}  // namespace
}  // namespace gazetrace::crossed_pixels_test
