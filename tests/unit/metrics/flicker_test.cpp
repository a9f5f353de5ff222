// SPDX-License-Identifier: Apache-2.0
// Flicker of known contrast and frequency, and what the metric says it cannot see.
#include "gazetrace/flicker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"
#include "metrics/contrast_sensitivity.hpp"
#include "metrics/sliding_spectrum.hpp"

namespace gazetrace::flicker_test {
namespace {

constexpr int kWidth = 300;
constexpr int kHeight = 120;
constexpr double kPixelsPerDegree = 16;  // cells of 2, 4, 8 and 16 pixels
constexpr double kLuminance = 50;

PlanarView view() {
  const double step = 1 / (kPixelsPerDegree * kDegPerRad);
  return {-step * kWidth / 2, step * kHeight / 2, step, step, kWidth, kHeight};
}

ImageGray uniform(double luminance) {
  return {kWidth, kHeight, static_cast<float>(luminance)};
}

const Vec2d kGaze{40.5, 60.5};

// The map after `seconds`, of uniform frames whose luminance is a function of the frame.
std::optional<ImageGray> flicker_of(double fps, int frames, const std::function<double(int)>& reference,
                                    const std::function<double(int)>& test, int threads = 1) {
  FlickerMeter meter({view(), fps, threads});
  std::optional<ImageGray> map;
  for (int i = 0; i < frames; ++i) {
    const std::optional<Vec2d> gaze = i + 1 < frames ? std::nullopt : std::optional(kGaze);
    map = meter.add(uniform(reference(i)), uniform(test(i)), gaze);
  }
  return map;
}

double still(int /*frame*/) {
  return kLuminance;
}

std::function<double(int)> wave(double contrast, double hz, double fps) {
  return [=](int frame) { return kLuminance * (1 + contrast * std::sin(2 * kPi * hz * frame / fps + 0.3)); };
}

// The formula of the header; `value` is for one size of cells.
double expected_at(int x, int y, const std::function<double(double rho_cpd, double eccentricity_deg)>& value) {
  const Vec3d gaze = view().direction(kGaze.x, kGaze.y);
  double most = 0;
  for (const int cell : {2, 4, 8, 16}) {
    const double middle_x = std::min<double>((x / cell + 0.5) * cell, kWidth);
    const double middle_y = std::min<double>((y / cell + 0.5) * cell, kHeight);
    most = std::max(most, value(kPixelsPerDegree / (2 * cell), eccentricity_deg(view(), gaze, middle_x, middle_y)));
  }
  return most;
}

double squared_sensitivity(double rho_cpd, double hz, double eccentricity_deg) {
  const double s = contrast_sensitivity(rho_cpd, hz, kLuminance, eccentricity_deg);
  return s * s;
}

// Bilinear interpolation of the sensitivity's logarithm is all that lies between.
constexpr double kRelativeLimit = 0.01;

// The window spreads the power over three frequencies. (Next to half the frame rate it depends on the phase.)
TEST(Flicker, SinusoidOfKnownContrastAndFrequency) {
  for (const double fps : {24.0, 60.0, 90.0}) {
    for (const double hz : {2.0, 5.0, 10.0}) {
      constexpr double kContrast = 0.02;
      const ImageGray map = *flicker_of(fps, static_cast<int>(3 * fps), still, wave(kContrast, hz, fps));
      for (const auto& [x, y] : {std::pair{40, 60}, {90, 20}, {200, 110}, {299, 0}}) {
        const double expected = expected_at(x, y, [&](double rho, double e) {
          return kContrast * kContrast *
                 (2.0 / 3 * squared_sensitivity(rho, hz, e) +
                  1.0 / 6 * (squared_sensitivity(rho, hz - 1, e) + squared_sensitivity(rho, hz + 1, e)));
        });
        const auto value = static_cast<double>(map(x, y));
        EXPECT_NEAR(value, expected, kRelativeLimit * expected) << fps << " fps, " << hz << " Hz at " << x << "," << y;
        EXPECT_GT(value, 0);
      }
    }
  }
}

TEST(Flicker, EveryOtherFrameIsHalfTheFrameRate) {
  constexpr double kContrast = 0.05;
  const auto alternating = [](int frame) { return kLuminance * (1 + (frame % 2 == 0 ? kContrast : -kContrast)); };
  const ImageGray map = *flicker_of(24, 48, still, alternating);
  const double expected = expected_at(40, 60, [&](double rho, double e) {
    return 2 * kContrast * kContrast *
           (2.0 / 3 * squared_sensitivity(rho, 12, e) + 1.0 / 3 * squared_sensitivity(rho, 11, e));
  });
  EXPECT_NEAR(static_cast<double>(map(40, 60)), expected, kRelativeLimit * expected);
}

// Power adds: what the reference has is taken off, and what it has more is no flicker of the test.
TEST(Flicker, OnlyTheExcessCounts) {
  const ImageGray alone = *flicker_of(30, 60, still, wave(0.03, 6, 30));
  const ImageGray more = *flicker_of(30, 60, wave(0.04, 6, 30), wave(0.05, 6, 30));
  EXPECT_NEAR(static_cast<double>(more(40, 60)), static_cast<double>(alone(40, 60)),
              1e-4 * static_cast<double>(alone(40, 60)));
  EXPECT_EQ(*flicker_of(30, 60, wave(0.04, 6, 30), wave(0.04, 6, 30)), uniform(0));
  EXPECT_EQ(*flicker_of(30, 60, wave(0.05, 6, 30), wave(0.04, 6, 30)), uniform(0));
}

// A frozen history reads 0 and says nothing of being wrong; the bias beside it does.
TEST(Flicker, FrozenHistoryReadsZeroAndTheBiasBesideItDoesNot) {
  EXPECT_EQ(*flicker_of(24, 48, wave(0.2, 3, 24), [](int) { return 2 * kLuminance; }), uniform(0));
  ComparisonSettings settings;
  settings.metrics = {"flicker", "temporal_bias"};
  settings.view = view();
  settings.frames_per_second = 24;
  settings.photometry = {DisplayResponse::linear, 100, 1e9, 0, 0};
  settings.metric.threads = 1;
  Comparison comparison(settings, kWidth, kHeight);
  for (int i = 0; i < 30; ++i) {
    FramePair pair;
    pair.frame = i;
    const auto light = static_cast<float>(wave(0.2, 3, 24)(i) / 100);
    pair.reference.code = ImageRgb(kWidth, kHeight, {light, light, light});
    pair.test.code = ImageRgb(kWidth, kHeight, {0.75F, 0.75F, 0.75F});
    pair.gaze_px = kGaze;
    pair.gaze_class = GazeClass::fixation;
    const FrameScores scores = comparison.add(pair);
    EXPECT_EQ(scores.scores[0].value.has_value(), i >= 23) << i;
    EXPECT_EQ(scores.scores[1].value.has_value(), i >= 23) << i;
  }
  const SequenceScores all = comparison.summary().front();
  EXPECT_EQ(*all.scores[0].value, 0);
  EXPECT_NEAR(*all.scores[1].value, 0.5, 1e-5);  // 75 against a mean of 50
  EXPECT_EQ(all.scored_frames, (std::vector<std::size_t>{7, 7}));
}

// Slower than the window: a fade of 4 s counts for less than a hundredth of the same contrast at 5 Hz.
TEST(Flicker, WhatIsSlowerThanASecondHardlyCounts) {
  const double fast = static_cast<double>((*flicker_of(60, 240, still, wave(0.1, 5, 60)))(40, 60));
  const double slow = static_cast<double>((*flicker_of(60, 240, still, wave(0.1, 0.25, 60)))(40, 60));
  EXPECT_LT(slow, 0.05 * fast);
}

TEST(Flicker, NeedsAWholeSecondAndGaze) {
  EXPECT_FALSE(flicker_of(24, 23, still, wave(0.1, 5, 24)));
  EXPECT_TRUE(flicker_of(24, 24, still, wave(0.1, 5, 24)));
  FlickerMeter meter({view(), 4, 1});
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(meter.add(uniform(1), uniform(2), std::nullopt));
  }
  EXPECT_TRUE(meter.add(uniform(1), uniform(2), kGaze));
  EXPECT_THROW(meter.add(ImageGray(3, 3), ImageGray(3, 3), kGaze), Error);
  EXPECT_THROW(FlickerMeter({view(), 3, 1}), Error);
  EXPECT_THROW(FlickerMeter({view(), 0, 1}), Error);
  EXPECT_THROW(FlickerMeter({view(), std::nan(""), 1}), Error);
}

TEST(Flicker, SameBitsForAnyNumberOfThreads) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> luminance(1, 100);
  FlickerMeter one({view(), 10, 1});
  FlickerMeter many({view(), 10, 5});
  for (int i = 0; i < 12; ++i) {
    ImageGray reference = uniform(0);
    ImageGray test = uniform(0);
    for (std::size_t p = 0; p < test.pixels.size(); ++p) {
      reference.pixels[p] = luminance(random);
      test.pixels[p] = luminance(random);
    }
    EXPECT_EQ(one.add(reference, test, kGaze), many.add(reference, test, kGaze));
  }
}

