// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/camera.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// A view of a whole scene for files without a camera: from the front, a little to the right and above, as near as the
// scene fits into the frame with a small margin. `aspect` is the frame's width over its height.
CameraPath whole_scene_camera(const Scene& scene, const Projection& projection, double aspect);

}  // namespace gazetrace
