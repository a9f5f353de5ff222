// SPDX-License-Identifier: Apache-2.0
// The models of acuity by name: the rows of one table.
#pragma once

#include <string>
#include <vector>

#include "foveation/model.hpp"

namespace gazetrace {

// What a model is made of: a value for each of its parameters, in their order, and what the eye sees of the frame.
struct DensityArguments {
  const std::vector<double>& values;
  const PlanarView& view;
  const Vec3d& gaze_direction;
};

struct NamedDensity : DensityInfo {
  DensityModel (*model)(const DensityArguments& given) = nullptr;
  bool is_ramp = false;  // the second value must be above the first
};
const std::vector<NamedDensity>& named_densities();

// The last parameter of models of a cut-off frequency.
constexpr const char* kRelativeTo = "relative-to";

// Whose visual field counts, for models whose nasal and temporal sides differ: at each place the better eye, or one.
enum class FieldOf : std::uint8_t { both, left, right };

// Those that have a file of their own in densities/.
DensityModel csf_model(double contrast, double luminance_cd_m2, FieldOf eye);
DensityModel retina_model(FieldOf eye);
DensityModel log_polar_model(double sigma, double alpha, const PlanarView& view, const Vec3d& gaze_direction);

}  // namespace gazetrace
