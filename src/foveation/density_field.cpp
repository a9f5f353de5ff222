// SPDX-License-Identifier: Apache-2.0
#include "foveation/density_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "foveation/picture.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// The horizontal direction to the right of the gaze, in the eye's frame; for a gaze straight up or down, the eye's own.
Vec3d right_of(const Vec3d& gaze) {
  const Vec3d right = cross(gaze, Vec3d{0, 1, 0});
  const double size = length(right);
  return size > 1e-12 ? right / size : Vec3d{1, 0, 0};
}

// The factor from a squared cut-off frequency to a density. Two pixels are the shortest cycle that a display shows, so
// f_disp = pixels per degree / 2, separately for either axis.
double density_per_cpd2(const PlanarView& view, const DensityModel& model) {
  if (model.quantity == DensityModel::Quantity::density) {
    return 1;
  }
  if (model.relative_to_fovea) {
    const double foveal = model.value({});
    if (!(foveal > 0) || !std::isfinite(foveal)) {
      throw Error(ErrorKind::usage, "`density`",
                  "the model's cut-off at the gaze itself is " + std::string(foveal > 0 ? "infinite" : "zero"),
                  "take it relative-to=display");
    }
    return 1 / (foveal * foveal);
  }
  const double plane_per_degree = std::tan(kRadPerDeg);
  return 4 * view.step_x * view.step_y / (plane_per_degree * plane_per_degree);
}

}  // namespace

DensityField::DensityField(const PlanarView& view, const Vec3d& gaze_direction, const MapContext& context,
                           DensityModel model)
    : view_(&view),
      picture_(model.from_picture ? context.density : nullptr),
      model_(std::move(model)),
      gaze_(gaze_direction / length(gaze_direction)),
      right_(right_of(gaze_)),
      up_(cross(right_, gaze_)),
      gaze_px_(view.pixel(gaze_)),
      floor_(model_.floor),
      step_deg_(std::max(view.step_x, view.step_y) * kDegPerRad),
      per_cpd2_(density_per_cpd2(view, model_)),
      shrinks_(model_.quantity == DensityModel::Quantity::cutoff_cpd && !model_.relative_to_fovea) {
  if (picture_ != nullptr) {
    per_picture_value_ = 1 / full_rate_of_picture(context);
  }
}

Vec2d DensityField::meridian(const Vec3d& direction) const {
  const double x = dot(direction, right_);
  const double y = dot(direction, up_);
  const double size = std::hypot(x, y);
  return size > 0 ? Vec2d{x / size, y / size} : Vec2d{1, 0};
}

DensityField::Seen DensityField::seen(double x_px, double y_px) const {
  Seen seen;
  seen.direction = view_->direction(x_px, y_px);
  seen.place.eccentricity_deg = angle_between_rad(gaze_, seen.direction) * kDegPerRad;
  if (model_.uses_meridian) {
    seen.place.meridian = meridian(seen.direction);
  }
  if (model_.uses_radius) {
    const double radius_px = std::hypot(x_px - gaze_px_.x, y_px - gaze_px_.y);
    seen.place.radius_px = std::isfinite(radius_px) ? radius_px : std::numeric_limits<double>::infinity();
  }
  return seen;
}

double DensityField::density(const DensityPlace& place, double cos_off_axis) const {
  double value = model_.value(place);
  if (model_.quantity == DensityModel::Quantity::cutoff_cpd) {
    const double solid_angle = shrinks_ ? cos_off_axis * cos_off_axis * cos_off_axis : 1.0;
    value *= value * per_cpd2_ * solid_angle;
  }
  return std::min(1.0, value);
}

double DensityField::limited(double density) const {
  return std::clamp(density, floor_, 1.0);
}

double DensityField::at(double x_px, double y_px) const {
  const Seen point = seen(x_px, y_px);
  double value = density(point.place, 1 / length(point.direction));
  if (picture_ != nullptr) {
    value *= picture_at(*picture_, x_px / view_->width_px, y_px / view_->height_px) * per_picture_value_;
  }
  return limited(value);
}

double DensityField::over(int x_px, int y_px, int x_end_px, int y_end_px) const {
  if (picture_ == nullptr) {
    return at(0.5 * (x_px + x_end_px), 0.5 * (y_px + y_end_px));
  }
  double sum = 0;
  for (int y = y_px; y < y_end_px; ++y) {
    for (int x = x_px; x < x_end_px; ++x) {
      sum += at(x + 0.5, y + 0.5);
    }
  }
  return sum / (static_cast<double>(x_end_px - x_px) * (y_end_px - y_px));
}

DensityField::Bounds DensityField::within(int x_px, int y_px, int side_px) const {
  const double half = 0.5 * side_px;
  const double x = x_px + half;
  const double y = y_px + half;
  const Seen center = seen(x, y);
  const double reach_px = half * std::sqrt(2.0);
  const double reach_deg = reach_px * step_deg_;
  const double distance = length(center.direction);
  const double reach = reach_deg * kRadPerDeg;
  const double most_cos = 1 / std::max(1.0, distance - reach);
  const double least_cos = 1 / (distance + reach);

  std::array<Vec2d, 5> meridians{center.place.meridian};
  std::size_t directions = 1;
  // Far from the gaze, all of a square lies in about one direction.
  if (model_.uses_meridian && center.place.eccentricity_deg < 16 * reach_deg) {
    for (const auto& [dx, dy] : {std::pair{-half, -half}, {half, -half}, {-half, half}, {half, half}}) {
      meridians.at(directions++) = meridian(view_->direction(x + dx, y + dy));
    }
  }
  Bounds bounds{std::numeric_limits<double>::infinity(), 0};
  const auto look = [&](const DensityPlace& place) {
    bounds.most = std::max(bounds.most, density(place, most_cos));
    bounds.least = std::min(bounds.least, density(place, least_cos));
  };
  for (std::size_t d = 0; d < directions; ++d) {
    DensityPlace place = center.place;
    place.meridian = meridians.at(d);
    for (const double step : {-1.0, 0.0, 1.0}) {
      place.eccentricity_deg = std::clamp(center.place.eccentricity_deg + step * reach_deg, 0.0, 180.0);
      place.radius_px = std::max(0.0, center.place.radius_px + step * reach_px);
      look(place);
    }
    for (const double turn_deg : model_.turns_deg) {
      if (std::abs(turn_deg - center.place.eccentricity_deg) < reach_deg) {
        place.eccentricity_deg = turn_deg;
        look(place);
      }
    }
  }
  if (picture_ != nullptr) {
    const auto width_px = static_cast<double>(view_->width_px);
    const auto height_px = static_cast<double>(view_->height_px);
    const auto [least, most] = picture_within(*picture_, x_px / width_px, y_px / height_px, (x_px + side_px) / width_px,
                                              (y_px + side_px) / height_px);
    bounds.least *= least * per_picture_value_;
    bounds.most *= most * per_picture_value_;
  }
  return {limited(bounds.least), limited(bounds.most)};
}

}  // namespace gazetrace
