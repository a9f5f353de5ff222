// SPDX-License-Identifier: Apache-2.0
// The rate of a sequence that is to reach QualityTarget::jod or ::flip: one budget for all of its frames.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/image.hpp"
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
  double spp = 0;  // samples a pixel, a mean over the frame: FoveationSettings::budget_spp
  std::optional<double> predicted_jod, predicted_flip;  // of the sequence, at this rate: what was asked for
  TraceStats pilot;                                     // samples that were discarded
  int rounds = 0;                                       // of pilots, or looks at windows
  int frames = 0;                                       // renderings of judged frames, by pilots alone
  bool is_least = false;                                // fewer samples are not possible
  // The last pilot or look was near enough to the rate; else the prediction is extrapolated far.
  bool settled = true;
  // Of windows: samples a pixel of their reference, a mean over what is traced of them (what counts has more), and what
  // is seen of its own error as a part of what is seen of the frames' in the last look.
  double reference_spp = 0, reference_share = 0;
  // Of looks: the standard deviation of what one rendering of the judged frames scores, at this rate. A still's score
  // differs as much, that of a sequence by less, since it has more frames than are judged. 0: not known.
  double scatter_jod = 0;
  bool looked_at_whole = false;
  double summed_frames = 1;  // how many frames at most are added up for one
  std::string how;           // what was looked at
  // FrameRates::spp of every frame; empty: each has a pilot, or none.
  ImageGray rates;

  [[nodiscard]] std::string text() const;                 // for the run record
  [[nodiscard]] std::vector<std::string> doubts() const;  // sentences for warnings: why the quality may be missed
};

// Whether the error of frames is in a replica of their noise: single pixels of uniform frames that nothing smooths.
bool is_noise_alone(const FrameSettings& settings);

// For frames whose error is noise alone, by pilots (replica_clip.hpp) at lower rates. Each says what would be seen if
// its squared error were smaller, and that falls as one over the rate. A function of the judged frames, settings and
// seed alone. Error(usage) where the target would take more than FoveationSettings::max_spp.
ClipRate clip_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                   const ColorPipeline& color);

// For all others, measured in windows (window_clip.hpp). Only for QualityTarget::jod. Error(usage) as above.
ClipRate measured_rate(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                       const ColorPipeline& color);

}  // namespace gazetrace
