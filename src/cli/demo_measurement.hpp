// SPDX-License-Identifier: Apache-2.0
// What a demo of a job is about to take, and the sweep that measures it.
#pragma once

#include <cstdint>
#include <string>

#include "gazetrace/job.hpp"

namespace gazetrace {

// A look at one frame before all others.
struct FirstFrame {
  double spp = 0;  // that the job's sampling takes, in the mean
  double seconds = 0;
};

// The frame in the middle of this list or, where it is empty, of the job's.
std::int32_t middle_frame(const Job& job, const std::string& frames);
// How long the sweep of measurement_of() takes, and that of examples/demo.toml, in seconds, from the time of one frame.
double own_sweep_s(const Job& job, const FirstFrame& first);
double shipped_sweep_s(const FirstFrame& first);
// A sentence on how long two sequences, and a sweep of this time, will take.
std::string estimate_text(const Job& job, const std::string& frames, const FirstFrame& first, double sweep_s);
// The plan of a sweep over the job's scene and gaze in small, from this frame on: what was given of the job stands in
// the plan's tables.
std::string measurement_of(const Job& job, const std::string& middle);

}  // namespace gazetrace
