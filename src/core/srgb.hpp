// SPDX-License-Identifier: Apache-2.0
// The transfer function of sRGB (IEC 61966-2-1), in whatever precision it is asked for.
#pragma once

#include <cmath>

namespace gazetrace {

template <class T>
T light_of_srgb(T code) {
  return code <= static_cast<T>(0.04045)
             ? code / static_cast<T>(12.92)
             : std::pow((code + static_cast<T>(0.055)) / static_cast<T>(1.055), static_cast<T>(2.4));
}

}  // namespace gazetrace
