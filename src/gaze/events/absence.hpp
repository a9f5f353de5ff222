// SPDX-License-Identifier: Apache-2.0
// Finds when the eye was not seen, and whether that was a blink.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

// unclassified where the sample is usable, else blink or lost as the log says.
std::vector<EyeMovement> absence_labels(const GazeLog& log, const std::vector<std::int64_t>& t_ns);

// Losses that are as long as a blink and lie between two times at which the eye was seen become blinks. Where the log
// calls only one part of a loss a blink and the rest lost, the whole loss becomes the blink. With a max_ns of 0 nothing
// changes.
void infer_blinks(const std::vector<std::int64_t>& t_ns, std::int64_t min_ns, std::int64_t max_ns,
                  std::vector<EyeMovement>& labels);

}  // namespace gazetrace
