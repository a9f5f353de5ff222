// SPDX-License-Identifier: Apache-2.0
// A first look at the frame: a small and cheap rendering that shows where there is contrast to be seen.
#pragma once

#include <cstdint>

#include "gazetrace/foveation.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

struct FirstLook {
  ImageGray multiplier;  // of the density, in [1 - 3/4 strength, 1]
  TraceStats stats;
};

// Traces the request's picture at an eighth of its size with 4 samples a pixel (a sixteenth of a sample for each pixel
// of the frame). It has a seed of its own, so that the density does not depend on the samples that it places, and
// estimates stay unbiased.
FirstLook trace_first_look(const PosedScene& scene, const FrameRequest& request, const TraceSettings& settings,
                           double strength);

// The settings for the frame itself: from a budget the samples of the first look are subtracted, since they count among
// the frame's. Other settings are unchanged. Error(usage) for a budget that leaves nothing.
FoveationSettings less_first_look(const FoveationSettings& settings, const FrameRequest& request);

// Root mean square contrast of the luminance in the 3 x 3 pixels around each pixel. The part of its square that the
// noise of the samples explains is subtracted.
ImageGray local_contrast(const SparseFrame& sparse, const SamplingMap& map);
// 1 where the contrast is 1/4 or more, less in proportion below it, 1 - 3/4 strength where there is none.
ImageGray contrast_multiplier(const ImageGray& contrast, double strength);

}  // namespace gazetrace
