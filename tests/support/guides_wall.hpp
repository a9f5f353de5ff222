// SPDX-License-Identifier: Apache-2.0
// Guides and maps of a very simple surface, for tests of filters that use guides.
#pragma once

#include <cstdint>
#include <utility>

#include "core/hash.hpp"
#include "foveation/model.hpp"
#include "foveation/sites.hpp"
#include "gazetrace/guides.hpp"

namespace gazetrace {

inline constexpr int kGuidesWallPx = 64;  // width and height

// A grey wall 10 m ahead, seen by parallel rays at one millimetre per pixel.
inline Guides wall() {
  Guides guides;
  guides.camera = {false, {0, 0, -1}, {0.001F, 0, 0}, {0, 0.001F, 0}, {}};
  guides.albedo = ImageRgb(kGuidesWallPx, kGuidesWallPx, {0.5F, 0.5F, 0.5F});
  guides.normal = ImageRgb(kGuidesWallPx, kGuidesWallPx, {0, 0, 1});
  guides.depth_m = ImageGray(kGuidesWallPx, kGuidesWallPx, 10);
  guides.emission = ImageRgb(kGuidesWallPx, kGuidesWallPx);
  guides.object = Image<std::uint32_t>(kGuidesWallPx, kGuidesWallPx, 1);
  guides.material = Image<std::uint32_t>(kGuidesWallPx, kGuidesWallPx, 1);
  guides.kind = Image<SurfaceKind>(kGuidesWallPx, kGuidesWallPx, SurfaceKind::diffuse);
  return guides;
}

// Half the difference of the halves of a site: far above any light, of random sign.
inline float planted_noise(const Site& site) {
  return (hash32(site.block_x * 65536U + site.block_y) & 1U) != 0 ? 1e6F : -1e6F;
}

struct PixelSpan {
  int begin = 0, end = 0;  // half open
};

// A map with single pixels inside the spans, and blocks of 8 samples around them.
inline SamplingMap map_with_fovea(const PixelSpan& across, const PixelSpan& down, std::uint32_t foveal_samples,
                                  int block_px) {
  Layout layout;
  layout.regions = {{"fovea", 1, foveal_samples, SampleUnit::per_block},
                    {"periphery", block_px, 8, SampleUnit::per_block}};
  layout.region = Image<std::uint8_t>(kGuidesWallPx, kGuidesWallPx, 1);
  for (int y = down.begin; y < down.end; ++y) {
    for (int x = across.begin; x < across.end; ++x) {
      layout.region(x, y) = 0;
    }
  }
  return map_from_layout(std::move(layout));
}

}  // namespace gazetrace
