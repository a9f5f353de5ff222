// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/visible_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr double kEpsilon = 0.01;      // that of the metric relmse
constexpr double kWindowPixels = 25;   // of pooled()
constexpr double kPriorSamples = 100;  // about the kurtosis of path-traced light
constexpr int kLeastModelPx = 8;       // of VisibleErrorModel

double squared(double value) {
  return value * value;
}

// The squared error that one sample would have.
double error_of_one(const Pilot& pilot, std::size_t i) {
  return static_cast<double>(pilot.squared_error.pixels[i]) * static_cast<double>(pilot.spp.pixels[i]);
}

// Two pilots differ by the noise of both; relative to the luminance and to the rates, of which they may have different
// ones, it is of one kind everywhere.
ImageGray relative_difference(const Pilot& a, const Pilot& b, const ImageGray& level) {
  ImageGray difference(a.luminance.width_px, a.luminance.height_px);
  for (std::size_t i = 0; i < difference.pixels.size(); ++i) {
    const auto light = static_cast<double>(level.pixels[i]);
    const double spread = 1 / static_cast<double>(a.spp.pixels[i]) + 1 / static_cast<double>(b.spp.pixels[i]);
    const double raw = static_cast<double>(a.luminance.pixels[i]) - static_cast<double>(b.luminance.pixels[i]);
    const double value = raw / std::sqrt((squared(light) + kEpsilon) * spread);
    difference.pixels[i] = std::isfinite(value) ? static_cast<float>(value) : 0.0F;
  }
  return difference;
}

constexpr int kRadius = 2;

double pooled_at(const ImageGray& values, int x, int y) {
  std::array<double, (2 * kRadius + 1) * (2 * kRadius + 1)> window{};
  std::size_t count = 0;
  double sum = 0;
  for (int ny = std::max(y - kRadius, 0); ny <= std::min(y + kRadius, values.height_px - 1); ++ny) {
    for (int nx = std::max(x - kRadius, 0); nx <= std::min(x + kRadius, values.width_px - 1); ++nx) {
      const auto value = static_cast<double>(values(nx, ny));
      if (std::isfinite(value)) {
        window.at(count) = std::max(value, 0.0);
        sum += window.at(count++);
      }
    }
  }
  if (count < 2) {
    return sum;
  }
  double pool = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // The others are added up, since the difference of two sums may have no digits left.
    double others = 0;
    if (window.at(i) > 0.5 * sum) {
      for (std::size_t k = 0; k < count; ++k) {
        others += k == i ? 0.0 : window.at(k);
      }
      pool += std::min(window.at(i), kMostOfOthers * others / static_cast<double>(count - 1));
    } else {
      pool += window.at(i);
    }
  }
  return pool / static_cast<double>(count);
}

}  // namespace

ImageGray pooled(const ImageGray& values, int threads) {
  ImageGray result(values.width_px, values.height_px);
  parallel_for(static_cast<std::size_t>(values.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < values.width_px; ++x) {
      result(x, y) = static_cast<float>(pooled_at(values, x, y));
    }
  });
  return result;
}

VisibleNoise::VisibleNoise(const FrameRequest& request, const FrameSettings& settings)
    : request_(request), settings_(settings) {
  if (std::min(request.width_px, request.height_px) >= kLeastModelPx) {
    VisibleErrorSettings seen;
    seen.view = request.view;
    seen.frames_per_second = settings.frames_per_second;
    seen.cell_px = pilot_cell_px(request);
    seen.threads = settings.threads;
    model_.emplace(seen);
  }
}

void VisibleNoise::learn(Pilot pilot) {
  level_ = pooled(pilot.luminance, settings_.threads);
  if (model_) {
    const double ev = choose_exposure_ev(pilot.radiance, settings_.exposure);
    display_ = settings_.display_curve ? settings_.display_curve(ev) : linear_display_curve({}, ev);
    if (pilot_) {
      spectrum_ = measured_spectrum(relative_difference(*pilot_, pilot, level_), settings_.threads);
    }
  }
  pilot_ = std::move(pilot);
}

