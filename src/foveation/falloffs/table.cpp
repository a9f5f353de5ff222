// SPDX-License-Identifier: Apache-2.0
// A density over eccentricity from a table, which makes any other model reproducible: monotone cubic interpolation
// (falloff_table.hpp), the first and last value held beyond the ends.
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
