// SPDX-License-Identifier: Apache-2.0
// Metrics on pictures small enough to work out by hand, and what holds for every one of them.
#include "gazetrace/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "metrics/flip_kernels.hpp"

namespace gazetrace::metrics_test {
namespace {

ImageRgb noise(int width, int height, unsigned seed, float scale = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, scale);
  ImageRgb image(width, height);
  for (Vec3f& pixel : image.pixels) {
    pixel = {uniform(random), uniform(random), uniform(random)};
  }
  return image;
}

MetricPicture both(const ImageRgb& image) {
  return {image, image};
}

MetricPicture flat(float value, int side = 180) {
  return both(ImageRgb(side, side, {value, value, value}));
}

double score(const std::string& metric, const MetricPicture& reference, const MetricPicture& test,
             const MetricSettings& settings = {}) {
  return metric_value(metric, measure(metric, reference, test, settings).mean);
}

TEST(Metrics, OnePixelByHand) {
  const MetricPicture reference = both(ImageRgb(1, 1, {1, 0.5F, 0}));
  const MetricPicture test = both(ImageRgb(1, 1, {0.5F, 0.5F, 0.25F}));
  EXPECT_DOUBLE_EQ(score("mse", reference, test), (0.25 + 0 + 0.0625) / 3);
  EXPECT_DOUBLE_EQ(score("rmse", reference, test), std::sqrt((0.25 + 0.0625) / 3));
  EXPECT_DOUBLE_EQ(score("relmse", reference, test), (0.25 / 1.01 + 0.0625 / 0.01) / 3);
  EXPECT_DOUBLE_EQ(score("smape", reference, test), (2 * 0.5 / 1.5 + 2) / 3);
  EXPECT_DOUBLE_EQ(score("psnr", reference, test), -10 * std::log10((0.25 + 0.0625) / 3));
}

// On uniform pictures only the coarsest scale's luminance factor differs from 1.
TEST(Metrics, SimilarityOfUniformPictures) {
  const double l = (2 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4);
  EXPECT_NEAR(score("ssim", flat(0.5F), flat(0.25F)), l, 1e-12);
  EXPECT_NEAR(score("ms_ssim", flat(0.5F), flat(0.25F)), std::pow(l, 0.1333), 1e-12);
}

// t = m + c (r - m) with window means that hardly move: the finest factor is (2 c + k) / (1 + c^2 + k), k = C2 / s^2.
TEST(Metrics, SimilarityOfAFainterPattern) {
  ImageRgb r(180, 180);
  ImageRgb t(180, 180);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 180; ++x) {
      const float wave = (x + y) % 2 == 0 ? 0.2F : -0.2F;
      r(x, y) = {0.5F + wave, 0.5F + wave, 0.5F + wave};
      t(x, y) = {0.5F + 0.5F * wave, 0.5F + 0.5F * wave, 0.5F + 0.5F * wave};
    }
  }
  const double s = 0.2 * 0.2;
  const double factor = (2 * 0.5 * s + 9e-4) / (s + 0.25 * s + 9e-4);
  EXPECT_NEAR(score("ssim", both(r), both(t)), factor, 1e-5);
  // Halving averages the pattern away: all other scales see uniform grey.
  EXPECT_NEAR(score("ms_ssim", both(r), both(t)), std::pow(factor, 0.0448), 1e-6);
}

TEST(Metrics, EqualPicturesHaveNoError) {
  const MetricPicture picture = both(noise(200, 180, 1));
  for (const MetricInfo& info : metrics()) {
    const double value = score(info.name, picture, picture);
    if (info.name == "psnr") {
      EXPECT_EQ(value, std::numeric_limits<double>::infinity());
    } else {
      EXPECT_NEAR(value, info.better == MetricDirection::lower ? 0 : 1, 1e-9) << info.name;
    }
  }
}

