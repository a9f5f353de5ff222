// SPDX-License-Identifier: Apache-2.0
#include "study/report/heat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace gazetrace {
namespace {

constexpr int kHeatLevels = 8;

// From a level of 0..1 to a color that gets lighter all the way: a coarse "inferno" (van der Walt & Smith 2015).
const char* heat_color(double level) {
  static constexpr std::array<const char*, 8> kColors{"#420a68", "#6b176e", "#932667", "#bb3754",
                                                      "#dd513a", "#f37819", "#fca50a", "#f6d746"};
  return kColors[std::min<std::size_t>(static_cast<std::size_t>(level * 8), 7)];
}

}  // namespace

double lowest_drawn(const HeatGrid& grid) {
  return grid.highest / (kHeatLevels + 1);
}

void draw_heat(Drawing& svg, const HeatGrid& grid, const Axis& x_axis, const Axis& y_axis, const std::string& unit) {
  const double cell_x = (x_axis.end - x_axis.begin) / static_cast<double>(grid.columns);
  const double cell_y = (y_axis.end - y_axis.begin) / static_cast<double>(grid.rows);
  std::array<std::string, kHeatLevels + 1> paths;
  const auto level_at = [&](std::size_t row, std::size_t column) {
    return std::min(static_cast<int>(grid.values[row * grid.columns + column] / grid.highest * (kHeatLevels + 1)),
                    kHeatLevels);
  };
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns;) {
      const int level = level_at(row, column);
      std::size_t end = column + 1;
      while (end < grid.columns && level_at(row, end) == level) {
        ++end;
      }
      fmt::format_to(std::back_inserter(paths[static_cast<std::size_t>(level)]), "M{:.1f} {:.1f}h{:.1f}v{:.2f}h{:.1f}z",
                     x_axis.begin + cell_x * static_cast<double>(column),
                     y_axis.begin + cell_y * static_cast<double>(row), cell_x * static_cast<double>(end - column),
                     cell_y + 0.05, -cell_x * static_cast<double>(end - column));
      column = end;
    }
  }
  for (int level = 1; level <= kHeatLevels; ++level) {
    const double share = (level - 0.5) / kHeatLevels;
    svg.add(fmt::format(R"(<path d="{}" fill="{}" fill-opacity="{:.2f}"/>)", paths[static_cast<std::size_t>(level)],
                        heat_color(share), 0.45 + 0.35 * share));
  }
  const double y = y_axis.end + 14;
  for (int level = 1; level <= kHeatLevels; ++level) {
    svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="26" height="12" fill="{}"/>)",
                        x_axis.begin + 26 * (level - 1), y, heat_color((level - 0.5) / kHeatLevels)));
  }
  svg.text(x_axis.begin + 26 * kHeatLevels + 10, y + 11,
           fmt::format("{:.2g} to {:.2g} {}", lowest_drawn(grid), grid.highest, unit));
}

}  // namespace gazetrace