// Where the flicker is, and the less of it the farther from the gaze.
TEST(Flicker, LiesWhereItIsAndFallsOffWithEccentricity) {
  const auto patch_at = [](int left) {
    FlickerMeter meter({view(), 24, 1});
    std::optional<ImageGray> map;
    for (int i = 0; i < 24; ++i) {
      ImageGray test = uniform(kLuminance);
      for (int y = 60; y < 62; ++y) {
        for (int x = left; x < left + 2; ++x) {
          test(x, y) = static_cast<float>(wave(0.5, 8, 24)(i));
        }
      }
      map = meter.add(uniform(kLuminance), test, kGaze);
    }
    return *map;
  };
  const ImageGray near = patch_at(40);
  const ImageGray far = patch_at(240);
  EXPECT_GT(near(40, 60), 4 * far(240, 60));
  EXPECT_GT(far(240, 60), 0);
  EXPECT_EQ(near(240, 60), 0);
  EXPECT_EQ(far(40, 60), 0);
}

TEST(FlickerRange, SaysWhatTheFrameRateHides) {
  const FlickerRange slow = flicker_range(24, 100);
  EXPECT_DOUBLE_EQ(slow.lowest_hz, 1);
  EXPECT_DOUBLE_EQ(slow.highest_hz, 12);
  EXPECT_GT(slow.fusion_hz, slow.highest_hz);
  EXPECT_NEAR(contrast_sensitivity(0.5, slow.fusion_hz, 100, 0), 1, 0.01);
  EXPECT_DOUBLE_EQ(flicker_range(30000.0 / 1001, 100).lowest_hz, 1000.0 / 1001);
  EXPECT_DOUBLE_EQ(flicker_range(25, 100).highest_hz, 12);  // of 25 frames, 12 whole periods
  EXPECT_LT(flicker_range(240, 100).fusion_hz, 120);
}

