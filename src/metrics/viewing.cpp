// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP's photometry and geometry (section 3.1 of the paper).
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {
namespace {

constexpr double kMetrePerInch = 0.0254;
constexpr double kLeastLuminance = 0.005;

double deg_of_atan(double tangent) {
  return std::atan(tangent) * kDegPerRad;
}

template <class Channel>
ImageGray luminance_of(const ImageRgb& image, int threads, const Channel& channel) {
  ImageGray luminance(image.width_px, image.height_px);
  parallel_for(static_cast<std::size_t>(image.height_px), threads, [&](std::size_t row) {
    const std::size_t from = row * static_cast<std::size_t>(image.width_px);
    for (std::size_t i = from; i < from + static_cast<std::size_t>(image.width_px); ++i) {
      const Vec3f& p = image.pixels[i];
      luminance.pixels[i] =
          static_cast<float>(0.2126729 * channel(p.x) + 0.7151522 * channel(p.y) + 0.0721750 * channel(p.z));
    }
  });
  return luminance;
}

}  // namespace

double black_level_cd_m2(const DisplayPhotometry& photometry) {
  return photometry.ambient_lux / kPi * photometry.reflectivity + photometry.peak_cd_m2 / photometry.contrast;
}

ImageGray display_luminance(const ImageRgb& code, const DisplayPhotometry& photometry, int threads) {
  const double black = black_level_cd_m2(photometry);
  const double peak = photometry.peak_cd_m2;
  if (photometry.response == DisplayResponse::linear_hdr) {
    return linear_luminance(code, 1, peak, black, threads);
  }
  // Absolute codes state the light itself, up to the peak, to which the room adds; relative codes fill the range from
  // black to peak.
  const double range = is_absolute(photometry.response) ? peak : peak - black;
  const auto level = [&](double v) {
    const double light = range * display_light(photometry.response, v, peak);
    return (is_absolute(photometry.response) ? std::max(light, kLeastLuminance) : light) + black;
  };
  // A table for 8-bit code values, which are the usual case.
  std::array<float, 256> codes{};
  std::array<double, 256> levels{};
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = static_cast<float>(i) / 255.0F;
    levels[i] = level(static_cast<double>(i) / 255.0);
  }
  return luminance_of(code, threads, [&](float v) {
    const auto i = static_cast<std::size_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F));
    return codes[i] == v ? levels[i] : level(static_cast<double>(v));
  });
}

ImageGray linear_luminance(const ImageRgb& light, double scale, double most_cd_m2, double black_cd_m2, int threads) {
  return luminance_of(light, threads, [&](float v) {
    return std::clamp(scale * static_cast<double>(v), kLeastLuminance, most_cd_m2) + black_cd_m2;
  });
}

double FovVideoVdpGeometry::pixels_per_degree() const {
  return 1 / (2 * deg_of_atan(0.5 * width_m / (width_px * distance_m)));
}

Vec2d FovVideoVdpGeometry::view_direction_deg(double x, double y, int raster_width, int raster_height) const {
  return {deg_of_atan(((x - 0.5 * raster_width) * width_m / raster_width + right_m) / distance_m),
          deg_of_atan((-(y - 0.5 * raster_height) * height_m / raster_height + up_m) / distance_m)};
}

double FovVideoVdpGeometry::magnification(const Vec2d& direction_deg) const {
  constexpr double kMostDeg = 89.9;
  const double a = std::min(std::hypot(direction_deg.x, direction_deg.y), kMostDeg) * kRadPerDeg;
  const double delta = 0.5 / pixels_per_degree() * kRadPerDeg;
  // (tan(a + delta) - tan a) / tan delta, written without cancellation.
  return std::cos(delta) / (std::cos(a + delta) * std::cos(a));
}

FovVideoVdpGeometry fovvideovdp_geometry(const DisplayGeometry& display) {
  constexpr double kMetrePerCentimetre = 0.01;
  return {display.width_px,
          display.height_px,
          kMetrePerCentimetre * display.width_cm,
          kMetrePerCentimetre * display.height_cm,
          kMetrePerCentimetre * display.distance_cm,
          kMetrePerCentimetre * -display.eye_x_cm,
          kMetrePerCentimetre * -display.eye_y_cm};
}

FovVideoVdpGeometry fovvideovdp_geometry(const PlanarView& view) {
  // How far the middle lies off the perpendicular from the eye, from one border and half the size. A rounding error
  // becomes exactly 0, so that a centered picture scores bit for bit as in the geometry of the metric's authors.
  const auto middle_m = [](double border_m, double half_m) {
    constexpr double kRounding = 1e-9;
    const double middle = border_m + half_m;
    return std::fabs(middle) < kRounding * std::fabs(half_m) ? 0 : middle;
  };
  const double width_m = view.step_x * view.width_px;
  const double height_m = view.step_y * view.height_px;
  return {view.width_px,
          view.height_px,
          width_m,
          height_m,
          1,
          middle_m(view.left, width_m / 2),
          middle_m(view.top, -height_m / 2)};
}

FovVideoVdpGeometry geometry_from_diagonal(int width_px, int height_px, double diagonal_inches, double distance_m) {
  const double aspect = static_cast<double>(width_px) / height_px;
  const double height_m = diagonal_inches * kMetrePerInch / std::sqrt(1 + aspect * aspect);
  return {width_px, height_px, aspect * height_m, height_m, distance_m};
}

FovVideoVdpGeometry geometry_from_horizontal_fov(int width_px, int height_px, double fov_deg, double distance_m) {
  const double width_m = 2 * distance_m * std::tan(fov_deg / 2 * kRadPerDeg);
  return {width_px, height_px, width_m, width_m * height_px / width_px, distance_m};
}

FovVideoVdpGeometry geometry_from_diagonal_fov(int width_px, int height_px, double fov_deg, double distance_m) {
  const double eye_px = std::hypot(width_px, height_px) / (2 * std::tan(fov_deg / 2 * kRadPerDeg));
  const double height_m = 2 * distance_m * (height_px / 2.0 / eye_px);
  return {width_px, height_px, height_m * width_px / height_px, height_m, distance_m};
}

}  // namespace gazetrace
