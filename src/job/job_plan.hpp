// SPDX-License-Identifier: Apache-2.0
// The plan of a job's frames: of those that are wanted, and of those that these need around them.
#pragma once

#include <cstdint>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// Both go on from the job's gaze and from the frames that are wanted (ResolvedJob::gaze, ::frames). `taken_off_ns` is
// how many nanoseconds the log's stamps are below those of its file.

// Takes the frames of the job's chunk out of those of the whole sequence.
void keep_to_chunk(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved);

// Fills in ResolvedJob::plan with the settings that it was made with, and the gaze that steers it. Frames
// that are only read beside others are in FramePlan::around.
void make_plan(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved);

}  // namespace gazetrace
