// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/visible_error.hpp"

namespace gazetrace {
namespace {

// Of e, the visible error of one sample.
constexpr double kRateExponent = kVisiblePooling / (1 + kVisiblePooling / 2);

void check_same_size(const ImageGray& weights, const ImageGray& variance) {
  if (weights.width_px != variance.width_px || weights.height_px != variance.height_px) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("weights of {}x{} pixels and variances of {}x{}", weights.width_px, weights.height_px,
                            variance.width_px, variance.height_px));
  }
}

double visible_error_at(const ImageGray& weights, const ImageGray& variance, std::size_t i) {
  const double e = static_cast<double>(weights.pixels[i]) * std::sqrt(static_cast<double>(variance.pixels[i]));
  return e > 0 && std::isfinite(e) ? e : 0.0;
}

// Rows are summed apart and added in their order, so that the mean does not depend on threads.
double mean_over_pixels(const ImageGray& image, int threads, const std::function<double(std::size_t)>& value) {
  std::vector<double> row_sum(static_cast<std::size_t>(image.height_px));
  const auto width = static_cast<std::size_t>(image.width_px);
  parallel_for(row_sum.size(), threads, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      row_sum[row] += value(i);
    }
  });
  double sum = 0;
  for (const double row : row_sum) {
    sum += row;
  }
  return sum / static_cast<double>(image.pixels.size());
}

}  // namespace

ImageGray visible_allocation(const ImageGray& weights, const ImageGray& variance_of_one_sample, int threads) {
  check_same_size(weights, variance_of_one_sample);
  ImageGray density(weights.width_px, weights.height_px, 1.0F);
  const auto rate = [&](std::size_t i) {
    return std::pow(visible_error_at(weights, variance_of_one_sample, i), kRateExponent);
  };
  const double mean = mean_over_pixels(weights, threads, rate);
  if (!(mean > 0) || !std::isfinite(mean)) {
    return density;
  }
  // The least rate is mixed in, so that the mean stays 1.
  constexpr auto kLeast = static_cast<double>(kLeastAllocation);
  const auto width = static_cast<std::size_t>(weights.width_px);
  parallel_for(static_cast<std::size_t>(weights.height_px), threads, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      density.pixels[i] = static_cast<float>(kLeast + (1 - kLeast) * rate(i) / mean);
    }
  });
  return density;
}

double allocation_gain(const ImageGray& weights, const ImageGray& variance_of_one_sample, int threads) {
  check_same_size(weights, variance_of_one_sample);
  const auto error = [&](std::size_t i) { return visible_error_at(weights, variance_of_one_sample, i); };
  const double pooled =
      mean_over_pixels(weights, threads, [&](std::size_t i) { return std::pow(error(i), kVisiblePooling); });
  const double rate =
      mean_over_pixels(weights, threads, [&](std::size_t i) { return std::pow(error(i), kRateExponent); });
  if (!(pooled > 0) || !(rate > 0)) {
    return 1;
  }
  return std::pow(pooled, 2 / kVisiblePooling) / std::pow(rate, 2 / kRateExponent);
}

}  // namespace gazetrace
