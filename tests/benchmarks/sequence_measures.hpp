// SPDX-License-Identifier: Apache-2.0
// What the benchmarks of sequences measure over time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "gazetrace/flicker.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace::benchmark {

constexpr double kFps = 24;

using Luminances = std::vector<std::vector<float>>;  // frame by frame, pixel by pixel

struct Reference {
  Luminances a, b, mean;
  double level = 0;  // mean luminance
};

// Variance over time of what lies between 1 Hz and half the frame rate, mean over the pixels.
inline double variance_above_1_hz(const std::function<double(std::size_t frame, std::size_t pixel)>& value,
                                  std::size_t frames, std::size_t pixels) {
  const auto n = static_cast<double>(frames);
  double sum = 0;
  std::vector<double> series(frames);
  for (std::size_t i = 0; i < pixels; ++i) {
    double mean = 0;
    double square = 0;
    for (std::size_t f = 0; f < frames; ++f) {
      series[f] = value(f, i);
      mean += series[f] / n;
      square += series[f] * series[f] / n;
    }
    double variance = square - mean * mean;
    for (std::size_t k = 1; static_cast<double>(k) * kFps / n < 1; ++k) {
      double re = 0;
      double im = 0;
      for (std::size_t f = 0; f < frames; ++f) {
        const double phase = 2 * kPi * static_cast<double>(k * f) / n;
        re += series[f] * std::cos(phase) / n;
        im += series[f] * std::sin(phase) / n;
      }
      variance -= 2 * (re * re + im * im);
    }
    sum += variance;
  }
  return sum / static_cast<double>(pixels);
}

// The display on which flicker is judged, of 1000 : 1: the sequence's mean is shown at this share of its white.
constexpr double kWhite_cd_m2 = 200;
constexpr double kBlack_cd_m2 = 0.2;
constexpr double kMeanShare = 0.18;

struct SeenFlicker {
  double all = 0, periphery = 0;  // multiples of what is just seen; periphery: beyond kPeriphery_deg
};
constexpr double kPeriphery_deg = 8.5;

// Root mean of FlickerMeter's excess over pixels and all frames that end a whole second.
inline SeenFlicker seen_flicker(const FramePlan& plan, const Luminances& reference, const Luminances& test,
                                double mean_luminance) {
  const PlanarView& view = plan.frames.front().view;
  FlickerSettings settings;
  settings.view = view;
  settings.frames_per_second = kFps;
  FlickerMeter meter(settings);
  const auto shown = [&](const std::vector<float>& luminance) {
    ImageGray image(view.width_px, view.height_px);
    const double scale = kMeanShare / mean_luminance;
    for (std::size_t i = 0; i < luminance.size(); ++i) {
      image.pixels[i] = static_cast<float>(
          std::clamp(kWhite_cd_m2 * scale * static_cast<double>(luminance[i]), kBlack_cd_m2, kWhite_cd_m2));
    }
    return image;
  };
  double all = 0;
  double all_pixels = 0;
  double far = 0;
  double far_pixels = 0;
  for (std::size_t f = 0; f < test.size(); ++f) {
    const std::optional<Vec3d>& gaze = plan.frames[f].gaze_direction_true;
    const std::optional<ImageGray> map =
        meter.add(shown(reference[f]), shown(test[f]), gaze ? std::optional(view.pixel(*gaze)) : std::nullopt);
    if (!map || !gaze) {
      continue;
    }
    for (int y = 0; y < view.height_px; ++y) {
      for (int x = 0; x < view.width_px; ++x) {
        const auto value = static_cast<double>((*map)(x, y));
        all += value;
        all_pixels += 1;
        if (eccentricity_deg(view, *gaze, x + 0.5, y + 0.5) > kPeriphery_deg) {
          far += value;
          far_pixels += 1;
        }
      }
    }
  }
  return {std::sqrt(all / all_pixels), std::sqrt(far / far_pixels)};
}

}  // namespace gazetrace::benchmark
