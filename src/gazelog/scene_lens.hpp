// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/gaze_conventions.hpp"

namespace gazetrace {

SceneLens load_scene_lens(const std::string& path);  // scene_camera.json; Error(input)

// The unit vector of a pixel, with +x right, +y down, +z forward. It is undistorted by fixed-point iteration, as in
// OpenCV.
Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel);

}  // namespace gazetrace