TEST(Metrics, MoreNoiseIsWorse) {
  const ImageRgb reference(200, 180, {0.4F, 0.5F, 0.6F});
  ImageRgb little = noise(200, 180, 2, 0.05F);
  ImageRgb much = noise(200, 180, 2, 0.3F);
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    little.pixels[i] += reference.pixels[i];
    much.pixels[i] += reference.pixels[i];
  }
  for (const MetricInfo& info : metrics()) {
    const double better = score(info.name, both(reference), both(little));
    const double worse = score(info.name, both(reference), both(much));
    EXPECT_TRUE(info.better == MetricDirection::lower ? better < worse : better > worse) << info.name;
  }
}

TEST(Metrics, SameBitsForAnyNumberOfThreads) {
  const MetricPicture reference = both(noise(301, 215, 3));
  const MetricPicture test = both(noise(301, 215, 4));
  for (const MetricInfo& info : metrics()) {
    MetricSettings settings;
    settings.threads = 1;
    const MetricMap one = measure(info.name, reference, test, settings);
    settings.threads = 7;
    const MetricMap seven = measure(info.name, reference, test, settings);
    EXPECT_EQ(one.mean, seven.mean) << info.name;
    EXPECT_EQ(one.values, seven.values) << info.name;
  }
}

TEST(Metrics, RefusesWhatItCannotMeasure) {
  const MetricPicture small = flat(0.5F, 8);
  const auto message = [](const std::string& metric, const MetricPicture& a, const MetricPicture& b) -> std::string {
    try {
      measure(metric, a, b, {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("fliip", small, small), testing::HasSubstr("did you mean 'flip'"));
  EXPECT_THAT(message("mse", small, flat(0.5F, 9)), testing::HasSubstr("8x8"));
  EXPECT_THAT(message("ssim", small, small), testing::HasSubstr("window"));
  EXPECT_THAT(message("ms_ssim", flat(0.5F, 100), flat(0.5F, 100)), testing::HasSubstr("176x176"));
  EXPECT_THAT(message("psnr", {small.light, {}}, small), testing::HasSubstr("code values"));
  MetricPicture broken = small;
  broken.light(3, 2).y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message("mse", small, broken), testing::HasSubstr("test: pixel 3,2"));
}

TEST(Flip, GreenAgainstBlueIsOneAtAnyDistance) {
  const MetricPicture green = both(ImageRgb(30, 20, {0, 1, 0}));
  const MetricPicture blue = both(ImageRgb(30, 20, {0, 0, 1}));
  for (const double pixels_per_degree : {5.0, 67.0, 400.0}) {
    MetricSettings settings;
    settings.pixels_per_degree = pixels_per_degree;
    EXPECT_NEAR(score("flip", green, blue, settings), 1, 1e-5) << pixels_per_degree;
  }
}

// Tiles are no part of the result: a picture shifted by a few pixels has the same map, shifted, away from the border.
// Of three pixels, a balanced first derivative is (1, 0, -1) and a second one (1/2, -1, 1/2), however narrow the
// Gaussian.
TEST(Flip, FewPixelsADegreeStillHaveEdges) {
  for (const double pixels_per_degree : {0.01, 0.3, 0.7, 2.0}) {
    const FlipKernels kernels = make_flip_kernels(pixels_per_degree);
    EXPECT_THAT(kernels.edge, testing::ElementsAre(1.0F, 0.0F, -1.0F)) << pixels_per_degree;
    EXPECT_THAT(kernels.point, testing::ElementsAre(0.5F, -1.0F, 0.5F)) << pixels_per_degree;
  }
}

TEST(Flip, TilesLeaveNoTrace) {
  const ImageRgb reference = noise(300, 170, 5);
  const ImageRgb test = noise(300, 170, 6);
  const auto cut = [](const ImageRgb& image, int x0, int y0) {
    ImageRgb part(image.width_px - x0, image.height_px - y0);
    for (int y = 0; y < part.height_px; ++y) {
      for (int x = 0; x < part.width_px; ++x) {
        part(x, y) = image(x + x0, y + y0);
      }
    }
    return part;
  };
  const ImageGray whole = flip_map(reference, test, 67);
  const ImageGray part = flip_map(cut(reference, 13, 7), cut(test, 13, 7), 67);
  for (int y = 12; y < part.height_px; ++y) {
    for (int x = 12; x < part.width_px; ++x) {
      ASSERT_EQ(part(x, y), whole(x + 13, y + 7)) << x << "," << y;
    }
  }
}

TEST(HdrFlip, ExposuresOfUnusualReferences) {
  const FlipExposures black = flip_exposures(ImageRgb(4, 4), {});
  EXPECT_EQ(black.count, 1);
  EXPECT_EQ(black.start_ev, 0);
  ImageRgb mostly_black(4, 4);
  mostly_black(1, 1) = {2, 2, 2};
  // flip-evaluator 1.7 takes no median below 2^-23: log2(2.11887232 x 2^23) = 24.0833 is its stop for such pictures.
  const FlipExposures few = flip_exposures(mostly_black, {});
  EXPECT_NEAR(few.start_ev, std::log2(2.11887232 / 2), 1e-6);
  EXPECT_NEAR(few.stop_ev, 24.083297729492188, 2e-6);  // in single precision, whose steps are 1.9e-6 there
  EXPECT_EQ(few.count, 24);
  ImageRgb dim(4, 4);
  dim(1, 1) = {1e-9F, 1e-9F, 1e-9F};
  EXPECT_EQ(flip_exposures(dim, {}).start_ev, flip_exposures(dim, {}).stop_ev);
  FlipExposureSettings one_of_many;
  one_of_many.start_ev = -1;
  one_of_many.stop_ev = 1;
  one_of_many.count = 1;
  EXPECT_THROW(flip_exposures(mostly_black, one_of_many), Error);
  one_of_many.count = 2;
  one_of_many.start_ev = 3;
  EXPECT_THROW(flip_exposures(mostly_black, one_of_many), Error);
}

TEST(HdrFlip, ExposureMapIsZeroWithoutError) {
  const ImageRgb picture = noise(40, 30, 7, 8);
  const HdrFlipMap map = hdr_flip_map(picture, picture, {-2, 2, 5}, FlipToneMapper::aces, 67);
  EXPECT_EQ(map.values, ImageGray(40, 30));
  EXPECT_EQ(map.exposure, ImageGray(40, 30));
}

TEST(MapStatistics, AgainstSortedValues) {
  std::mt19937 random(8);
  std::normal_distribution<float> normal(0.3F, 0.2F);
  ImageGray map(97, 61);
  for (float& value : map.pixels) {
    value = std::fabs(normal(random));
  }
  const MapStatistics statistics = map_statistics(map);
  std::vector<float> sorted = map.pixels;
  std::sort(sorted.begin(), sorted.end());
  double total = 0;
  for (const float value : sorted) {
    total += static_cast<double>(value);
  }
  EXPECT_NEAR(statistics.mean, total / static_cast<double>(sorted.size()), 1e-12);
  EXPECT_EQ(statistics.min, sorted.front());
  EXPECT_EQ(statistics.max, sorted.back());
  EXPECT_EQ(statistics.quantiles[0], sorted[sorted.size() * 5 / 100]);
  EXPECT_EQ(statistics.quantiles[2], sorted[sorted.size() / 2]);
  EXPECT_EQ(statistics.quantiles[4], sorted[sorted.size() * 95 / 100]);
  double running = 0;
  std::size_t quartile = 0;
  for (const float value : sorted) {
    running += static_cast<double>(value);
    while (quartile < 3 && running > 0.25 * static_cast<double>(quartile + 1) * total) {
      EXPECT_EQ(statistics.weighted_quartiles[quartile], value);
      ++quartile;
    }
  }
  for (float& value : map.pixels) {
    value = 0;
  }
  EXPECT_EQ(map_statistics(map).weighted_quartiles[1], 0);
}

TEST(MapStatistics, NegativeValuesAndMargins) {
  ImageGray map(5, 3, -9);
  map(1, 1) = -2;
  map(2, 1) = 0;
  map(3, 1) = 1;
  const MapStatistics statistics = map_statistics(map, 1);
  EXPECT_EQ(statistics.pixels, 3U);
  EXPECT_EQ(statistics.min, -2);
  EXPECT_EQ(statistics.quantiles[2], 0);
  EXPECT_DOUBLE_EQ(statistics.mean, -1.0 / 3);
}

// Values of SMPTE ST 2084 as ITU-R BT.2408 and BT.2100 print them: 58 % is 203 cd/m2, 75 % 1000, to their whole
// percents.
TEST(DisplayLight, PerceptualQuantizer) {
  EXPECT_EQ(pq_luminance(0), 0);
  EXPECT_DOUBLE_EQ(pq_luminance(1), 10000);
  EXPECT_NEAR(pq_code(203), 0.58, 0.005);
  EXPECT_NEAR(pq_code(1000), 0.75, 0.005);
  EXPECT_NEAR(pq_code(100), 0.508078, 1e-6);
  for (const double cd_m2 : {0.001, 0.1, 5.0, 99.0, 4321.0}) {
    EXPECT_NEAR(pq_luminance(pq_code(cd_m2)), cd_m2, 1e-9 * cd_m2);
  }
  EXPECT_NEAR(display_light(DisplayResponse::pq, pq_code(100), 1000), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(display_light(DisplayResponse::pq, 1, 1000), 1);
  EXPECT_DOUBLE_EQ(display_light(DisplayResponse::linear_hdr, 250, 1000), 0.25);
  EXPECT_DOUBLE_EQ(display_light(DisplayResponse::linear_hdr, 2500, 1000), 1);
}

// Absolute light is what the codes say, from 0.005 cd/m2 to the peak, and the room's light on top (section 1 of the
// metric's photometry); relative codes fill the range above black.
TEST(DisplayLight, LuminanceOfAbsoluteResponses) {
  DisplayPhotometry photometry{DisplayResponse::pq, 1000, 1e6, 10, 0.005};
  const double black = 10 / kPi * 0.005 + 1000 / 1e6;
  const auto luminance = [&](double code) {
    const auto v = static_cast<float>(code);
    return static_cast<double>(display_luminance(ImageRgb(1, 1, {v, v, v}), photometry)(0, 0));
  };
  EXPECT_NEAR(luminance(pq_code(100)), 100 + black, 0.01);
  EXPECT_NEAR(luminance(1), 1000 + black, 1e-3);
  EXPECT_NEAR(luminance(0), 0.005 + black, 1e-7);
  photometry.response = DisplayResponse::linear_hdr;
  EXPECT_NEAR(luminance(321), 321 + black, 1e-3);
  EXPECT_NEAR(luminance(-5), 0.005 + black, 1e-7);
  EXPECT_NEAR(luminance(5000), 1000 + black, 1e-3);
  photometry.response = DisplayResponse::linear;
  EXPECT_NEAR(luminance(1), 1000, 1e-3);
  EXPECT_NEAR(luminance(0), black, 1e-7);
}

TEST(ColorMaps, EndsOfTheTables) {
  EXPECT_EQ(magma(0), (std::array<std::uint8_t, 3>{0, 0, 4}));
  EXPECT_EQ(magma(2), (std::array<std::uint8_t, 3>{252, 253, 191}));
  EXPECT_EQ(viridis(0), (std::array<std::uint8_t, 3>{68, 1, 84}));
  EXPECT_EQ(viridis(1), (std::array<std::uint8_t, 3>{253, 231, 37}));
}

}  // namespace
}  // namespace gazetrace::metrics_test
