// SPDX-License-Identifier: Apache-2.0
// Kernel foveated rendering, Meng et al., Proc. ACM CGIT 1(1), 2018. A buffer of W/sigma x H/sigma covers the frame,
// with
//   u = w K^-1(ln r / L),  v = h theta / 2 pi,  K(x) = x^alpha,
// r in pixels from the gaze and L the logarithm of its distance from the frame's farthest corner. The buffer's samples
// fall on the frame with the density of the mapping's Jacobian,
//   |du/dr dv/dtheta| / r = w h / (2 pi alpha L r^2) (ln r / L)^(1/alpha - 1),
// limited to the full rate, with r no less than a pixel, where the mapping ends. Published: sigma = 1.8, alpha = 4. The
// buffer's 1/sigma^2 of the frame's pixels is an upper bound here, since samples beside the frame are not traced.
#include <algorithm>
#include <cmath>

#include "foveation/densities.hpp"

namespace gazetrace {

DensityModel log_polar_model(double sigma, double alpha, const PlanarView& view, const Vec3d& gaze_direction) {
  const double buffer_px = static_cast<double>(view.width_px) * view.height_px / (sigma * sigma);
  const Vec2d gaze_px = view.pixel(gaze_direction);
  const double far_x = std::max(gaze_px.x, view.width_px - gaze_px.x);
  const double far_y = std::max(gaze_px.y, view.height_px - gaze_px.y);
  const double log_farthest = std::log(std::hypot(far_x, far_y));

  DensityModel model;
  model.quantity = DensityModel::Quantity::density;
  model.uses_radius = true;
  model.value = [=](const DensityPlace& place) {
    if (!std::isfinite(place.radius_px) || !std::isfinite(log_farthest)) {
      return 0.0;  // the gaze never meets the plane
    }
    if (!(log_farthest > 0)) {
      return 1.0;  // a frame within a pixel of the gaze
    }
    const double r = std::max(place.radius_px, 1.0);
    const double part = std::log(r) / log_farthest;
    if (part <= 0) {
      return alpha >= 1 ? 1.0 : 0.0;
    }
    return buffer_px / (2 * kPi * alpha * log_farthest * r * r) * std::pow(part, 1 / alpha - 1);
  };
  return model;
}

}  // namespace gazetrace
