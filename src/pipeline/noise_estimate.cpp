// SPDX-License-Identifier: Apache-2.0
#include "pipeline/noise_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

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

}  // namespace gazetrace
