// SPDX-License-Identifier: Apache-2.0
// What a fall-off model returns: regions, and the region of each pixel. Sites and tiles follow from it in one place.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

struct LayoutRegion {
  std::string name;
  int block_px = 1;
  std::uint32_t tau = 1;  // samples of a block, or of a pixel, by `unit`
  SampleUnit unit = SampleUnit::per_block;
};

struct Layout {
  std::vector<LayoutRegion> regions;
  Image<std::uint8_t> region;
};

// One function `layout_<name>` per line of falloffs.def. `gaze_direction` is finite and not zero.
#define FALLOFF(name, description) \
  Layout layout_##name(const FoveationSettings& settings, const PlanarView& view, const Vec3d& gaze_direction);
#include "foveation/falloffs.def"
#undef FALLOFF

// `samples_per_pixel` at every pixel: the fall-off "uniform", and any frame without gaze.
Layout uniform_layout(std::uint32_t samples_per_pixel, int width_px, int height_px);

}  // namespace gazetrace
