// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gazetrace/compare.hpp"
#include "metrics/code_values.hpp"
#include "metrics/structural_similarity.hpp"

namespace gazetrace {
namespace {

// For metrics whose map is shown as heat, the value of the last color.
std::optional<double> hottest(const std::string& metric) {
  constexpr double kJod = 3;
  constexpr double kSquaredThresholds = 100;
  return metric == "fovvideovdp" ? std::optional(kJod)
         : metric == "flicker"   ? std::optional(kSquaredThresholds)
                                 : std::nullopt;
}

double shade(const std::string& metric, double value) {
  if (const auto most = hottest(metric)) {
    // Flicker's map holds squares.
    return metric == "flicker" ? std::sqrt(value / *most) : value / *most;
  }
  if (metric == "mse" || metric == "rmse" || metric == "relmse" || metric == "psnr") {
    return std::sqrt(value);
  }
  if (metric == "ssim") {
    return 1 - value;
  }
  return metric == "smape" ? value / 2 : value;
}

// Grey at 0, then blue, green, yellow and red at the quarters; the brightness of the grey shows through.
std::array<std::uint8_t, 3> heat(double value, double grey) {
  constexpr std::array<Vec3d, 5> kColors{
      {{1, 1, 1}, {0.25, 0.55, 1}, {0.2, 0.85, 0.3}, {1, 0.85, 0.1}, {1, 0.15, 0.1}}};
  const double at = 4 * std::clamp(value, 0.0, 1.0);
  const auto node = std::min<std::size_t>(static_cast<std::size_t>(at), 3);
  const double share = at - static_cast<double>(node);
  const Vec3d color = kColors[node] * (1 - share) + kColors[node + 1] * share;
  // The color must be recognised however dark the picture is, so half of the brightness does not depend on the picture.
  const double own = 0.5 * std::min(at, 1.0);
  const double bright = own + (1 - own) * grey;
  const auto code = [&](double v) { return static_cast<std::uint8_t>(std::lround(255 * v * bright)); };
  return {code(color.x), code(color.y), code(color.z)};
}

}  // namespace

DisplayImage error_map_picture(const std::string& metric, const ImageGray& map, const ImageRgb& reference_code) {
  DisplayImage picture{map.width_px, map.height_px, 8, {}};
  picture.bytes.reserve(3 * map.pixels.size());
  const bool is_heat = hottest(metric).has_value();
  const int margin = metric == "ssim" ? kSsimRadiusPx : 0;  // not scored
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      const bool is_scored =
          std::min(x, map.width_px - 1 - x) >= margin && std::min(y, map.height_px - 1 - y) >= margin;
      const double value = is_scored ? shade(metric, static_cast<double>(map(x, y))) : 0;
      const double grey = reference_code.empty() ? 0 : std::clamp(luma_601(reference_code(x, y)), 0.0, 1.0);
      const auto rgb = is_heat ? heat(value, grey) : magma(value);
      picture.bytes.insert(picture.bytes.end(), rgb.begin(), rgb.end());
    }
  }
  return picture;
}

}  // namespace gazetrace
