// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP's contrast sensitivity as a function of spatial and temporal frequency, luminance and eccentricity.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace gazetrace {

// The formula, without FovVideoVDP's sensitivity correction.
double contrast_sensitivity(double rho_cpd, double omega_hz, double luminance_cd_m2, double eccentricity_deg);

// Its values on the metric's grid for the two temporal channels, with trilinear interpolation of their logarithms.
class SensitivityTable {
 public:
  // The only table, which is made when it is first asked for (about 0.1 s).
  static const SensitivityTable& get();

  struct Query {
    float log2_rho, log2_luminance, sqrt_eccentricity;
  };
  // log2 S of the sustained (0 Hz) and transient (5 Hz) channels; queries outside the grid are clamped to it.
  [[nodiscard]] std::array<float, 2> log2_sensitivity(const Query& query) const;

 private:
  SensitivityTable();
  static constexpr std::size_t kSize = 32;
  struct Node {
    float sustained, transient;
  };
  std::vector<Node> nodes_;  // luminance is the slowest index, then rho, then eccentricity
};

}  // namespace gazetrace
