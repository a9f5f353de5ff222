// SPDX-License-Identifier: Apache-2.0
// The rate of a sequence that is to reach QualityTarget::jod: one budget for all of its frames. It is found by
// rendering windows of the sequence (window_clip.hpp) at one rate after the other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// What may be seen of a reference's own error, as a part of what is seen of the frames' error. It is taken off, but
// only on average over references: with 0.35, four seeds chose rates of 1.29 to 1.92 samples a pixel for 9 JOD of one
// small view, with 0.1 of 1.44 to 1.61. The value is between the two: of 28 pairs of a small clip and a quality 25 came
// within 0.1 JOD of it, as with 0.15, for about a third of the reference's samples.
constexpr double kMostOfReference = 0.25;
// Of ClipRate::scatter_jod: if scores differ by more, more than one in five is further than 0.1 JOD from what was
// stated.
constexpr double kMostScatterJod = 0.08;

struct ClipRate {
  double spp = 0;            // samples a pixel, a mean over the frame: FoveationSettings::spp
  double predicted_jod = 0;  // of the sequence, at this rate
  TraceStats discarded;      // all samples of the looks
  double ms = 0;             // what the choice took
  int looks = 0;
  bool is_least = false;  // fewer samples are not possible
  // The last look was near enough to the rate; else the prediction is extrapolated far.
  bool settled = true;
  // Samples a pixel of the reference, a mean over what is traced of it (what counts has more), and what is seen of its
  // own error as a part of what is seen of the frames' in the last look.
  double reference_spp = 0, reference_share = 0;
  // The standard deviation of what one rendering of the judged frames scores, at this rate. A still's score differs as
  // much, that of a sequence by less, since it has more frames than are judged. 0: not known.
  double scatter_jod = 0;
  bool looked_at_whole = false;  // the whole frame is the window
  std::string looked_at;         // in words
  // FrameRates::spp of every frame; empty: each has a pilot, or none.
  ImageGray rates;

  [[nodiscard]] std::string text() const;                 // for the run record
  [[nodiscard]] std::vector<std::string> doubts() const;  // sentences for warnings: why the quality may be missed
};

// A function of the judged frames, settings and seed alone, but for the time that it takes. Error(usage) where the
// target would take more than FoveationSettings::max_spp.
ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color);

// The settings with the rate in the place of the target.
FrameSettings with_rate(FrameSettings settings, const ClipRate& rate);

// Every row states what is expected of the sequence, and the first one counts what the choice took.
void add_rate(const ClipRate& rate, bool is_first, TimingRow& row);

}  // namespace gazetrace
