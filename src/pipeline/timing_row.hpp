// SPDX-License-Identifier: Apache-2.0
// A frame's row of timing.csv, from what the stages say of themselves.
#pragma once

#include <optional>

#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// The frame's number, its size, and where the eye was.
TimingRow timing_row(const FrameRequest& request);

// The row of a frame that is finished, whose own was lost: times are not known (NaN), and counts are 0.
TimingRow lost_timing_row(const FrameRequest& request, std::optional<double> exposure_ev);

void add_prediction(const Prediction& prediction, TimingRow& row);
// `samples` are those of the map's sites; those of the pilot belong to no region.
void add_samples(const TraceStats& samples, const TraceStats& pilot, const SamplingMap& map, TimingRow& row);
// Samples that decided where those of frames belong, and were discarded; add_samples() adds the frame's own.
void add_pilot(const TraceStats& pilot, TimingRow& row);
void add_others(const TraceStats& others, TimingRow& row);  // RenderedFrame::others

}  // namespace gazetrace
