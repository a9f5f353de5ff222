// SPDX-License-Identifier: Apache-2.0
// How the density of samples falls with eccentricity: models of acuity by name, curves and pictures from files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Samples a pixel of uniform frames, and of a density model where the density is 1, if nothing else is asked for.
constexpr double kUsualSpp = 32;
constexpr double kLeastDensity = 1.0 / 512;

// A density over eccentricity: points (eccentricity in degrees, density 0..1) in ascending order.
struct DensityCurve {
  std::string path;  // the file it was read from; empty for one made in a program
  std::vector<Vec2d> points;
};
// Reads a CSV with the header line `ecc_deg,density`: eccentricities 0..180 in ascending order, densities in [0, 1].
// Error(input) with file:line.
DensityCurve load_density_curve(const std::string& path);

// A parameter of a density or a sampling. Where it has `words`, its value is the index of one of them.
struct NamedParameter {
  std::string name;
  double value = 0;  // the published or usual one
  double low = 0, high = 0;
  bool above_low = false;  // `low` itself is out of range
  std::vector<std::string> words;
};
struct DensityInfo {
  std::string name, description;
  std::vector<NamedParameter> parameters;
};
std::vector<DensityInfo> densities();

// The interface of every sampling.
struct SamplingTraits {
  const char* name;
  const char* description;
  bool needs_gaze = true;        // frames without gaze are uniform
  bool follows_picture = false;  // MapContext::density says where its samples go
  bool looks_first = false;      // that picture comes from a pilot of the frame, so counts are not known before
};

// Samples at a density: a model by name, else a curve, else a picture. A density is relative to a full rate; where
// FoveationSettings::spp is given, the rate follows from that.
struct DensitySampling {
  static constexpr SamplingTraits kTraits{
      .name = "density",
      .description = "a model of acuity, a curve or a picture (`density`) says where the samples go"};
  std::string model = "acuity";  // a name of densities(); empty: `curve`, or a picture
  std::vector<double> values;    // of its parameters, in their order; empty: as published
  DensityCurve curve;
  // MapContext::density says the density in samples a pixel, and its largest value is the full rate.
  bool from_picture = false;
  // The EXR that it is read from, or a pattern of files (frame_file_name()); empty: a program makes it.
  std::string picture_files;
  double full_rate_spp = kUsualSpp;      // of models and curves
  double least_density = kLeastDensity;  // anywhere, so that every place gets some samples
};
// Texts such as "acuity", "mar:slope=0.0275,foveal=0.0208"; a file whose name ends in .csv, which is read; or one that
// ends in .exr, with a place for the frame's number or without. Throws Error(usage) for unknown names and values out of
// range, and the errors of load_density_curve().
DensitySampling parse_density(std::string_view text, const std::string& place = "`density`");
// Its text, with those parameters that are not as published: parse_density(to_string(d)) gives the same density.
std::string to_string(const DensitySampling& density);
// Follows a picture that a program makes.
DensitySampling density_of_picture();

// The highest spatial frequency, in cycles per degree, that the eye sees at an eccentricity according to the model. The
// meridian is the direction from the gaze in the visual field: 0 right, 90 up, 180 left. Infinite at 0 degrees for
// "mar" without a foveal term; empty for models that state a density instead.
std::optional<double> cutoff_cpd(const DensitySampling& density, double eccentricity_deg, double meridian_deg = 0);

}  // namespace gazetrace
