// SPDX-License-Identifier: Apache-2.0
// One rendering of a row's frames, timed and scored.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sweep/reference.hpp"
#include "sweep/rows.hpp"
#include "sweep/state.hpp"

namespace gazetrace {

struct MeasuredScene {
  PathTracer& tracer;
  const ColorPipeline& color;
  const CertifiedReference& reference;
  const SweepObserver& observer;
};

// Error(interrupted) where the sweep is asked to stop.
void stop_if_asked(const SweepObserver& observer);
// Renders the frames of a row, or of a reference, as render_sequence() does, until the sweep is asked to stop; then
// Error(interrupted).
void render_or_stop(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color, PipelineSettings settings,
                    PipelineObserver pipeline, const SweepObserver& observer);

// All `rows` show the same pixels; each is scored with its own gaze. Pictures of the first repeat are written to
// `folder` within the sweep's directory.
StoredRun measure_rows(const MeasuredScene& scene, const std::vector<const PlannedRow*>& rows, int repeat,
                       const SweepMeasure& measure, const std::string& directory, const std::string& folder);
// Measures only time and samples, over at most `frames` frames (0: all).
StoredRun time_row(PathTracer& tracer, const ColorPipeline& color, const PlannedRow& row, int repeat,
                   const SweepObserver& observer, std::size_t frames = 0);

// Finds the samples per pixel at which uniform frames take `target_s`, by linear interpolation between the rates that
// were tried, until one is within kRateTolerance; at most kRateTries further rates are tried. `known` are rates and
// times from before.
inline constexpr int kRateTries = 5;
inline constexpr double kRateTolerance = 0.02;
RateSearch find_rate(double target_s, const std::vector<std::pair<double, double>>& known, double least_spp,
                     double most_spp, const std::function<double(double spp)>& time_s);

// A digest of what scores depend on besides the pictures.
std::string scoring_digest(const SweepMeasure& measure, const std::vector<ResultFrame>& frames);

}  // namespace gazetrace
