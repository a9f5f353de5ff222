// SPDX-License-Identifier: Apache-2.0
// How many pixels the frames of a job have.
#pragma once

#include <cstdint>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// A frame of which nobody said the size has the shape of the screen that it fills.
void follow_screen_shape(const GazeLog* log, std::int64_t taken_off_ns, Job& job, Decisions& decisions);

// Throws Error(usage) where `only-pixel` lies outside, and where the files of the job cannot hold so many pixels.
void check_frame_size(const JobSettings& job);

// Sums, picture and map of a frame take at least so much. More than the machine has is found out before a scene is
// loaded, and not by what the system then does.
void check_frame_memory(const JobSettings& job);

}  // namespace gazetrace
