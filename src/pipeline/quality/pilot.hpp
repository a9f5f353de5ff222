// SPDX-License-Identifier: Apache-2.0
// The pilot: a small rendering of the frame that is seen before it, tells where light is noisy, and is discarded. It
// has a scrambling of its own, so that no sample of the frame takes part in a decision about the frame's samples:
// deciding on the samples whose mean is kept would bias the mean.
//
// A pilot shows every cell_px-th pixel of the frame in either direction. Its samples are spread over these single
// pixels (TraceSettings::footprint), so that their noise is that of the frame's pixels, and does not contain the
// contrast within a cell. It goes through the frame's own filter.
#pragma once

#include <cstdint>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

struct Pilot {
  int cell_px = 1;
  PlanarView view;          // of the pilot's size
  ImageRgb radiance;        // after the filter
  ImageGray luminance;      // of it
  ImageGray squared_error;  // estimated, of the luminance after the filter, at these rates
  ImageGray spp;            // what the pixels expected
  TraceStats stats;
  StageTimes times;  // trace_ms, guides_ms, reconstruct_ms
};

// A power of two, up to 8: so that the pilot still has 64 rows, where the frame has as many.
int pilot_cell_px(const FrameRequest& request);
// The frame's view at the pilot's size: width and height over cell_px, rounded up.
PlanarView pilot_view(const FrameRequest& request, int cell_px);

// Traces a pilot at the given rates: samples a pixel, of any size, stretched over it. `round` chooses the scrambling.
Pilot trace_pilot(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings,
                  const ImageGray& rates, std::uint64_t round);

}  // namespace gazetrace
