// SPDX-License-Identifier: Apache-2.0
// The rates of a picture that somebody else made.
#include "foveation/falloff.hpp"

namespace gazetrace {

Falloff falloff_map(const FoveationSettings& /*settings*/, const PlanarView& /*view*/, const Vec3d& /*gaze*/) {
  return picture_density();
}

}  // namespace gazetrace
