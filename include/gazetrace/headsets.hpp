// SPDX-License-Identifier: Apache-2.0
// Headsets among the named displays, with their published data.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// As a display, a headset is the flat picture for one eye that has the panel's pixels and, in its middle, the headset's
// pixels per degree. Lenses spread the panel wider towards its edges, so that the headset's own field is larger.
struct Headset {
  std::string display;  // its name in named_displays()
  std::string model;
  int width_px = 0, height_px = 0;  // of one eye's panel
  double pixels_per_degree = 0;
  std::string density;  // the kind of pixels per degree: "at the centre", "mean over the field", ...
  Vec2d field_deg{};    // horizontally and vertically; y is 0 where one angle alone is stated
  double rate_hz = 0;   // the highest
  double luminance_cd_m2 = 0;
  std::string source;  // of all numbers
};
const std::vector<Headset>& headsets();

}  // namespace gazetrace
