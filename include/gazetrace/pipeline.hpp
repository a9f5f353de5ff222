// SPDX-License-Identifier: Apache-2.0
// The whole way: requests in, files and timing out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

struct PipelineSettings {
  FoveationSettings foveation;
  TraceSettings trace;
  std::string filter = "linear";
  AccumulateSettings accumulate;
  ExposureSettings exposure;
  OutputSettings output;
  FrameRate fps;
  std::string settings_digest;
  int threads = 0;
};

// Called from the rendering thread.
struct PipelineObserver {
  std::function<void(const FrameRequest&)> frame_begins;
  std::function<void(const TimingRow&, bool skipped)> frame_done;
};

struct SequenceResult {
  std::vector<TimingRow> rows;  // of this run, skipped frames left out
  std::vector<std::int32_t> skipped;
  std::vector<BadSample> bad_samples;
  std::uint64_t clamped_half_values = 0, clamped_view_pixels = 0;
  Warnings warnings;
};

// Renders the frames of a plan in order. With OutputSettings::resume, frames whose files carry this settings digest are
// skipped, unless history (accumulation, exposure smoothing) needs them rendered again.
SequenceResult render_sequence(const PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer);

}  // namespace gazetrace
