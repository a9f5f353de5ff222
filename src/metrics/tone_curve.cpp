// SPDX-License-Identifier: Apache-2.0
// The tone curves of HDR-FLIP, and the exposures that cover a reference's range (Andersson et al., "Visualizing Errors
// in Rendered High Dynamic Range Images", Eurographics 2021).
#include "metrics/tone_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5).
using Rational = std::array<double, 6>;

const Rational& curve_of(FlipToneMapper tone_mapper) {
  // Narkowicz's fit of ACES with its pre-exposure of 0.6, Hable's curve, and Reinhard's curve of luminance.
  static constexpr Rational kAces{0.36 * 2.51, 0.6 * 0.03, 0, 0.36 * 2.43, 0.6 * 0.59, 0.14};
  static constexpr Rational kHable{0.231683, 0.013791, 0, 0.18, 0.3, 0.018};
  static constexpr Rational kReinhard{0, 1, 0, 0, 1, 1};
  return tone_mapper == FlipToneMapper::aces ? kAces : tone_mapper == FlipToneMapper::hable ? kHable : kReinhard;
}

// The light at which the curve reaches 0.85, as the larger root.
double bright_end(FlipToneMapper tone_mapper) {
  constexpr double kShare = 0.85;
  const Rational& k = curve_of(tone_mapper);
  const double a = k[0] - kShare * k[3];
  const double b = k[1] - kShare * k[4];
  const double c = k[2] - kShare * k[5];
  if (a == 0) {
    return -c / b;
  }
  const double root = std::sqrt(b * b - 4 * a * c);
  return std::max((-b + root) / (2 * a), (-b - root) / (2 * a));
}

constexpr float kRed = 0.2126F;
constexpr float kGreen = 0.7152F;
constexpr float kBlue = 0.0722F;

// Keeps squares finite.
constexpr float kMostLight = 1e12F;

}  // namespace

void check_flip_exposures(const FlipExposures& e) {
  constexpr int kMostExposures = 1000;
  if (!std::isfinite(e.start_ev) || !std::isfinite(e.stop_ev) || e.start_ev > e.stop_ev) {
    throw Error(ErrorKind::usage, "hdr_flip",
                fmt::format("exposures from {} to {} are not a range", e.start_ev, e.stop_ev));
  }
  if (e.count < 1 || e.count > kMostExposures || (e.count == 1 && e.start_ev != e.stop_ev)) {
    throw Error(ErrorKind::usage, "hdr_flip", fmt::format("{} exposures from {} to {}", e.count, e.start_ev, e.stop_ev),
                "take 2 to 1000, or 1 where start and stop are the same");
  }
}

double exposure_ev(const FlipExposures& e, int i) {
  return e.count == 1 ? e.start_ev : e.start_ev + i * (e.stop_ev - e.start_ev) / (e.count - 1);
}

FlipExposures flip_exposures(const ImageRgb& reference, const FlipExposureSettings& settings) {
  std::vector<float> luminance;
  luminance.reserve(reference.pixels.size());
  for (const Vec3f& pixel : reference.pixels) {
    luminance.push_back(kRed * pixel.x + kGreen * pixel.y + kBlue * pixel.z);
  }
  FlipExposures exposures;
  const float most = luminance.empty() ? 0 : *std::max_element(luminance.begin(), luminance.end());
  if (most > 0) {
    const double x_max = bright_end(settings.tone_mapper);
    const float median = value_at_rank(luminance, luminance.size() / 2);
    exposures.start_ev = std::log2(x_max / most);
    // The authors' program takes no darker median, and ends where all light is below it.
    constexpr float kLeastMedian = std::numeric_limits<float>::epsilon();
    exposures.stop_ev = std::log2(x_max / std::min(std::max(median, kLeastMedian), most));
  }
  exposures.start_ev = settings.start_ev.value_or(exposures.start_ev);
  exposures.stop_ev = settings.stop_ev.value_or(exposures.stop_ev);
  if (settings.count) {
    exposures.count = *settings.count;
  } else if (most > 0 || exposures.start_ev != exposures.stop_ev) {
    exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop_ev - exposures.start_ev)));
  }
  check_flip_exposures(exposures);
  return exposures;
}

void tone_map(FlipToneMapper tone_mapper, float scale, const std::vector<float>& r, const std::vector<float>& g,
              const std::vector<float>& b, std::vector<float>& toned_r, std::vector<float>& toned_g,
              std::vector<float>& toned_b) {
  const std::size_t count = r.size();
  const auto exposed = [scale](float v) { return std::min(std::max(scale * v, 0.0F), kMostLight); };
  if (tone_mapper == FlipToneMapper::reinhard) {
    for (std::size_t i = 0; i < count; ++i) {
      const float red = exposed(r[i]);
      const float green = exposed(g[i]);
      const float blue = exposed(b[i]);
      const float factor = 1.0F / (1.0F + (kRed * red + kGreen * green + kBlue * blue));
      toned_r[i] = red * factor;
      toned_g[i] = green * factor;
      toned_b[i] = blue * factor;
    }
    return;
  }
  const Rational& k = curve_of(tone_mapper);
  const auto k0 = static_cast<float>(k[0]);
  const auto k1 = static_cast<float>(k[1]);
  const auto k2 = static_cast<float>(k[2]);
  const auto k3 = static_cast<float>(k[3]);
  const auto k4 = static_cast<float>(k[4]);
  const auto k5 = static_cast<float>(k[5]);
  const auto curve = [&](const std::vector<float>& from, std::vector<float>& to) {
    for (std::size_t i = 0; i < count; ++i) {
      const float x = exposed(from[i]);
      to[i] = ((k0 * x + k1) * x + k2) / ((k3 * x + k4) * x + k5);
    }
  };
  curve(r, toned_r);
  curve(g, toned_g);
  curve(b, toned_b);
}

}  // namespace gazetrace
