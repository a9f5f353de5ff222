// SPDX-License-Identifier: Apache-2.0
// The parts of the model of visible error against sums over random numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "gazetrace/color.hpp"
#include "metrics/band_sensitivity.hpp"
#include "metrics/masking.hpp"
#include "metrics/pyramid.hpp"
#include "metrics/temporal_channels.hpp"
#include "support/visible_noise.hpp"
#include "visible/channel_gain.hpp"
#include "visible/masked_moment.hpp"
#include "visible/pyramid_rows.hpp"
#include "visible/variance_pyramid.hpp"

namespace gazetrace::visible_parts_test {
namespace {

TEST(MaskedMoment, AbsoluteMomentsOfANormal) {
  EXPECT_NEAR(absolute_moment(0), 1, 1e-12);
  EXPECT_NEAR(absolute_moment(1), std::sqrt(2 / kPi), 1e-12);
  EXPECT_NEAR(absolute_moment(2), 1, 1e-12);
  EXPECT_NEAR(absolute_moment(4), 3, 1e-12);
}

TEST(MaskedMoment, IsTheMeanOverRandomErrors) {
  constexpr int kCount = 200000;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  std::vector<double> z(kCount);
  for (double& value : z) {
    value = normal(engine);
  }
  for (const bool is_sustained : {true, false}) {
    const MaskedMoments& table = is_sustained ? MaskedMoments::sustained() : MaskedMoments::transient();
    const float exponent = is_sustained ? kMaskSustained : kMaskTransient;
    for (const double u : {0.0, 3.0, 13.0, -40.0, 170.0, 2000.0}) {
      for (const double s : {0.13, 1.1, 5.0, 23.0, 90.0}) {
        double sum = 0;
        double squares = 0;
        for (const double value : z) {
          const double moment = std::pow(static_cast<double>(masked_difference(static_cast<float>(u + s * value),
                                                                               static_cast<float>(u), exponent)),
                                         kPoolSpace);
          sum += moment;
          squares += moment * moment;
        }
        const double mean = sum / kCount;
        const double error = std::sqrt((squares / kCount - mean * mean) / kCount);
        const auto predicted = static_cast<double>(table(static_cast<float>(u), static_cast<float>(s)));
        EXPECT_NEAR(predicted, mean, 0.03 * mean + 4 * error) << u << " " << s << (is_sustained ? "" : " transient");
      }
    }
  }
  EXPECT_EQ(MaskedMoments::sustained()(5, 0), 0);
}

TEST(ChannelGain, IsTheVarianceOfFilteredNoise) {
  for (const double fps : {24.0, 60.0}) {
    const TemporalFilters filters = temporal_filters(fps);
    for (const double correlation : {0.0, 0.7, 1.0}) {
      std::mt19937 engine(11);
      std::normal_distribution<double> normal;
      constexpr int kRuns = 40000;
      double sustained = 0;
      double transient = 0;
      for (int run = 0; run < kRuns; ++run) {
        double value = normal(engine);
        double s = 0;
        double t = 0;
        for (std::size_t i = 0; i < filters.sustained.size(); ++i) {
          s += filters.sustained[i] * value;
          t += filters.transient[i] * value;
          value = correlation * value + std::sqrt(1 - correlation * correlation) * normal(engine);
        }
        sustained += s * s / kRuns;
        transient += t * t / kRuns;
      }
      const ChannelGains gains = channel_gains(fps, correlation, {});
      const double relative = 4 * std::sqrt(2.0 / kRuns);
      EXPECT_NEAR(gains.variance[0], sustained, relative * sustained) << fps << " " << correlation;
      EXPECT_NEAR(gains.variance[1], transient, relative * transient + 1e-12) << fps << " " << correlation;
    }
  }
  // The first frame of a clip has stood still before.
  const ChannelGains first = channel_gains(24, 0, 0);
  EXPECT_NEAR(first.variance[0], 1, 1e-12);
  EXPECT_NEAR(first.variance[1], first.standing[1] * first.standing[1], 1e-12);
  EXPECT_EQ(channel_gains(24, 0, 100).variance, channel_gains(24, 0, {}).variance);
}

// At every place of small pictures, with borders of both parities: the variance over many pictures of noise.
TEST(PyramidRows, AreTheVariancesOfNoise) {
  for (const auto& [width, height, block] : {std::array{22, 13, 1}, std::array{13, 22, 1}, std::array{16, 16, 3}}) {
    constexpr std::size_t kLevels = 3;
    constexpr int kRuns = 4000;
    const std::vector<LevelRows> columns = pyramid_rows(height, kLevels);
    std::vector<bool> odd_rule;
    for (const LevelRows& level : columns) {
      odd_rule.push_back(level.level.size() % 2 == 1);
    }
    const std::vector<LevelRows> rows = pyramid_rows(width, kLevels, odd_rule);
    std::array<ImageGray, kLevels> sum;
    for (int run = 0; run < kRuns; ++run) {
      ImageGray level = block_noise(width, height, block, static_cast<unsigned>(run));
      for (ImageGray& of_level : sum) {
        const ImageGray coarse = halved(level, true, 1);
        const ImageGray blurred = doubled(coarse, level.width_px, level.height_px, 1);
        if (of_level.empty()) {
          of_level = ImageGray(level.width_px, level.height_px);
        }
        for (std::size_t i = 0; i < level.pixels.size(); ++i) {
          const float value = level.pixels[i] - blurred.pixels[i];
          of_level.pixels[i] += value * value / kRuns;
        }
        level = coarse;
      }
    }
    for (std::size_t b = 0; b < kLevels; ++b) {
      const NoiseSums along_x = noise_sums(rows[b], block);
      const NoiseSums along_y = noise_sums(columns[b], block);
      for (int y = 0; y < sum[b].height_px; ++y) {
        for (int x = 0; x < sum[b].width_px; ++x) {
          const float expected =
              noise_variance(along_x, along_y, static_cast<std::size_t>(x), static_cast<std::size_t>(y));
          EXPECT_NEAR(sum[b](x, y), expected, 5 * std::sqrt(2.0 / kRuns) * static_cast<double>(expected))
              << width << "x" << height << " band " << b << " at " << x << "," << y;
        }
      }
    }
  }
}

TEST(VariancePyramid, KeepsAnEvenVariance) {
  for (const auto& [width, height] : {std::pair{7, 6}, {6, 7}, {1, 9}}) {
    for (const float value : halved_variance(ImageGray(width, height, 3.0F), 1).pixels) {
      EXPECT_NEAR(value, 3, 1e-5);
    }
  }
}

TEST(DisplayCurves, LinearDisplay) {
  const DisplayPhotometry photometry{DisplayResponse::linear, 200, 1000, 0, 0};  // black 0.2
  const DisplayCurve curve = linear_display_curve(photometry, 1);
  EXPECT_NEAR(curve(0), 0.2, 1e-6);
  EXPECT_NEAR(curve(-1), 0.2, 1e-6);
  EXPECT_NEAR(curve(0.1F), 0.2 + 199.8 * 0.2, 1e-4);
  EXPECT_NEAR(curve(1e-7F), 0.2 + 199.8 * 2e-7, 1e-6);
  EXPECT_NEAR(curve(3), 200, 1e-4);
  EXPECT_NEAR(curve(1e30F), 200, 1e-4);
}

// A grey through the view and the display, computed apart at one luminance.
TEST(DisplayCurves, ViewIsTheColorPipelines) {
  const ColorPipeline color{ColorSettings{}};
  const DisplayPhotometry photometry;
  const double ev = 0.7;
  const DisplayCurve curve = view_display_curve(color, photometry, ev);
  for (const float light : {0.01F, 0.18F, 0.9F, 5.0F}) {
    const DisplayImage shown = color.apply(ImageRgb(1, 1, {light, light, light}), ev, 8, 1);
    const auto code = static_cast<float>(shown.bytes[1]) / 255.0F;
    const double expected = display_luminance(ImageRgb(1, 1, {code, code, code}), photometry, 1)(0, 0);
    EXPECT_NEAR(curve(light), expected, 0.01 * expected + 0.02) << light;  // 8-bit codes
  }
  float before = 0;
  for (float light = 1e-6F; light < 1e6F; light *= 1.1F) {
    EXPECT_GE(curve(light), before);
    before = curve(light);
  }
}

ImageGray random_positive(int width_px, int height_px, unsigned seed) {
  ImageGray image = white_noise(width_px, height_px, seed);
  for (float& value : image.pixels) {
    value = std::exp(value);
  }
  return image;
}

double pooled(const ImageGray& weights, const ImageGray& variance, const ImageGray& rates) {
  double sum = 0;
  for (std::size_t i = 0; i < rates.pixels.size(); ++i) {
    const double w = static_cast<double>(weights.pixels[i]);
    sum += std::pow(w * w * static_cast<double>(variance.pixels[i]) / static_cast<double>(rates.pixels[i]),
                    kVisiblePooling / 2);
  }
  return sum / static_cast<double>(rates.pixels.size());
}

TEST(VisibleAllocation, NoOtherRatesOfTheSameSumAreBetter) {
  const ImageGray weights = random_positive(40, 30, 1);
  const ImageGray variance = random_positive(40, 30, 2);
  const ImageGray best = visible_allocation(weights, variance);
  double sum = 0;
  for (const float rate : best.pixels) {
    sum += static_cast<double>(rate);
    EXPECT_GE(rate, kLeastAllocation);
  }
  EXPECT_NEAR(sum / static_cast<double>(best.pixels.size()), 1, 1e-5);
  const double least = pooled(weights, variance, best);
  for (unsigned seed = 10; seed < 30; ++seed) {
    ImageGray other = best;
    const ImageGray change = white_noise(40, 30, seed);
    double total = 0;
    for (std::size_t i = 0; i < other.pixels.size(); ++i) {
      other.pixels[i] *= std::exp(0.2F * change.pixels[i]);
      total += static_cast<double>(other.pixels[i]);
    }
    for (float& rate : other.pixels) {
      rate *= static_cast<float>(sum / total);
    }
    EXPECT_GT(pooled(weights, variance, other), least);
  }
  // A uniform rate needs this many times the samples.
  const double gain = allocation_gain(weights, variance);
  EXPECT_NEAR(pooled(weights, variance, ImageGray(40, 30, static_cast<float>(gain))), least, 2e-3 * least);
  EXPECT_GT(gain, 1.5);
  // Two kinds of places, in closed form: e = 1 and 2 on half of the picture each.
  ImageGray two(2, 1, 1.0F);
  two(1, 0) = 2;
  const ImageGray ones(2, 1, 1.0F);
  const ImageGray rates = visible_allocation(two, ones);
  EXPECT_NEAR(rates(1, 0) / rates(0, 0), std::pow(2, kVisiblePooling / (1 + kVisiblePooling / 2)), 1e-3);
}

TEST(VisibleAllocation, HostileValuesCountAsNothing) {
  ImageGray variance(4, 4, 1.0F);
  variance(0, 0) = std::numeric_limits<float>::quiet_NaN();
  variance(1, 0) = std::numeric_limits<float>::infinity();
  variance(2, 0) = -1;
  const ImageGray weights(4, 4, 2.0F);
  const ImageGray rates = visible_allocation(weights, variance);
  for (const float rate : rates.pixels) {
    EXPECT_TRUE(std::isfinite(rate) && rate > 0);
  }
  EXPECT_NEAR(rates(0, 0), kLeastAllocation, 1e-9);
  EXPECT_EQ(visible_allocation(weights, ImageGray(4, 4)), ImageGray(4, 4, 1.0F));
  EXPECT_EQ(allocation_gain(weights, ImageGray(4, 4)), 1);
}

}  // namespace
}  // namespace gazetrace::visible_parts_test
