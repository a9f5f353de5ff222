// SPDX-License-Identifier: Apache-2.0
// Accumulation over frames.
#pragma once

#include <cstdint>
#include <optional>

#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

// All state that outlives a frame and reaches into pictures. Passed in the open; never global.
struct TemporalHistory {
  // Sums weighted by effective sample counts, in double.
  Image<Vec3d> radiance_sum;
  Image<double> count_sum;
  Image<double> variance_weight_sum;  // sum of count^2 * variance
  std::optional<Camera> camera;       // of the frames in the sums; a different one resets
  std::int32_t frames = 0;
  std::optional<double> smoothed_ev;  // exposure smoothing
  std::int64_t smoothed_ev_t_ns = 0;
};

enum class AccumulateMode { off, running };

struct AccumulateSettings {
  AccumulateMode mode = AccumulateMode::off;
};

// running: the sample-weighted mean of all frames since the last change of camera or size; the first frame passes
// through bit-equal. Guides stay those of the current frame. Frames are to carry different samples: the same ones
// added again raise the count, not the worth. Leaves the exposure's part of the history alone.
Frame accumulate(Frame frame, const FrameRequest& request, const AccumulateSettings& settings, TemporalHistory& history,
                 int threads);

}  // namespace gazetrace
