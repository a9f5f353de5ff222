// SPDX-License-Identifier: Apache-2.0
// Multi-scale structural similarity (Wang, Simoncelli, Bovik, "Multi-scale structural similarity for image quality
// assessment", 2003, eq. 7) of BT.601 luma: five scales, each the mean of 2 x 2 pixels of the one before. Negative
// means of a scale count as 0. There is no map, since the factors belong to different scales.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/statistics.hpp"
#include "gazetrace/error.hpp"
#include "metrics/code_values.hpp"
#include "metrics/metric.hpp"
#include "metrics/structural_similarity.hpp"

namespace gazetrace {
namespace {

// Exponents of the scales, finest first (section 3.2 of the paper).
constexpr std::array<double, 5> kExponents{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

ImageDouble luma_of(const ImageRgb& code) {
  ImageDouble luma(code.width_px, code.height_px);
  std::transform(code.pixels.begin(), code.pixels.end(), luma.pixels.begin(), luma_601);
  return luma;
}

ImageDouble halved(const ImageDouble& image) {
  ImageDouble half(image.width_px / 2, image.height_px / 2);
  for (int y = 0; y < half.height_px; ++y) {
    for (int x = 0; x < half.width_px; ++x) {
      half(x, y) =
          (image(2 * x, 2 * y) + image(2 * x + 1, 2 * y) + image(2 * x, 2 * y + 1) + image(2 * x + 1, 2 * y + 1)) / 4;
    }
  }
  return half;
}

}  // namespace

MetricMap metric_ms_ssim(const MetricPicture& reference, const MetricPicture& test, const MetricSettings& settings) {
  constexpr int kLeastSide = (2 * kSsimRadiusPx + 1) << (kExponents.size() - 1);
  if (std::min(reference.code.width_px, reference.code.height_px) < kLeastSide) {
    throw Error(ErrorKind::usage, "ms_ssim",
                fmt::format("needs pictures of at least {0}x{0} pixels, these have {1}x{2}", kLeastSide,
                            reference.code.width_px, reference.code.height_px),
                "leave it out");
  }
  ImageDouble r = luma_of(reference.code);
  ImageDouble t = luma_of(test.code);
  MetricMap map;
  map.mean = 1;
  for (std::size_t scale = 0; scale < kExponents.size(); ++scale) {
    SsimFactors factors = ssim_factors(r, t, settings.threads);
    std::vector<double>& terms = factors.contrast_structure.pixels;
    if (scale + 1 == kExponents.size()) {
      std::transform(terms.begin(), terms.end(), factors.luminance.pixels.begin(), terms.begin(), std::multiplies<>());
    } else {
      r = halved(r);
      t = halved(t);
    }
    map.mean *= std::pow(std::max(mean_of(terms), 0.0), kExponents[scale]);
  }
  return map;
}

double metric_value_ms_ssim(double mean) {
  return mean;
}

}  // namespace gazetrace
