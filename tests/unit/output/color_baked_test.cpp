// SPDX-License-Identifier: Apache-2.0
// The baked view against the exact one.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

#include "color/baked_view.hpp"
#include "gazetrace/color.hpp"

namespace gazetrace {
namespace {

// Colours of all hues, from black to far beyond white.
std::vector<float> random_colors(std::size_t count) {
  std::mt19937 generator(3);
  std::normal_distribution<float> normal;
  std::vector<float> rgb(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const float brightness = 0.18F * std::exp2(3 * normal(generator));
    for (std::size_t c = 0; c < 3; ++c) {
      rgb[3 * i + c] = brightness * std::exp2(0.7F * normal(generator));
    }
  }
  return rgb;
}

TEST(ColorBaked, StaysWithinOneCodeValueOfTheExactView) {
  const OcioView exact(ColorSettings{});
  const BakedView baked(exact, 2);
  EXPECT_LT(baked.exact_cell_share(), 0.05);
  constexpr std::size_t kCount = 400'000;
  const std::vector<float> rgb = random_colors(kCount);
  std::vector<std::uint8_t> fast(3 * kCount);
  const std::size_t exact_pixels = baked.apply_8(rgb.data(), kCount, fast.data());
  EXPECT_LT(exact_pixels, kCount / 4);
  std::vector<std::uint8_t> slow(3 * kCount);
  std::vector<float> work = rgb;
  exact.apply_8(work.data(), kCount, slow.data());
  std::array<std::size_t, 3> by_distance{};
  for (std::size_t i = 0; i < fast.size(); ++i) {
    ++by_distance[std::min<std::size_t>(2, static_cast<std::size_t>(std::abs(fast[i] - slow[i])))];
  }
  EXPECT_EQ(by_distance[2], 0U);
  EXPECT_LT(by_distance[1], 3 * kCount / 10);
}

TEST(ColorBaked, BordersOfTheTable) {
  const OcioView exact(ColorSettings{});
  const BakedView baked(exact, 1);
  // Zero, the table's end (2^6 - 2^-6) from both sides, and the largest value there is.
  for (const float value : {0.0F, 63.98F, 63.984375F, 63.99F, 64.0F, 1e6F}) {
    for (const std::array<float, 3>& rgb : {std::array<float, 3>{value, value, value}, {value, 0, 0}, {0, 0, value}}) {
      std::array<std::uint8_t, 3> fast{};
      std::array<std::uint8_t, 3> slow{};
      baked.apply_8(rgb.data(), 1, fast.data());
      std::array<float, 3> work = rgb;
      exact.apply_8(work.data(), 1, slow.data());
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LE(std::abs(fast[c] - slow[c]), 1) << value << ' ' << c;
      }
    }
  }
}

TEST(ColorBaked, IsUsedOnlyWhereItPays) {
  const std::vector<float> rgb = random_colors(300'000);
  ImageRgb large(600, 500);
  for (std::size_t i = 0; i < large.pixels.size(); ++i) {
    large.pixels[i] = {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]};
  }
  ColorSettings exact;
  exact.precision = ViewPrecision::exact;
  ColorSettings baked;
  baked.precision = ViewPrecision::baked;
  const ColorPipeline automatic_view{ColorSettings{}};
  const ColorPipeline exact_view(exact);
  const ColorPipeline baked_view(baked);
  const auto bytes = [](const ColorPipeline& view, const ImageRgb& image, int bits, int threads) {
    return view.apply(image, 0, bits, threads).bytes;
  };
  automatic_view.prepare(large.width_px, large.height_px, 8, 2);
  EXPECT_EQ(bytes(automatic_view, large, 8, 1), bytes(baked_view, large, 8, 2));
  EXPECT_NE(bytes(automatic_view, large, 8, 1), bytes(exact_view, large, 8, 1));
  EXPECT_EQ(bytes(automatic_view, large, 16, 1), bytes(exact_view, large, 16, 1));
  ImageRgb small(60, 50);
  std::copy_n(large.pixels.begin(), small.pixels.size(), small.pixels.begin());
  EXPECT_EQ(bytes(automatic_view, small, 8, 1), bytes(exact_view, small, 8, 1));
}

}  // namespace
}  // namespace gazetrace
