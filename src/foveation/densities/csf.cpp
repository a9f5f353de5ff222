// SPDX-License-Identifier: Apache-2.0
// Contrast sensitivity at the luminance that the eye is adapted to. In the fovea it is that of Barten, "Formula for the
// contrast sensitivity of the human eye", SPIE 5294, 2004, eq. 11:
//   S(u, L) = 5200 exp(-0.0016 u^2 (1 + 100/L)^0.08) /
//             sqrt((1 + 144/X0^2 + 0.64 u^2) (63/L^0.83 + 1/(1 - exp(-0.02 u^2)))),
// where X0 = 10 degrees is the size of the detail. Its decline with eccentricity is that of stelaCSF (Mantiuk et al.,
// ACM TOG 41(4), 2022; constants from the authors' code, MIT licence):
//   S(u, L, e) = S(u, L) 10^(-(k1 + k2 u) e),
// k1 = 0.0277526, k2 = 0.0175072, and towards the nasal visual field k1 = 0.0275591, k2 = 0.00987064, mixed by
// min(1, |v - 180 deg| / 90 deg) with v the direction in the visual field, 0 temporal and 180 nasal. The cut-off is the
// highest u of 1/16 to 64 cycles per degree with S C >= 1 for a detail of contrast C, and 0 where there is none.
// Beyond 120 degrees, where the fit ends, the value at 120 degrees is held. Temporal frequency and the influence of
// size are left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include "foveation/densities.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastCpd = 1.0 / 16;
constexpr double kMostCpd = 64;
constexpr double kLastDeg = 120;

struct Decline {
  double k1, k2;
};
constexpr Decline kTemporalDecline{0.0277526, 0.0175072};
constexpr Decline kNasalDecline{0.0275591, 0.00987064};

double log10_foveal_sensitivity(double u_cpd, double luminance_cd_m2) {
  constexpr double kSizeDeg = 10;
  const double u2 = u_cpd * u_cpd;
  const double noise = 63 / std::pow(luminance_cd_m2, 0.83) - 1 / std::expm1(-0.02 * u2);
  const double optics = 0.0016 * u2 * std::pow(1 + 100 / luminance_cd_m2, 0.08);
  return std::log10(5200) - optics / std::log(10.0) -
         0.5 * std::log10((1 + 144 / (kSizeDeg * kSizeDeg) + 0.64 * u2) * noise);
}

// Cut-offs over direction and eccentricity, solved once and read by interpolation.
class CutoffTable {
 public:
  CutoffTable(double contrast, double luminance_cd_m2) {
    std::array<double, kFrequencies> foveal{};
    for (std::size_t i = 0; i < kFrequencies; ++i) {
      foveal[i] =
          log10_foveal_sensitivity(frequency_cpd(static_cast<double>(i)), luminance_cd_m2) + std::log10(contrast);
    }
    for (std::size_t d = 0; d < kDirections; ++d) {
      const double temporal = static_cast<double>(d) / (kDirections - 1);
      const Decline decline{std::lerp(kNasalDecline.k1, kTemporalDecline.k1, temporal),
                            std::lerp(kNasalDecline.k2, kTemporalDecline.k2, temporal)};
      for (std::size_t i = 0; i < kAngles; ++i) {
        cutoff_[d][i] = solve(foveal, decline, angle_deg(i));
      }
    }
  }

  // `temporal`: 0 nasal .. 1.
  [[nodiscard]] double cutoff_cpd(double eccentricity_deg, double temporal) const {
    const double at = std::sqrt(std::min(eccentricity_deg, kLastDeg) / kLastDeg) * (kAngles - 1);
    const auto i = std::min(static_cast<std::size_t>(at), kAngles - 2);
    const double d_at = temporal * (kDirections - 1);
    const auto d = std::min(static_cast<std::size_t>(d_at), kDirections - 2);
    const double share = at - static_cast<double>(i);
    const double low = std::lerp(cutoff_[d][i], cutoff_[d][i + 1], share);
    const double high = std::lerp(cutoff_[d + 1][i], cutoff_[d + 1][i + 1], share);
    return std::lerp(low, high, d_at - static_cast<double>(d));
  }

 private:
  static constexpr std::size_t kFrequencies = 512;
  static constexpr std::size_t kAngles = 256;
  static constexpr std::size_t kDirections = 17;

  static double frequency_cpd(double i) {
    return kLeastCpd * std::pow(kMostCpd / kLeastCpd, i / static_cast<double>(kFrequencies - 1));
  }
  // Closer together where the cut-off changes fast.
  static double angle_deg(std::size_t i) {
    const double root = static_cast<double>(i) / (kAngles - 1);
    return kLastDeg * root * root;
  }
  // From the top down to the first frequency that is seen, then between it and the one above: log S C is nearly a
  // straight line over a step of 1.4 %.
  static double solve(const std::array<double, kFrequencies>& foveal, const Decline& decline, double e) {
    const auto log_seen = [&](std::size_t i) {
      return foveal[i] - (decline.k1 + decline.k2 * frequency_cpd(static_cast<double>(i))) * e;
    };
    double above = 0;
    for (std::size_t i = kFrequencies; i-- > 0;) {
      const double here = log_seen(i);
      if (here >= 0) {
        const double step = i + 1 == kFrequencies ? 0.0 : here / (here - above);
        return frequency_cpd(static_cast<double>(i) + step);
      }
      above = here;
    }
    return 0;
  }

  std::array<std::array<double, kAngles>, kDirections> cutoff_{};
};

}  // namespace

DensityModel csf_model(double contrast, double luminance_cd_m2, FieldOf eye) {
  const auto table = std::make_shared<const CutoffTable>(contrast, luminance_cd_m2);
  DensityModel model;
  model.uses_meridian = true;
  model.value = [table, eye](const DensityPlace& place) {
    // The right eye's nasal side is on the left, at pi.
    const double from_left = std::atan2(std::abs(place.meridian.y), -place.meridian.x);
    const double from_right = kPi - from_left;
    const double from_nasal = eye == FieldOf::right  ? from_left
                              : eye == FieldOf::left ? from_right
                                                     : std::min(from_left, from_right);
    return table->cutoff_cpd(place.eccentricity_deg, std::min(1.0, from_nasal / (0.5 * kPi)));
  };
  return model;
}

}  // namespace gazetrace
