// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

struct OneEuroSettings {
  double min_cutoff_hz = 1;
  double beta = 0;  // per unit of x in a second
  double d_cutoff_hz = 1;
};

// The 1 euro filter, algorithm 1 of Casiez, Roussel & Vogel, CHI 2012, applied to points. The speed that raises the
// cutoff is the length of the filtered derivative, so that the filter does not depend on the axes.
//   dx = (x - x^ before) / T,  dx^ = lowpass(dx, d_cutoff),  cutoff = min_cutoff + beta |dx^|,
//   x^ = lowpass(x, cutoff),   lowpass: a x + (1 - a) x^ before, a = 1 / (1 + 1 / (2 pi cutoff T))
// Times must increase.
std::vector<Vec3d> one_euro_filter(const std::vector<std::int64_t>& t_ns, const std::vector<Vec3d>& x,
                                   const OneEuroSettings& settings);

}  // namespace gazetrace
