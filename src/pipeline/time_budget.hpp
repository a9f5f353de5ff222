// SPDX-License-Identifier: Apache-2.0
// How many samples a frame may have so that it takes QualityTarget::time_s.
//
// The time of a frame is taken to be a fixed part and a part for each sample. Both are those of the frames before it in
// this run, whatever those of an earlier run took. The first frame is rehearsed, and the rehearsal is part of its time:
// at its full size with few samples and with more, which tells the fixed part and what a further sample costs. (A
// sample costs less where more of them share a pixel.) Where `visible` puts samples they may cost more or less, which
// pilots tell.
//
// Times depend on the machine and on what else it does, so the frames' samples do as well.
#pragma once

#include <cstdint>
#include <string>

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

class TimeBudget {
 public:
  // `settings` have a QualityTarget::time_s. Keeps references to `tracer`, `settings` and `output`.
  TimeBudget(PathTracer& tracer, const FrameSettings& settings, const OutputSettings& output);

  // The settings of the next frame, with a budget of samples in the place of the time. The first call rehearses, and
  // leaves in `known` what it has learned; later ones see in it whether the frame will have to learn.
  [[nodiscard]] FrameSettings settings_for(const FrameRequest& request, const TemporalHistory& history,
                                           KnownLight& known);
  // Takes in the row of the finished frame, of which total_ms may still be missing, and enters the rehearsal.
  void learn(TimingRow& row);
  // Of the frame's whole time.
  void check(const TimingRow& row);
  // What to say at the end about frames that took longer, or much less long; empty: nothing.
  [[nodiscard]] std::string warning() const;

 private:
  void rehearse(const FrameRequest& request, const TemporalHistory& history, KnownLight& known);

  PathTracer& tracer_;
  const FrameSettings& settings_;
  const OutputSettings& output_;
  double budget_ms_;
  FrameCost cost_;
  double learn_ms_ = 0;  // of the last frame that learned its light
  int known_frames_ = 0;
  // Of the rehearsal, until a row has it.
  TraceStats rehearsal_;
  double rehearsal_ms_ = 0;

  bool at_least_ = false, at_most_ = false;  // the last frame has the lowest or highest rate that is allowed
  int frames_ = 0, late_frames_ = 0, late_at_least_ = 0, early_frames_ = 0;
  std::int32_t latest_frame_ = 0;
  double latest_ms_ = 0;
};

}  // namespace gazetrace
