// SPDX-License-Identifier: Apache-2.0
// Every sampling that follows no picture, by name: "uniform", "regions", the named densities and "curve".
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

inline DensitySampling a_curve(std::vector<Vec2d> points = {{0, 1}, {5, 0.5}, {20, 0.1}, {60, 0.02}}) {
  DensitySampling density;
  density.model.clear();
  density.curve.points = std::move(points);
  return density;
}

// "mar:slope=0.03" and the like, too.
inline FoveationSettings model(const std::string& name) {
  FoveationSettings settings;
  if (name == "curve") {
    settings.sampling = a_curve();
  } else if (name == "uniform" || name == "regions") {
    settings.sampling = parse_sampling(name);
  } else {
    settings.sampling = parse_density(name);
  }
  return settings;
}

// So few pixels as tests have show little: measured against them, most cut-offs would be flat.
inline FoveationSettings model_relative_to_fovea(const std::string& name) {
  return model(name == "curve" || name == "uniform" || name == "regions" || !cutoff_cpd(parse_density(name), 1)
                   ? name
                   : name + ":relative-to=fovea");
}

inline DensitySampling& density_of(FoveationSettings& settings) {
  return std::get<DensitySampling>(settings.sampling);
}
inline RegionSampling& regions_in(FoveationSettings& settings) {
  return std::get<RegionSampling>(settings.sampling);
}

inline std::vector<std::string> density_models() {
  std::vector<std::string> names{"curve"};
  for (const DensityInfo& info : densities()) {
    names.push_back(info.name);
  }
  return names;
}
inline std::vector<std::string> all_models() {
  std::vector<std::string> names = density_models();
  names.insert(names.end(), {"uniform", "regions"});
  return names;
}

}  // namespace gazetrace
