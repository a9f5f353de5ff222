// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"

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

}  // namespace

const std::vector<NamedDisplay>& named_displays() {
  static const std::vector<NamedDisplay> displays{
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
  return displays;
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
