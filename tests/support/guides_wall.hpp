// SPDX-License-Identifier: Apache-2.0
// First hits on the simplest of surfaces, for tests of filters that see them.
#pragma once

#include <cstdint>

#include "gazetrace/guides.hpp"

namespace gazetrace {

inline constexpr int kGuidesWallPx = 64;  // a side

// A grey wall 10 m ahead, seen by parallel rays, one millimetre a pixel.
inline Guides wall() {
  Guides guides;
  guides.camera = {false, {0, 0, -1}, {0.001F, 0, 0}, {0, 0.001F, 0}};
  guides.albedo = ImageRgb(kGuidesWallPx, kGuidesWallPx, {0.5F, 0.5F, 0.5F});
  guides.normal = ImageRgb(kGuidesWallPx, kGuidesWallPx, {0, 0, 1});
  guides.depth_m = ImageGray(kGuidesWallPx, kGuidesWallPx, 10);
  guides.emission = ImageRgb(kGuidesWallPx, kGuidesWallPx);
  guides.object = Image<std::uint32_t>(kGuidesWallPx, kGuidesWallPx, 1);
  guides.material = Image<std::uint32_t>(kGuidesWallPx, kGuidesWallPx, 1);
  guides.kind = Image<SurfaceKind>(kGuidesWallPx, kGuidesWallPx, SurfaceKind::diffuse);
  return guides;
}

}  // namespace gazetrace
