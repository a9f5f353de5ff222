// SPDX-License-Identifier: Apache-2.0
// The model of a sampling is one of two things: a layout, which assigns each pixel to a region with whole rates, or a
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
struct DensityPlace {
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
  std::function<double(const DensityPlace&)> value;
  bool uses_meridian = false, uses_radius = false;
  bool relative_to_fovea = false;    // a cut-off's density is 1 at the gaze, whatever the display can show
  bool from_picture = false;         // MapContext::density over its largest value multiplies the value
  double full_rate_spp = kUsualSpp;  // where the density is 1
  double floor = kLeastDensity;
  std::optional<double> own_block_samples;  // the default of FoveationSettings::block_samples gives way to it
  // Eccentricities at which the value may change from falling to rising or back.
  std::vector<double> turns_deg;
};

using SamplingModel = std::variant<Layout, DensityModel>;

// The model of the settings' sampling, which check_foveation must have accepted. `gaze_direction` is finite and not
// zero.
SamplingModel sampling_model(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction);
Layout region_layout(const RegionSampling& regions, const PlanarView& view, const Vec3d& gaze_direction);
void check_density(const DensitySampling& density);  // Error(usage)
DensityModel density_model(const DensitySampling& density, const PlanarView& view, const Vec3d& gaze_direction);

// `samples_per_pixel` at every pixel.
Layout uniform_layout(std::uint32_t samples_per_pixel, int width_px, int height_px);

// Follows MapContext::density.
inline DensityModel picture_density() {
  DensityModel model;
  model.quantity = DensityModel::Quantity::density;
  model.value = [](const DensityPlace&) { return 1.0; };
  model.from_picture = true;
  return model;
}

}  // namespace gazetrace
