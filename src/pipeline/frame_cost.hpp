// SPDX-License-Identifier: Apache-2.0
// What the time of a frame is made of, and how many samples it leaves: a fixed part and a part for each sample.
#pragma once

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

struct FrameCost {
  // First hits, filter, accumulation, layers, view, files, and what of a pilot is not tracing. Learning of light is
  // apart, since frames at rest learn once.
  double fixed_ms = 0;
  double base_ms = 0;  // of tracing, whatever the number of samples
  double sample_ms = 0;
  // `fixed_ms` is that of a frame of so many traced samples. A filter that looks samples up takes longer where there
  // are more of them: up to one a pixel, each further one adds this part of sample_ms.
  double samples = 0, filter_share = 0;
};

// What a finished frame says of the next one.
FrameCost cost_of(const TimingRow& row);
// Wall time of so many samples.
struct TracedSamples {
  double trace_ms = 0, samples = 0;
};
// `cost` of a frame with `more` samples, if a sample costs what `more` takes longer than `fewer`.
FrameCost with_slope(FrameCost cost, const TracedSamples& more, const TracedSamples& fewer);
// As cost_of(row), where something is known already: tracing takes longer or less long than that by one factor. A frame
// that was traced in less than `telling_ms`, and was expected to be, tells nothing of that, and what is known of
// tracing stays.
FrameCost cost_of(const TimingRow& row, const FrameCost& known, double telling_ms);
// Half of what was known and half of what is new: a frame that was held up by chance counts for half. The mean is that
// of times where they grow, and of samples for a time where they shrink, so that what was held up is soon forgotten.
FrameCost mean_cost(const FrameCost& known, const FrameCost& next);
// Samples a pixel, between `least` and `most`, that leave the frame with `budget_ms`.
double affordable_spp(double budget_ms, const FrameCost& cost, double pixels, double least, double most);
// The least budget that `visible` or `contrast-strength` can work with: what they look at first is a part of it.
double least_budget_spp(const FoveationSettings& foveation, const FrameRequest& request);

}  // namespace gazetrace
