// SPDX-License-Identifier: Apache-2.0
// Densities as text, and the models behind them.
#include "gazetrace/density.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "foveation/densities.hpp"
#include "foveation/density_curve.hpp"
#include "foveation/named_values.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kPlace = "`density`";

const NamedDensity& density_by_name(std::string_view name, const std::string& place = kPlace) {
  return find_named(named_densities(), name, "density", place,
                    "give one of these, or a file: .csv for a curve, .exr for a picture");
}

DensitySampling named_density(std::string_view text, const std::string& place) {
  const NamedText named = split_named_text(text);
  const NamedDensity& entry = density_by_name(named.name, place);
  DensitySampling density;
  density.model = entry.name;
  density.values = parse_values(named.values, entry.parameters, place);
  if (entry.is_ramp && !(density.values[0] < density.values[1])) {
    throw Error(ErrorKind::usage, place,
                fmt::format("inner={} is not less than outer={}", density.values[0], density.values[1]));
  }
  return density;
}

// Monotone cubic interpolation, by which any other model can be reproduced; the first and last value are held beyond
// the ends.
DensityModel curve_model(const DensityCurve& curve) {
  DensityModel model;
  model.quantity = DensityModel::Quantity::density;
  model.value = [cubic = std::make_shared<const MonotoneCubic>(curve.points)](const DensityPlace& place) {
    return (*cubic)(place.eccentricity_deg);
  };
  for (const Vec2d& point : curve.points) {
    model.turns_deg.push_back(point.x);  // monotone in between
  }
  return model;
}

}  // namespace

std::vector<DensityInfo> densities() {
  return {named_densities().begin(), named_densities().end()};
}

DensitySampling parse_density(std::string_view text, const std::string& place) {
  DensitySampling density;
  if (text.ends_with(".csv")) {
    density.model.clear();
    density.curve = load_density_curve(std::string(text));
    return density;
  }
  if (text.ends_with(".exr")) {
    density = density_of_picture();
    density.picture_files = text;
    return density;
  }
  return named_density(text, place);
}

std::string to_string(const DensitySampling& density) {
  if (density.model.empty()) {
    return density.from_picture ? density.picture_files : density.curve.path;
  }
  return density.model + values_text(density.values, density_by_name(density.model).parameters);
}

DensitySampling density_of_picture() {
  DensitySampling density;
  density.model.clear();
  density.from_picture = true;
  return density;
}

void check_density(const DensitySampling& density) {
  if (density.from_picture) {
    return;
  }
  if (!density.model.empty()) {
    const std::size_t parameters = density_by_name(density.model).parameters.size();
    if (!density.values.empty() && density.values.size() != parameters) {
      throw Error(ErrorKind::usage, kPlace,
                  fmt::format("{} has {} parameters, and {} values are given", density.model, parameters,
                              density.values.size()),
                  "give all of them, or none");
    }
    named_density(to_string(density), kPlace);
    return;
  }
  const std::vector<Vec2d>& points = density.curve.points;
  if (points.empty()) {
    throw Error(ErrorKind::usage, kPlace, "there is neither a name nor a curve", "name a CSV of ecc_deg,density");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool in_order = std::isfinite(points[i].x) && (i == 0 || points[i].x > points[i - 1].x);
    if (!in_order || !(points[i].y >= 0 && points[i].y <= 1)) {
      throw Error(ErrorKind::usage, kPlace, fmt::format("point {} is out of order or its density not in 0 to 1", i + 1),
                  "sort the points by eccentricity, each once");
    }
  }
}

DensityModel density_model(const DensitySampling& density, const PlanarView& view, const Vec3d& gaze_direction) {
  DensityModel model;
  if (density.from_picture) {
    model = picture_density();
  } else if (density.model.empty()) {
    model = curve_model(density.curve);
  } else {
    const NamedDensity& named = density_by_name(density.model);
    const std::vector<double> values =
        density.values.empty() ? parse_values("", named.parameters, kPlace) : density.values;
    model = named.model({values, view, gaze_direction});
    model.relative_to_fovea = named.parameters.back().name == kRelativeTo && values.back() != 0;
  }
  model.full_rate_spp = density.full_rate_spp;
  model.floor = density.least_density;
  return model;
}

std::optional<double> cutoff_cpd(const DensitySampling& density, double eccentricity_deg, double meridian_deg) {
  check_density(density);
  // A cut-off does not depend on how the eye sees the frame, so any view will do.
  const DensityModel model = density_model(density, view_of_perspective(1, 2, 2), {0, 0, -1});
  if (model.quantity != DensityModel::Quantity::cutoff_cpd) {
    return std::nullopt;
  }
  const double meridian_rad = meridian_deg * kRadPerDeg;
  return model.value({eccentricity_deg, {std::cos(meridian_rad), std::sin(meridian_rad)}, 0});
}

}  // namespace gazetrace
