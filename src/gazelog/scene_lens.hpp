// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "gazetrace/math.hpp"

namespace gazetrace {

// A camera with OpenCV's rational distortion, k1 k2 p1 p2 k3 k4 k5 k6.
struct SceneLens {
  double fx = 1, fy = 1, cx = 0, cy = 0;
  std::array<double, 8> k{};
};

SceneLens load_scene_lens(const std::string& path);  // scene_camera.json; Error(input)

// Unit vector of a pixel, +x right, +y down, +z forward. Undistorted by fixed-point iteration, as OpenCV does it.
Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel);

}  // namespace gazetrace
