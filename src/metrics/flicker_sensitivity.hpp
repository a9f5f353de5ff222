// SPDX-License-Identifier: Apache-2.0
// Contrast sensitivity at the frequencies of a flicker spectrum, tabulated over luminance and eccentricity.
#pragma once

#include <cstddef>
#include <vector>

namespace gazetrace {

class FlickerSensitivity {
 public:
  FlickerSensitivity(double rho_cpd, const std::vector<double>& frequencies_hz, int threads);
  // S^2 at each frequency; log S is interpolated bilinearly over log L and sqrt e. Queries outside the grid are clamped
  // to it.
  void squared(double luminance_cd_m2, double eccentricity_deg, std::vector<double>& out) const;

 private:
  std::size_t frequencies_;
  std::vector<float> log2_s_;  // luminance is the slowest index, then eccentricity, then frequency
};

}  // namespace gazetrace
