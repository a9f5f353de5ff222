// SPDX-License-Identifier: Apache-2.0
// Monotone piecewise cubic interpolation: between two points the curve never leaves the interval of their values
// (Fritsch and Carlson, SIAM J. Numer. Anal. 17(2), 1980, with the slopes of Fritsch and Butland 1984).
#pragma once

#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

class MonotoneCubic {
 public:
  // At least one point, x strictly ascending.
  explicit MonotoneCubic(std::vector<Vec2d> points);
  // The end values are held beyond the ends.
  [[nodiscard]] double operator()(double x) const;

 private:
  std::vector<Vec2d> points_;
  std::vector<double> slopes_;
};

}  // namespace gazetrace
