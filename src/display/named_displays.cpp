// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/headsets.hpp"

namespace gazetrace {
namespace {

constexpr double kCmPerInch = 2.54;

// Monitors are sold by the diagonal of the active area; pixels are square.
DisplayGeometry from_diagonal(int width_px, int height_px, double diagonal_inch, double distance_cm,
                              double luminance_cd_m2 = 0) {
  const double cm_per_px = diagonal_inch * kCmPerInch / std::hypot(width_px, height_px);
  return {.width_px = width_px,
          .height_px = height_px,
          .width_cm = width_px * cm_per_px,
          .height_cm = height_px * cm_per_px,
          .distance_cm = distance_cm,
          .luminance_cd_m2 = luminance_cd_m2};
}

// Where FovVideoVDP's model of a headset states the angle over the diagonal of a flat screen.
double pixels_per_degree_of_diagonal(int width_px, int height_px, double diagonal_deg) {
  return std::hypot(width_px, height_px) / (2 * std::tan(diagonal_deg / 2 * kRadPerDeg)) * kRadPerDeg;
}

NamedDisplay display_of(const Headset& headset) {
  const std::string field = headset.field_deg.y > 0
                                ? fmt::format("{:g} x {:g}", headset.field_deg.x, headset.field_deg.y)
                                : fmt::format("{:g}", headset.field_deg.x);
  DisplayGeometry geometry = display_of_pixels_per_degree(headset.width_px, headset.height_px,
                                                          {headset.pixels_per_degree, headset.pixels_per_degree});
  geometry.luminance_cd_m2 = headset.luminance_cd_m2;
  return {headset.display,
          fmt::format("{}, one eye: {}x{}, {:.3g} pixels a degree ({}); field {} deg, up to {:g} Hz", headset.model,
                      headset.width_px, headset.height_px, headset.pixels_per_degree, headset.density, field,
                      headset.rate_hz),
          geometry};
}

std::vector<NamedDisplay> all_displays() {
  std::vector<NamedDisplay> displays{
      {"paper",
       "3840x2160, 70.848 x 39.852 cm at 60 cm: the source paper",
       {.width_px = 3840, .height_px = 2160, .width_cm = 70.848, .height_cm = 39.852, .distance_cm = 60.0}},
      {"standard-4k", "30-inch 3840x2160 at 74.72 cm, 200 cd/m2: FovVideoVDP's standard_4k",
       from_diagonal(3840, 2160, 30.0, 74.72, 200)},
      {"standard-fhd", "24-inch 1920x1080 at 60 cm, 200 cd/m2: FovVideoVDP's standard_fhd",
       from_diagonal(1920, 1080, 24.0, 60.0, 200)},
      {"24in-4k", "24-inch 3840x2160 at 60 cm", from_diagonal(3840, 2160, 24.0, 60.0)},
      {"27in-1440p", "27-inch 2560x1440 at 60 cm", from_diagonal(2560, 1440, 27.0, 60.0)},
      {"27in-4k", "27-inch 3840x2160 at 60 cm", from_diagonal(3840, 2160, 27.0, 60.0)},
      {"tx300",
       "1920x1080, 50.9174 x 28.6411 cm at 65 cm: the monitor of a Tobii TX300",
       {.width_px = 1920, .height_px = 1080, .width_cm = 50.9174, .height_cm = 28.6411, .distance_cm = 65.0}},
  };
  for (const Headset& headset : headsets()) {
    displays.push_back(display_of(headset));
  }
  return displays;
}

}  // namespace

const std::vector<Headset>& headsets() {
  static const std::vector<Headset> kHeadsets{
      {"quest-3",
       "Meta Quest 3",
       2064,
       2208,
       25,
       "mean over the field",
       {110, 96},
       120,
       0,
       "Meta's specifications, as in Road to VR's review (pixels, field, rate); iFixit, Vision Pro teardown, part 2 "
       "(pixels a degree)"},
      {"quest-pro",
       "Meta Quest Pro",
       1800,
       1920,
       22,
       "mean over the field",
       {106, 96},
       90,
       0,
       "Meta's page of specifications"},
      {"vive-pro-eye",
       "HTC Vive Pro Eye",
       1440,
       1600,
       pixels_per_degree_of_diagonal(1440, 1600, 110),
       "of a flat screen of 110 deg over its diagonal",
       {110, 0},
       90,
       133.3,
       "HTC's page of specifications (pixels, rate); FovVideoVDP's display model htc_vive_pro, of the same panels and "
       "lenses (diagonal, luminance)"},
      {"varjo-xr-4",
       "Varjo XR-4",
       3840,
       3744,
       51,
       "at the centre",
       {120, 105},
       90,
       200,
       "Varjo's specifications, as in UploadVR's report on the XR-4 series of November 2023"},
      {"vision-pro",
       "Apple Vision Pro",
       3660,
       3200,
       44.4,
       "at the centre",
       {100, 0},
       100,
       0,
       "iFixit, Vision Pro teardown, part 2 (pixels, field); K. Guttag, kguttag.com, 2024 (pixels a degree, "
       "measured); Apple's page of specifications (rate)"},
      {"index",
       "Valve Index",
       1440,
       1600,
       15,
       "forward, estimated",
       {130, 0},
       144,
       0,
       "Valve's page of specifications (pixels, rate, field \"20 degrees more than the HTC Vive\", whose page has "
       "110); "
       "O. Kreylos, doc-ok.org, 16 April 2020 (pixels a degree)"},
  };
  return kHeadsets;
}

const std::vector<NamedDisplay>& named_displays() {
  static const std::vector<NamedDisplay> kDisplays = all_displays();
  return kDisplays;
}

DisplayGeometry display_by_name(std::string_view name) {
  const auto& displays = named_displays();
  const auto found =
      std::find_if(displays.begin(), displays.end(), [&](const NamedDisplay& d) { return d.name == name; });
  if (found == displays.end()) {
    std::vector<std::string> names;
    names.reserve(displays.size());
    for (const NamedDisplay& display : displays) {
      names.push_back(display.name);
    }
    throw Error(ErrorKind::usage, "", unknown_name_message("display", name, names));
  }
  return found->geometry;
}

}  // namespace gazetrace
