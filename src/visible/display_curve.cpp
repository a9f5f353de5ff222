// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/fast_math.hpp"
#include "gazetrace/visible_error.hpp"

namespace gazetrace {
namespace {

constexpr int kNodes = (DisplayCurve::kMostLog2 - DisplayCurve::kLeastLog2) * DisplayCurve::kStepsPerStop + 1;

double node_luminance(int i) {
  return std::exp2(DisplayCurve::kLeastLog2 + static_cast<double>(i) / DisplayCurve::kStepsPerStop);
}

// A view may dip where it clips; the curve does not.
void make_rising(DisplayCurve& curve) {
  auto most = static_cast<float>(curve.black_cd_m2);
  for (float& value : curve.cd_m2) {
    most = std::max(most, value);
    value = most;
  }
}

}  // namespace

float DisplayCurve::operator()(float scene_luminance) const {
  static const auto kLeast = static_cast<float>(node_luminance(0));
  const auto black = static_cast<float>(black_cd_m2);
  if (!(scene_luminance > kLeast)) {
    return scene_luminance > 0 ? black + (cd_m2.front() - black) * (scene_luminance / kLeast) : black;
  }
  const float at = (log2_fast(scene_luminance) - static_cast<float>(kLeastLog2)) * static_cast<float>(kStepsPerStop);
  const auto last = static_cast<float>(kNodes - 1);
  if (!(at < last)) {
    return cd_m2.back();
  }
  const auto i = static_cast<std::size_t>(std::max(at, 0.0F));
  // Linear in luminance between two nodes, so that a linear display stays linear.
  const float lower = exp2_fast(static_cast<float>(kLeastLog2) + static_cast<float>(i) / kStepsPerStop);
  static const float kRatio = std::exp2(1.0F / kStepsPerStop);
  const float share = (scene_luminance / lower - 1) / (kRatio - 1);
  return cd_m2[i] + std::clamp(share, 0.0F, 1.0F) * (cd_m2[i + 1] - cd_m2[i]);
}

DisplayCurve linear_display_curve(const DisplayPhotometry& photometry, double exposure_ev) {
  DisplayCurve curve;
  curve.black_cd_m2 = black_level_cd_m2(photometry);
  for (int i = 0; i < kNodes; ++i) {
    const double light = std::min(1.0, node_luminance(i) * std::exp2(exposure_ev));
    curve.cd_m2.push_back(static_cast<float>(curve.black_cd_m2 + (photometry.peak_cd_m2 - curve.black_cd_m2) * light));
  }
  return curve;
}

DisplayCurve view_display_curve(const ColorPipeline& color, const DisplayPhotometry& photometry, double exposure_ev) {
  constexpr int kBits = 16;
  constexpr float kMostCode = 65535;
  ImageRgb grey(kNodes + 1, 1);  // black first
  for (int i = 0; i < kNodes; ++i) {
    const auto value = static_cast<float>(node_luminance(i));
    grey(i + 1, 0) = {value, value, value};
  }
  const DisplayImage shown = color.apply(grey, exposure_ev, kBits, 1);
  ImageRgb code(kNodes + 1, 1);
  for (std::size_t i = 0; i < code.pixels.size(); ++i) {
    const auto channel = [&](std::size_t c) {
      const std::uint8_t* at = &shown.bytes[(3 * i + c) * sizeof(std::uint16_t)];
      std::uint16_t value = 0;
      std::copy(at, at + sizeof(value), reinterpret_cast<std::uint8_t*>(&value));
      return static_cast<float>(value) / kMostCode;
    };
    code.pixels[i] = {channel(0), channel(1), channel(2)};
  }
  const ImageGray luminance = display_luminance(code, photometry, 1);
  DisplayCurve curve;
  curve.black_cd_m2 = static_cast<double>(luminance.pixels.front());
  curve.cd_m2.assign(luminance.pixels.begin() + 1, luminance.pixels.end());
  make_rising(curve);
  return curve;
}

}  // namespace gazetrace