double VisibleNoise::unit_at(std::size_t i) const {
  return squared(static_cast<double>(level_.pixels[i])) + kEpsilon;
}

double VisibleNoise::relative_error_of_one(std::size_t i) const {
  const auto of_one = static_cast<float>(error_of_one(*pilot_, i) / unit_at(i));
  return std::isfinite(of_one) ? static_cast<double>(of_one) : std::numeric_limits<double>::quiet_NaN();
}

ImageGray VisibleNoise::relative_squared_error() const {
  ImageGray relative(pilot_->luminance.width_px, pilot_->luminance.height_px);
  for (std::size_t i = 0; i < relative.pixels.size(); ++i) {
    relative.pixels[i] = static_cast<float>(relative_error_of_one(i));
  }
  relative = pooled(relative, settings_.threads);
  // A window that saw no firefly says little of them. Its mean counts by its samples, and that of the frame as
  // kPriorSamples more (the credibility of actuaries: Buehlmann 1967).
  double mean = 0;
  double spp = 0;
  for (std::size_t i = 0; i < relative.pixels.size(); ++i) {
    mean += static_cast<double>(relative.pixels[i]) / static_cast<double>(relative.pixels.size());
    spp += static_cast<double>(pilot_->spp.pixels[i]) / static_cast<double>(relative.pixels.size());
  }
  const double own = kWindowPixels * spp / (kWindowPixels * spp + kPriorSamples);
  for (float& value : relative.pixels) {
    value = static_cast<float>(own * static_cast<double>(value) + (1 - own) * mean);
  }
  return relative;
}

ImageGray VisibleNoise::wanted_for_relmse() const {
  ImageGray wanted = relative_squared_error();
  for (float& value : wanted.pixels) {
    value = std::sqrt(value);
  }
  return wanted;
}

ImageGray VisibleNoise::wanted_by_eye() const {
  ImageGray wanted = wanted_for_relmse();
  if (!model_ || !request_.gaze_direction_render) {
    return wanted;
  }
  // Weights are those of the pilot's own pixels, in which the eye sees a relative error about alike.
  const ImageGray weights = model_->weights(picture(), {error_at(pilot_->spp)});
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i) {
    const double light = std::sqrt(squared(static_cast<double>(pilot_->luminance.pixels[i])) + kEpsilon);
    const double weight = static_cast<double>(weights.pixels[i]) * light;
    wanted.pixels[i] = static_cast<float>(static_cast<double>(wanted.pixels[i]) * std::sqrt(weight));
  }
  return pooled(wanted, settings_.threads);
}

double VisibleNoise::relmse_at(const ImageGray& rates) const {
  double sum = 0;
  double known = 0;
  for (std::size_t i = 0; i < rates.pixels.size(); ++i) {
    if (const double of_one = relative_error_of_one(i); !std::isnan(of_one)) {
      sum += std::max(of_one, 0.0) / static_cast<double>(rates.pixels[i]);
      known += 1;
    }
  }
  return known > 0 ? sum / known : 0;
}

ErrorComponent VisibleNoise::error_at(const ImageGray& rates) const {
  ErrorComponent error;
  error.squared_error = ImageGray(rates.width_px, rates.height_px);
  for (std::size_t i = 0; i < rates.pixels.size(); ++i) {
    const double of_one = error_of_one(*pilot_, i);
    error.squared_error.pixels[i] =
        of_one > 0 && std::isfinite(of_one) ? static_cast<float>(of_one / static_cast<double>(rates.pixels[i])) : 0.0F;
  }
  error.spectrum = spectrum_;
  return error;
}

VisiblePicture VisibleNoise::picture() const {
  return {pilot_->luminance, display_, request_.gaze_direction_render};
}

}  // namespace gazetrace
