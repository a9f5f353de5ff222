// SPDX-License-Identifier: Apache-2.0
// The list of fall-offs as a table of functions.
#include "foveation/falloff.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace gazetrace {
namespace {

bool follows_picture(const std::string& falloff) {
  return falloff == "map" || falloff == "visible";
}

}  // namespace

std::vector<FalloffInfo> falloffs() {
  return {
#define FALLOFF(file, name, description) {name, description, follows_picture(name)},
#include "foveation/falloffs.def"
#undef FALLOFF
  };
}

bool follows_picture(const FoveationSettings& settings) {
  return follows_picture(settings.falloff);
}

bool works_without_gaze(const FoveationSettings& settings) {
  return settings.falloff == "uniform" || follows_picture(settings);
}

Falloff make_falloff(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction) {
#define FALLOFF(file, name, description)                   \
  if (settings.falloff == (name)) {                        \
    return falloff_##file(settings, view, gaze_direction); \
  }
#include "foveation/falloffs.def"
#undef FALLOFF
  return {};  // not reached: check_foveation knows the same list
}

FoveationSettings with_limits_of(const DensityModel& model, const FoveationSettings& settings) {
  FoveationSettings own = settings;
  if (settings.density_floor <= kDefaultDensityFloor) {
    own.density_floor = std::min(settings.density_floor, model.own_floor);
  }
  if (model.own_block_samples && settings.block_samples == FoveationSettings().block_samples) {
    own.block_samples = *model.own_block_samples;
  }
  return own;
}

std::optional<double> falloff_cutoff_cpd(const FoveationSettings& settings, double eccentricity_deg,
                                         double meridian_deg) {
  check_foveation(settings);
  // A cut-off does not depend on how the eye sees the frame, so any view will do.
  const Falloff falloff = make_falloff(settings, view_of_perspective(1, 2, 2), {0, 0, -1});
  const auto* model = std::get_if<DensityModel>(&falloff);
  if (model == nullptr || model->quantity != DensityModel::Quantity::cutoff_cpd) {
    return std::nullopt;
  }
  const double meridian_rad = meridian_deg * kRadPerDeg;
  return model->value({eccentricity_deg, {std::cos(meridian_rad), std::sin(meridian_rad)}, 0});
}

}  // namespace gazetrace