TEST(FlickerRange, IsToldInWords) {
  FlickerRange range{1, 12, 53.4};
  EXPECT_EQ(
      flicker_range_text(range),
      "from 1 to 12 Hz, over the second up to each frame; flicker of up to 53 Hz would be visible, but flicker above "
      "12 Hz cannot be measured at this frame rate: it appears slower, or not at all");
  range.highest_hz = 60;
  EXPECT_EQ(
      flicker_range_text(range),
      "from 1 to 60 Hz, over the second up to each frame; all visible flicker can be measured at this frame rate");
}

TEST(SlidingSpectrum, IsThatOfTheLastFramesAfterManyFrames) {
  constexpr int kFrames = 25;
  std::mt19937 random(4);
  std::normal_distribution<float> normal(100, 30);
  SlidingSpectrum spectrum(1, 2, kFrames);
  std::vector<double> values;
  double first = 0;
  for (int i = 0; i < 5003; ++i) {
    ImageGray frame(1, 2);
    frame(0, 0) = 5;
    frame(0, 1) = normal(random);
    first = i == 0 ? static_cast<double>(frame(0, 1)) : first;
    values.push_back(static_cast<double>(frame(0, 1)));
    spectrum.add(frame, 1);
  }
  ASSERT_TRUE(spectrum.is_full());
  double mean = 0;
  for (int k = 0; k <= kFrames / 2; ++k) {
    std::complex<double> direct;
    for (int n = 0; n < kFrames; ++n) {
      const double value = values[values.size() - kFrames + static_cast<std::size_t>(n)];
      mean += k == 0 ? value / kFrames : 0;
      direct += (value - first) * std::polar(1.0, -2 * kPi * k * n / kFrames);
    }
    EXPECT_NEAR(std::abs(spectrum.at(1)[k] - direct), 0, 1e-4) << k;
    EXPECT_EQ(spectrum.at(0)[k], std::complex<double>());
  }
  EXPECT_NEAR(spectrum.mean(1), mean, 1e-5);
  EXPECT_EQ(spectrum.mean(0), 5);
}

// The mean square of a whole-period wave, whatever its frequency but the last before half the frame rate.
TEST(SlidingSpectrum, PowerIsTheMeanSquare) {
  constexpr int kFrames = 30;
  for (int hz = 2; hz < kFrames / 2 - 1; ++hz) {
    std::vector<std::complex<double>> spectrum(kFrames / 2 + 1);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      for (int n = 0; n < kFrames; ++n) {
        const double value = 7 + 3 * std::cos(2 * kPi * hz * n / kFrames + 1);
        spectrum[k] += value * std::polar(1.0, -2 * kPi * static_cast<double>(k) * n / kFrames);
      }
    }
    std::vector<double> power(kFrames / 2);
    hann_power(spectrum.data(), kFrames, power);
    double sum = 0;
    for (const double p : power) {
      sum += p;
    }
    EXPECT_NEAR(sum, 4.5, 1e-9) << hz;
    EXPECT_NEAR(power[static_cast<std::size_t>(hz) - 1], 4.5 * 2 / 3, 1e-9) << hz;
  }
}

}  // namespace
}  // namespace gazetrace::flicker_test
