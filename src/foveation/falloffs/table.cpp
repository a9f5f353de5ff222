// SPDX-License-Identifier: Apache-2.0
// A density over eccentricity from a table, by which any other model can be reproduced: monotone cubic interpolation
// (falloff_table.hpp), with the first and last value held beyond the ends.
#include <memory>

#include "foveation/falloff.hpp"
#include "foveation/falloff_table.hpp"

namespace gazetrace {

Falloff falloff_table(const FoveationSettings& settings, const PlanarView& /*view*/, const Vec3d& /*gaze_direction*/) {
  const auto curve = std::make_shared<const MonotoneCubic>(settings.parameters.table.points);
  DensityModel model = isotropic_density([curve](double e) { return (*curve)(e); });
  for (const Vec2d& point : settings.parameters.table.points) {
    model.turns_deg.push_back(point.x);  // monotone in between
  }
  return model;
}

}  // namespace gazetrace
