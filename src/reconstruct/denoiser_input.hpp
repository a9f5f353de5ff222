// SPDX-License-Identifier: Apache-2.0
// What a denoiser is shown of a frame: dense pictures at full resolution, whatever the sites are.
#pragma once

#include <array>

#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// All pictures are of the frame's size.
struct DenoiserInput {
  ImageRgb radiance;  // linear Rec.709. Of sites of one pixel the samples' own mean
  ImageRgb albedo;    // 0..1; 0 where nothing is hit
  ImageRgb normal;    // world space, of length 1 at most: shorter where surfaces meet, zero where nothing is hit
  ImageGray samples;  // a pixel; those of a site are divided among its pixels
  // The same by each of two halves of the samples, which share none; for denoise(). Of larger sites their means; of a
  // half without samples the mean of all. Empty where no site has two samples.
  std::array<ImageRgb, 2> halves;
  bool clean = false;  // albedo and normal have so little noise that the denoiser may believe every pixel of them
};
// Rays of the guides through each pixel of a frame by itself: with four, and the samples' own first hits, features are
// as good to the network as those of 64 samples.
inline constexpr int kDenoiserGuideRays = 4;

// `sparse` holds surfaces and first hits (TraceSettings::surfaces), and may hold a first half; `guides` are of the
// map's size. Albedo and normal are means over the guides' rays and the samples of a site of one pixel; over the
// samples alone where they see through lens and shutter what the pinhole of the guides sees elsewhere. Sites of several
// pixels give each of them one light, times its own albedo, so that their mean is that of the samples
// (denoiser_levels.hpp shows them to the network block by block). Sites without samples show the light of the surfaces
// around.
DenoiserInput denoiser_input(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides, int threads);

}  // namespace gazetrace
