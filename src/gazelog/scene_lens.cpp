// SPDX-License-Identifier: Apache-2.0
#include "gazelog/scene_lens.hpp"

#include <algorithm>

#include "core/text.hpp"
#include "gazelog/json.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

SceneLens load_scene_lens(const std::string& path) {
  const JsonLeaves json(read_text_file(path), path);
  SceneLens lens;
  const auto entry = [&](const char* key, double& value) {
    const auto number = json.number(key);
    if (!number) {
      throw Error(ErrorKind::input, path, std::string("has no number '") + key + "'",
                  "a scene_camera.json of Pupil Cloud has camera_matrix and dist_coefs");
    }
    value = *number;
  };
  entry("camera_matrix.0.0", lens.fx);
  entry("camera_matrix.1.1", lens.fy);
  entry("camera_matrix.0.2", lens.cx);
  entry("camera_matrix.1.2", lens.cy);
  std::vector<double> k;
  for (const char* const key : {"dist_coefs.0", "dist_coefs", "distortion_coefficients.0", "distortion_coefficients"}) {
    k = k.empty() ? json.numbers(key) : k;
  }
  std::copy_n(k.begin(), std::min(k.size(), lens.k.size()), lens.k.begin());
  if (!(lens.fx > 0) || !(lens.fy > 0)) {
    throw Error(ErrorKind::input, path, "its focal lengths are not positive");
  }
  return lens;
}

Vec3d ray_of(const SceneLens& lens, const Vec2d& pixel) {
  const Vec2d distorted{(pixel.x - lens.cx) / lens.fx, (pixel.y - lens.cy) / lens.fy};
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens.k;
  Vec2d at = distorted;
  for (int i = 0; i < 40; ++i) {
    const double r2 = at.x * at.x + at.y * at.y;
    const double shrink = (1 + ((k6 * r2 + k5) * r2 + k4) * r2) / (1 + ((k3 * r2 + k2) * r2 + k1) * r2);
    const double dx = 2 * p1 * at.x * at.y + p2 * (r2 + 2 * at.x * at.x);
    const double dy = p1 * (r2 + 2 * at.y * at.y) + 2 * p2 * at.x * at.y;
    at = {(distorted.x - dx) * shrink, (distorted.y - dy) * shrink};
  }
  return normalize(Vec3d{at.x, at.y, 1});
}

}  // namespace gazetrace
