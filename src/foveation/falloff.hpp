// SPDX-License-Identifier: Apache-2.0
// A fall-off model returns one of two things: a layout, which assigns each pixel to a region with whole rates, or a
// density, from which blocks.hpp and whole_counts.hpp make blocks and counts.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

struct LayoutRegion {
  std::string name;
  int block_px = 1;
  std::uint32_t tau = 1;  // samples per block or per pixel, as `unit` says
  SampleUnit unit = SampleUnit::per_block;
};

struct Layout {
  std::vector<LayoutRegion> regions;
  Image<std::uint8_t> region;
};

// A place as a density model sees it.
struct FalloffPlace {
  double eccentricity_deg = 0;
  Vec2d meridian{1, 0};  // unit vector from the gaze in the visual field, right and up; set only for `uses_meridian`
  double radius_px = 0;  // from the gaze point in the frame's plane, infinite without one; set only for `uses_radius`
};

struct DensityModel {
  enum class Quantity : std::uint8_t {
    cutoff_cpd,  // highest visible frequency, >= 0, may be infinite; the density is its square, normalized
    density      // relative to the full rate, >= 0
  };
  Quantity quantity = Quantity::cutoff_cpd;
  std::function<double(const FalloffPlace&)> value;
  bool uses_meridian = false, uses_radius = false;
  bool from_picture = false;            // MapContext::density over its largest value multiplies the value
  std::optional<double> full_rate_spp;  // default: the settings' uniform_spp
  // To which the default floor and the default samples of a block give way (with_limits_of).
  double own_floor = 1;
  std::optional<double> own_block_samples;
  // Eccentricities at which the value may change from falling to rising or back.
  std::vector<double> turns_deg;
};

using Falloff = std::variant<Layout, DensityModel>;

// One function `falloff_<file>` per line of falloffs.def. `gaze_direction` is finite and not zero.
#define FALLOFF(file, name, description) \
  Falloff falloff_##file(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction);
#include "foveation/falloffs.def"
#undef FALLOFF

// The settings with the density floor and the samples of a block that hold for this model.
FoveationSettings with_limits_of(const DensityModel& model, const FoveationSettings& settings);

// The fall-off that the settings name; check_foveation must have accepted them.
Falloff make_falloff(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction);

// `samples_per_pixel` at every pixel, for the fall-off "uniform" and for any frame without gaze.
Layout uniform_layout(std::uint32_t samples_per_pixel, int width_px, int height_px);

// A model of the cut-off frequency, or of the density, that is the same in every direction.
template <class Cutoff>
DensityModel isotropic_cutoff(const Cutoff& cutoff) {
  DensityModel model;
  model.value = [cutoff](const FalloffPlace& place) { return cutoff(place.eccentricity_deg); };
  return model;
}
template <class Density>
DensityModel isotropic_density(const Density& density) {
  DensityModel model;
  model.quantity = DensityModel::Quantity::density;
  model.value = [density](const FalloffPlace& place) { return density(place.eccentricity_deg); };
  return model;
}

// A model that follows MapContext::density.
inline DensityModel picture_density() {
  DensityModel model = isotropic_density([](double) { return 1.0; });
  model.from_picture = true;
  return model;
}

}  // namespace gazetrace
