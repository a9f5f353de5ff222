// SPDX-License-Identifier: Apache-2.0
// Helpers for drawing diagrams as SVG: axes and their ticks, escaped text and embedded files.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace gazetrace {

// A linear map from values to positions in the picture.
struct Axis {
  double low = 0, high = 1;   // values
  double begin = 0, end = 1;  // picture
  [[nodiscard]] double at(double value) const { return begin + (value - low) / (high - low) * (end - begin); }
  // The distance between ticks, 1, 2 or 5 times a power of ten, for about `count` ticks.
  [[nodiscard]] double tick(double count) const {
    const double rough = std::abs(high - low) / count;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double digit = rough / power;
    return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
  }
};

// About `count` round values on an axis, at most 40.
std::vector<double> ticks(const Axis& axis, double count);
std::string escaped(const std::string& text);
std::string base64(const std::string& bytes);

}  // namespace gazetrace
