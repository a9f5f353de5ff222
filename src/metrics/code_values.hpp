// SPDX-License-Identifier: Apache-2.0
// The luma of code values, and the light that a display makes of them.
#pragma once

#include "gazetrace/image.hpp"
#include "gazetrace/metrics.hpp"

namespace gazetrace {

// ITU-R BT.601 luma of code values.
inline double luma_601(const Vec3f& code) {
  return 0.299 * static_cast<double>(code.x) + 0.587 * static_cast<double>(code.y) +
         0.114 * static_cast<double>(code.z);
}

// The light of a picture of code values, relative to the peak; 8-bit code values go through a table.
ImageRgb light_of_code(const ImageRgb& code, DisplayResponse response, double peak_cd_m2, int threads);

}  // namespace gazetrace
