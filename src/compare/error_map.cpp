// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gazetrace/compare.hpp"

namespace gazetrace {
namespace {

double shade(const std::string& metric, double value) {
  constexpr double kWhiteJod = 3;
  if (metric == "mse" || metric == "rmse" || metric == "relmse" || metric == "psnr") {
    return std::sqrt(value);
  }
  if (metric == "ssim") {
    return 1 - value;
  }
  if (metric == "smape") {
    return value / 2;
  }
  return metric == "fovvideovdp" ? value / kWhiteJod : value;
}

}  // namespace

DisplayImage error_map_picture(const std::string& metric, const ImageGray& map) {
  DisplayImage picture{map.width_px, map.height_px, 8, {}};
  picture.bytes.reserve(3 * map.pixels.size());
  for (const float value : map.pixels) {
    const auto rgb = magma(shade(metric, static_cast<double>(value)));
    picture.bytes.insert(picture.bytes.end(), rgb.begin(), rgb.end());
  }
  return picture;
}

}  // namespace gazetrace
