// SPDX-License-Identifier: Apache-2.0
// Whether two frames look through one and the same camera, which then stands still between them.
#pragma once

#include "gazetrace/camera.hpp"

namespace gazetrace {

inline bool same_camera(const Camera& a, const Camera& b) {
  return a.pose == b.pose && a.projection == b.projection && a.lens == b.lens && a.middle_px == b.middle_px &&
         a.shutter_poses == b.shutter_poses;
}

}  // namespace gazetrace
