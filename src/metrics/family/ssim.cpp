// SPDX-License-Identifier: Apache-2.0
// Structural similarity (Wang et al. 2004), the mean over R, G and B code values. Pixels whose window reaches over the
// border are not scored.
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.hpp"
#include "metrics/metric.hpp"
#include "metrics/structural_similarity.hpp"

namespace gazetrace {
namespace {

ImageDouble channel_of(const ImageRgb& image, float Vec3f::*channel) {
  ImageDouble plane(image.width_px, image.height_px);
  for (std::size_t i = 0; i < plane.pixels.size(); ++i) {
    plane.pixels[i] = image.pixels[i].*channel;
  }
  return plane;
}

}  // namespace

MetricMap metric_ssim(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  constexpr std::array<float Vec3f::*, 3> kChannels{&Vec3f::x, &Vec3f::y, &Vec3f::z};
  MetricMap map;
  map.values = ImageGray(reference.code.width_px, reference.code.height_px);
  map.margin_px = kSsimRadiusPx;
  for (const auto channel : kChannels) {
    const SsimFactors factors =
        ssim_factors(channel_of(reference.code, channel), channel_of(test.code, channel), settings.threads);
    const int width = factors.luminance.width_px;
    std::vector<double> row_sum(static_cast<std::size_t>(factors.luminance.height_px));
    parallel_for(row_sum.size(), settings.threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const double similarity = factors.luminance(x, y) * factors.contrast_structure(x, y) / 3;
        row_sum[row] += similarity;
        map.values(x + kSsimRadiusPx, y + kSsimRadiusPx) += static_cast<float>(similarity);
      }
    });
    map.mean +=
        std::accumulate(row_sum.begin(), row_sum.end(), 0.0) / static_cast<double>(factors.luminance.pixels.size());
  }
  return map;
}

double metric_value_ssim(double mean) {
  return mean;
}

}  // namespace gazetrace
