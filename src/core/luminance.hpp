// SPDX-License-Identifier: Apache-2.0
// Relative luminance of linear Rec.709 colours (ITU-R BT.709-6, 3.2).
#pragma once

#include "gazetrace/math.hpp"

namespace gazetrace {

constexpr float luminance(const Vec3f& c) noexcept {
  return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z;
}
constexpr double luminance(const Vec3d& c) noexcept {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

}  // namespace gazetrace
