// SPDX-License-Identifier: Apache-2.0
// How many samples a frame may have so that it takes QualityTarget::time_s.
//
// The time of a frame is taken to be a fixed part and a part for each sample. Both are those of the frames before it in
// this run, whatever those of an earlier run took. The first frame is rehearsed (rehearsal.hpp), and the rehearsal is
// part of its time.
//
// Times depend on the machine and on what else it does, so the frames' samples do as well.
#pragma once

#include <cstdint>
#include <string>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "pipeline/frame_cost.hpp"

namespace gazetrace {

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
