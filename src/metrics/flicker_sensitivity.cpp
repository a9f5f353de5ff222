// SPDX-License-Identifier: Apache-2.0
#include "metrics/flicker_sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"
#include "metrics/contrast_sensitivity.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kLuminances = 48;
constexpr std::size_t kEccentricities = 48;
constexpr double kLeastLog2L = -10;  // about 0.001 cd/m2
constexpr double kMostLog2L = 14;    // 16384 cd/m2
constexpr double kMostEccentricityDeg = 120;

// Where a value lies among `count` nodes: the node before it, and the weight of the next one.
struct Place {
  std::size_t node;
  float share;
};
Place place_of(double position, std::size_t count) {
  const double limited = std::clamp(position, 0.0, static_cast<double>(count - 1));
  const auto node = std::min(static_cast<std::size_t>(limited), count - 2);
  return {node, static_cast<float>(limited - static_cast<double>(node))};
}

}  // namespace

FlickerSensitivity::FlickerSensitivity(double rho_cpd, const std::vector<double>& frequencies_hz, int threads)
    : frequencies_(frequencies_hz.size()), log2_s_(kLuminances * kEccentricities * frequencies_hz.size()) {
  parallel_for(kLuminances, threads, [&](std::size_t l) {
    const double luminance =
        std::exp2(kLeastLog2L + (kMostLog2L - kLeastLog2L) * static_cast<double>(l) / (kLuminances - 1));
    for (std::size_t e = 0; e < kEccentricities; ++e) {
      const double root = std::sqrt(kMostEccentricityDeg) * static_cast<double>(e) / (kEccentricities - 1);
      for (std::size_t k = 0; k < frequencies_; ++k) {
        log2_s_[(l * kEccentricities + e) * frequencies_ + k] =
            static_cast<float>(std::log2(contrast_sensitivity(rho_cpd, frequencies_hz[k], luminance, root * root)));
      }
    }
  });
}

void FlickerSensitivity::squared(double luminance_cd_m2, double eccentricity_deg, std::vector<double>& out) const {
  const Place l = place_of((std::log2(luminance_cd_m2) - kLeastLog2L) / (kMostLog2L - kLeastLog2L) * (kLuminances - 1),
                           kLuminances);
  const Place e = place_of(std::sqrt(eccentricity_deg / kMostEccentricityDeg) * (kEccentricities - 1), kEccentricities);
  const float* at = &log2_s_[(l.node * kEccentricities + e.node) * frequencies_];
  const float* next_e = at + frequencies_;
  const float* next_l = at + kEccentricities * frequencies_;
  const float* next_both = next_l + frequencies_;
  for (std::size_t k = 0; k < frequencies_; ++k) {
    const float here = at[k] + e.share * (next_e[k] - at[k]);
    const float there = next_l[k] + e.share * (next_both[k] - next_l[k]);
    out[k] = static_cast<double>(exp2_fast(2 * (here + l.share * (there - here))));
  }
}

}  // namespace gazetrace
