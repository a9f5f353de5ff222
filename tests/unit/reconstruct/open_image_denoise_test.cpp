// SPDX-License-Identifier: Apache-2.0
// The library itself, where it is found: noise of known strength goes, and neither threads nor single samples of
// absurd value change what is around them.
#include "reconstruct/open_image_denoise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "gazetrace/reconstruct.hpp"

namespace gazetrace::open_image_denoise_test {
namespace {

constexpr int kSize = 96;
constexpr float kTruth = 0.5F;

class OpenImageDenoise : public testing::Test {
 protected:
  void SetUp() override {
    if (denoiser_library().path.empty()) {
      GTEST_SKIP() << "Open Image Denoise was not found; cmake/denoiser.sh brings it";
    }
  }

  // A grey wall under noise whose standard deviation is the light itself.
  static DenoiserInput noisy_wall() {
    DenoiserInput input;
    input.radiance = ImageRgb(kSize, kSize);
    input.albedo = ImageRgb(kSize, kSize, {0.5F, 0.5F, 0.5F});
    input.normal = ImageRgb(kSize, kSize, {0, 0, 1});
    input.clean = true;
    std::mt19937 random(3);
    std::exponential_distribution<float> light(1 / kTruth);
    for (Vec3f& pixel : input.radiance.pixels) {
      const float value = light(random);
      pixel = {value, value, value};
    }
    return input;
  }

  // Root mean square, relative to the truth, of all pixels but those near the middle.
  static double error_of(const ImageRgb& picture, int around_middle = 0) {
    double squares = 0;
    double pixels = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        if (std::abs(x - kSize / 2) >= around_middle || std::abs(y - kSize / 2) >= around_middle) {
          const double off = static_cast<double>(picture(x, y).y) / kTruth - 1;
          squares += off * off;
          ++pixels;
        }
      }
    }
    return std::sqrt(squares / pixels);
  }
};

TEST_F(OpenImageDenoise, TakesNoiseAway) {
  const DenoiserInput input = noisy_wall();
  EXPECT_GT(error_of(input.radiance), 0.9);
  EXPECT_LT(error_of(open_image_denoise(input, 1, DenoiserNetwork::high)), 0.1);
}

TEST_F(OpenImageDenoise, ThreadsChangeNoBit) {
  const DenoiserInput input = noisy_wall();
  EXPECT_EQ(open_image_denoise(input, 1, DenoiserNetwork::high), open_image_denoise(input, 2, DenoiserNetwork::high));
}

TEST_F(OpenImageDenoise, OneAbsurdSampleLeavesTheRestOfThePicture) {
  const double usual = error_of(open_image_denoise(noisy_wall(), 2, DenoiserNetwork::high));
  for (const float absurd :
       {1e8F, 1e30F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    DenoiserInput input = noisy_wall();
    input.radiance(kSize / 2, kSize / 2) = {absurd, absurd, absurd};
    const ImageRgb result = open_image_denoise(input, 2, DenoiserNetwork::high);
    EXPECT_LT(error_of(result, 12), 2 * usual) << absurd;
    for (const Vec3f& pixel : result.pixels) {
      ASSERT_TRUE(std::isfinite(pixel.x) && pixel.x < 20 * kTruth) << absurd;
    }
  }
}

TEST_F(OpenImageDenoise, IsDescribedForRecords) {
  const DenoiserLibrary& found = denoiser_library();
  EXPECT_TRUE(found.version.starts_with("2."));
  EXPECT_NE(denoiser_description().find(found.version), std::string::npos);
}

}  // namespace
}  // namespace gazetrace::open_image_denoise_test
