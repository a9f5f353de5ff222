// SPDX-License-Identifier: Apache-2.0
// A frame that is sampled in blocks of several sizes is denoised at the resolutions of its blocks: one picture for each
// size, with one pixel a block. A network takes the light of one coarse block, painted over many pixels, for a detail;
// and what it costs is paid for each pixel that it is shown.
#pragma once

#include <vector>

#include "reconstruct/denoiser_input.hpp"

namespace gazetrace {

// The part of the frame where blocks are of one size or finer, and a margin around it: [x, x + width) x [y, y +
// height), counted in blocks from the frame's origin.
struct DenoiserLevel {
  int block_px = 1;
  int x_blocks = 0, y_blocks = 0;
  DenoiserInput input;  // one pixel a block
};

// Coarse to fine, one for each size of blocks in the map. A pixel of a level is the mean over those of `frame` that lie
// in its block and in the frame: of a site of that size, the mean of what the site's pixels show. `frame`: of the map's
// size.
std::vector<DenoiserLevel> denoiser_levels(const DenoiserInput& frame, const SamplingMap& map, int threads);

// One picture of the frame's size from those of the levels (`pictures[i]` of levels[i], of the same size as its input):
// each pixel from the level of its own block, between whose pixels it is interpolated linearly. A seam is a place where
// resolution changes, so a level fades in behind its border, over kFadeBlocks blocks of the next coarser level, which
// covers the border from both sides.
inline constexpr int kFadeBlocks = 4;
ImageRgb blend_levels(const std::vector<DenoiserLevel>& levels, const std::vector<ImageRgb>& pictures,
                      const SamplingMap& map, int threads);

}  // namespace gazetrace
