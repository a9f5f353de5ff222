// SPDX-License-Identifier: Apache-2.0
// Replicas of noise, from pictures whose noise is known.
#include "pipeline/replica_noise.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "gaze/counter_random.hpp"

namespace gazetrace {
namespace {

constexpr int kSide = 96;
constexpr float kLight = 10;

ImageRgb even_light() {
  return {kSide, kSide, {kLight, kLight, kLight}};
}

// White noise of this standard deviation, the same in all channels.
ImageRgb noisy_light(std::uint64_t stream, double sigma) {
  ImageRgb picture = even_light();
  const CounterRandom random(1, stream);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const auto value = static_cast<float>(sigma * random.normals(i, 0).x);
    picture.pixels[i] += {value, value, value};
  }
  return picture;
}

ReplicaNoise white(double sigma) {
  return {{noisy_light(1, sigma), noisy_light(2, sigma), noisy_light(3, sigma), noisy_light(4, sigma)}, 1};
}

// Mean square of what a picture has beside even light, and how alike neighbours are in it, from -1 to 1.
struct Error {
  double power = 0, alike = 0;
};
Error error_of(const ImageRgb& picture) {
  Error error;
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 0; x + 1 < kSide; ++x) {
      const double here = static_cast<double>(picture(x, y).x) - kLight;
      error.power += here * here;
      error.alike += here * 0.5 * (static_cast<double>(picture(x + 1, y).x) + picture(x, y + 1).x - 2 * kLight);
    }
  }
  error.alike /= error.power;
  error.power /= (kSide - 1) * (kSide - 1);
  return error;
}

// 9025 normal numbers: their variance is known within 1.5 %, one standard error; five are allowed.
constexpr double kFiveErrors = 0.075;

TEST(ReplicaNoise, HasThePowerOfTheMeanOfSoManyFrames) {
  const ReplicaNoise noise = white(1);
  for (const std::size_t count : {1U, 2U, 7U, 23U}) {
    for (const std::size_t first : {1U, 5U}) {
      const Error error = error_of(noise.noisy(even_light(), 0.5, {first, count}));
      EXPECT_NEAR(error.power * static_cast<double>(count) / 0.5, 1, kFiveErrors) << count << " from " << first;
      EXPECT_NEAR(error.alike, 0, kFiveErrors) << count << " from " << first;
    }
  }
}

// Two means of 20 frames of which 15 are the same agree by r = 3/4. Here there are but three directions, and the cosine
// between two normal vectors of three dimensions is on average r (2/3) (Gamma(2) / Gamma(3/2))^2 F(1/2, 1/2; 5/2; r^2),
// which is 0.681 (Fisher 1915, of the correlation of samples).
TEST(ReplicaNoise, ChangesFromFrameToFrameAsRunningMeansDo) {
  const ReplicaNoise noise = white(1);
  double agreement = 0;
  constexpr std::size_t kPairs = 200;
  for (std::size_t first = 1; first <= kPairs; ++first) {
    const ImageRgb a = noise.noisy(even_light(), 1, {10 * first, 20});
    const ImageRgb b = noise.noisy(even_light(), 1, {10 * first + 5, 20});
    double product = 0;
    double power = 0;
    for (std::size_t i = 0; i < a.pixels.size(); i += 97) {
      const double in_a = static_cast<double>(a.pixels[i].x) - kLight;
      const double in_b = static_cast<double>(b.pixels[i].x) - kLight;
      product += in_a * in_b;
      power += 0.5 * (in_a * in_a + in_b * in_b);
    }
    agreement += product / power / kPairs;
  }
  EXPECT_NEAR(agreement, 0.681, 0.05);
}

TEST(ReplicaNoise, DividesWhatOneRenderingAloneHasSeen) {
  std::array<ImageRgb, ReplicaNoise::kRenderings> pictures{noisy_light(1, 0.01), noisy_light(2, 0.01),
                                                           noisy_light(3, 0.01), noisy_light(4, 0.01)};
  constexpr float kSpeck = 5;
  constexpr int kApart = 12;
  int specks = 0;
  for (int y = 6; y < kSide; y += kApart) {
    for (int x = 6; x < kSide; x += kApart) {
      pictures.at(static_cast<std::size_t>(specks++) % pictures.size())(x, y) += {kSpeck, kSpeck, kSpeck};
    }
  }
  ReplicaNoise noise(pictures, 1);
  const ImageRgb before = noise.noisy(even_light(), 1, {1, 1});
  noise.divide(16);
  const ImageRgb after = noise.noisy(even_light(), 1, {1, 1});
  // Of the sixteen parts of a speck each has a quarter of its light, so that fourth powers are a sixteenth of what they
  // were, and a little more where two parts fall together.
  const auto fourth_powers = [](const ImageRgb& picture) {
    double sum = 0;
    for (const Vec3f& pixel : picture.pixels) {
      sum += std::pow(static_cast<double>(pixel.x) - kLight, 4);
    }
    return sum;
  };
  EXPECT_LT(fourth_powers(after), 0.25 * fourth_powers(before));
  // 64 specks become about 1024, whose number is known within 3 %.
  EXPECT_NEAR(error_of(after).power / error_of(before).power, 1, 0.16);
}

TEST(ReplicaNoise, KeepsInItsPlaceWhatAllRenderingsSee) {
  std::array<ImageRgb, ReplicaNoise::kRenderings> pictures{even_light(), even_light(), even_light(), even_light()};
  // An edge whose pixels differ in all of them.
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const CounterRandom random(2, k);
    for (int y = 0; y < kSide; ++y) {
      const auto light = static_cast<float>(kLight * random.uniform(static_cast<std::uint64_t>(y), 0));
      pictures.at(k)(kSide / 2, y) = {light, light, light};
    }
  }
  ReplicaNoise noise(pictures, 1);
  const ImageRgb before = noise.noisy(even_light(), 1, {3, 1});
  noise.divide(16);
  const ImageRgb after = noise.noisy(even_light(), 1, {3, 1});
  double moved = 0;
  double power = 0;
  for (std::size_t i = 0; i < before.pixels.size(); ++i) {
    moved += std::pow(static_cast<double>(after.pixels[i].x - before.pixels[i].x), 2);
    power += std::pow(static_cast<double>(before.pixels[i].x) - kLight, 2);
  }
  EXPECT_LT(moved, 0.05 * power);
}

}  // namespace
}  // namespace gazetrace
