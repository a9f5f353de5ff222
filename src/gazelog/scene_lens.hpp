// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/gaze_conventions.hpp"

namespace gazetrace {

SceneLens load_scene_lens(const std::string& path);  // scene_camera.json; Error(input)

// Unit vector of a pixel, +x right, +y down, +z forward. Undistorted by fixed-point iteration, as OpenCV does it.
Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel);

}  // namespace gazetrace
