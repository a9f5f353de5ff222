// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {
namespace {

constexpr float kFarthest = 2;     // difference of a logarithm from that of its surroundings, as far as it is used
constexpr double kDarkest = 1e-4;  // share of the mean luminance: darker pixels count as that dark for their neighbours
constexpr double kReachSigmas = 3;

// Half of a Gaussian, from its middle outwards; not normalised.
std::vector<float> half_gaussian(double sigma_px) {
  std::vector<float> weights(static_cast<std::size_t>(std::ceil(kReachSigmas * sigma_px)) + 1);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double x = static_cast<double>(i) / sigma_px;
    weights[i] = static_cast<float>(std::exp(-0.5 * x * x));
  }
  return weights;
}

// The weighted mean about place `at` of a line of `count` values; what lies beyond its ends has no weight, nor have
// values that are NaN. Of nothing else it is NaN.
float mean_about(const float* values, std::size_t stride, int count, int at, const std::vector<float>& weights) {
  const int reach = static_cast<int>(weights.size()) - 1;
  float sum = 0;
  float total = 0;
  for (int k = std::max(0, at - reach); k <= std::min(count - 1, at + reach); ++k) {
    const float value = values[static_cast<std::size_t>(k) * stride];
    if (!std::isnan(value)) {
      const float weight = weights[static_cast<std::size_t>(std::abs(k - at))];
      sum += weight * value;
      total += weight;
    }
  }
  return sum / total;
}

// NaN where the luminance is not finite: such a pixel says nothing of its surroundings.
ImageGray log_luminance(const ImageRgb& radiance, int threads) {
  double sum = 0;
  std::size_t count = 0;
  for (const Vec3f& pixel : radiance.pixels) {
    if (const float value = luminance(pixel); std::isfinite(value)) {
      sum += value;
      ++count;
    }
  }
  const double mean = count > 0 ? sum / static_cast<double>(count) : 0;
  const auto darkest = std::max(static_cast<float>(kDarkest * mean), std::numeric_limits<float>::min());
  ImageGray result(radiance.width_px, radiance.height_px);
  parallel_for(static_cast<std::size_t>(radiance.height_px), threads, [&](std::size_t y) {
    for (int x = 0; x < radiance.width_px; ++x) {
      const float value = luminance(radiance(x, static_cast<int>(y)));
      result(x, static_cast<int>(y)) =
          std::isfinite(value) ? std::log(std::max(value, darkest)) : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return result;
}

std::set<int> coarse_blocks(const SamplingMap& map) {
  std::set<int> sizes;
  for (const MapRegion& region : map.regions) {
    if (region.block_px > 1) {
      sizes.insert(region.block_px);
    }
  }
  return sizes;
}

}  // namespace

double contrast_gain(double strength) {
  const double sinc = std::sin(kPi / 4) / (kPi / 4);
  return strength * (1 / (sinc * sinc * sinc) - 1) / (1 - std::exp(-kPi * kPi / 8));
}

ImageRgb enhance_contrast(ImageRgb radiance, const SamplingMap& map, double strength, int threads) {
  if (!(strength >= 0 && strength <= 1)) {
    throw Error(ErrorKind::usage, "enhance-contrast", "the strength must be in 0..1");
  }
  if (radiance.width_px != map.width_px || radiance.height_px != map.height_px) {
    throw Error(ErrorKind::usage, "enhance-contrast", "picture and sampling map differ in size");
  }
  if (strength == 0 || radiance.empty()) {
    return radiance;
  }
  const int width = radiance.width_px;
  const int height = radiance.height_px;
  const auto gain = static_cast<float>(contrast_gain(strength));
  const ImageGray logs = log_luminance(radiance, threads);
  ImageGray across(width, height);
  for (const int block_px : coarse_blocks(map)) {
    const std::vector<float> weights = half_gaussian(block_px);
    parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t y) {
      const float* const row = &logs(0, static_cast<int>(y));
      for (int x = 0; x < width; ++x) {
        across(x, static_cast<int>(y)) = mean_about(row, 1, width, x, weights);
      }
    });
    parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        if (map.regions[map.region(x, y)].block_px != block_px || std::isnan(logs(x, y))) {
          continue;
        }
        const float mean = mean_about(&across(x, 0), static_cast<std::size_t>(width), height, y, weights);
        const float farther = gain * std::clamp(logs(x, y) - mean, -kFarthest, kFarthest);
        radiance(x, y) = radiance(x, y) * std::exp(farther);
      }
    });
  }
  return radiance;
}

}  // namespace gazetrace
