// SPDX-License-Identifier: Apache-2.0
// The baked view against the exact one.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>

#include "color/baked_view.hpp"
#include "gazetrace/color.hpp"

namespace gazetrace::color_baked_test {
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
  const OcioView exact(ColorSettings{});
  const BakedView baked(exact, 2);
  const auto shown = [&](const ImageRgb& image, bool by_table) {
    std::vector<float> values;
    for (const Vec3f& pixel : image.pixels) {
      values.insert(values.end(), {pixel.x, pixel.y, pixel.z});
    }
    std::vector<std::uint8_t> bytes(values.size());
    if (by_table) {
      baked.apply_8(values.data(), image.pixels.size(), bytes.data());
    } else {
      exact.apply_8(values.data(), image.pixels.size(), bytes.data());
    }
    return bytes;
  };
  const ColorPipeline view{ColorSettings{}};
  view.prepare(large.width_px, large.height_px, 8, 2);
  EXPECT_EQ(view.apply(large, 0, 8, 1).bytes, shown(large, true));
  EXPECT_NE(view.apply(large, 0, 8, 1).bytes, shown(large, false));
  ImageRgb small(60, 50);
  std::copy_n(large.pixels.begin(), small.pixels.size(), small.pixels.begin());
  EXPECT_EQ(view.apply(small, 0, 8, 1).bytes, shown(small, false));
  std::vector<float> values(rgb.begin(), rgb.begin() + static_cast<std::ptrdiff_t>(3 * large.pixels.size()));
  std::vector<std::uint16_t> wide(values.size());
  exact.apply_16(values.data(), large.pixels.size(), wide.data());
  const std::vector<std::uint8_t> bytes_16 = view.apply(large, 0, 16, 1).bytes;
  EXPECT_EQ(std::memcmp(bytes_16.data(), wide.data(), bytes_16.size()), 0);
}

}  // namespace
}  // namespace gazetrace::color_baked_test
