// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/pixel_filter.hpp"

#include <cmath>

namespace gazetrace {
namespace {

constexpr double kHalfWidth = 1.5;

// The integral of the four-term Blackman-Harris window (Harris 1978) from its left end to x in [0, 1], divided by that
// over the whole window.
double blackman_harris_distribution(double x) {
  constexpr double a0 = 0.35875;
  constexpr double a1 = 0.48829;
  constexpr double a2 = 0.14128;
  constexpr double a3 = 0.01168;
  const double t = 2 * kPi * x;
  return x + (-a1 * std::sin(t) + a2 * std::sin(2 * t) / 2 - a3 * std::sin(3 * t) / 3) / (2 * kPi * a0);
}

}  // namespace

PixelFilterSampler::PixelFilterSampler(PixelFilter filter, double scale)
    : box_(filter == PixelFilter::box), scale_(static_cast<float>(scale)) {
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double target = static_cast<double>(i) / kSteps;
    double low = 0;
    double high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (blackman_harris_distribution(middle) < target ? low : high) = middle;
    }
    inverse_[i] = static_cast<float>((low + high - 1) * kHalfWidth);
  }
  inverse_[kSteps + 1] = inverse_[kSteps];
}

}  // namespace gazetrace
