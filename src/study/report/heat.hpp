// SPDX-License-Identifier: Apache-2.0
// Heat maps: a grid of values over a picture, drawn in a few levels.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/report/drawing.hpp"

namespace gazetrace {

// Free space around a map, and below it, where its scale stands.
inline constexpr double kHeatMargin = 10, kBelowHeat = 46;

struct HeatGrid {
  std::size_t columns = 240, rows = 135;
  std::vector<double> values;  // row by row, such as seconds of fixation per square degree
  double highest = 0;
};

// The value below which nothing is drawn.
double lowest_drawn(const HeatGrid& grid);

// Fills the rectangle of the axes from the upper left corner on, and puts the scale below it. Nothing where `highest`
// is 0.
void draw_heat(Drawing& svg, const HeatGrid& grid, const Axis& x_axis, const Axis& y_axis, const std::string& unit);

}  // namespace gazetrace
