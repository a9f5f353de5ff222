// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// How samples are spread over a frame, in a line, and a warning where a sampling that was asked for leaves nearly every
// pixel at the rate of the gaze, so that there is nothing to gain or to measure: at few pixels a degree, everything
// that the pixels can show is seen everywhere. Empty without gaze, unless a picture says where samples go. One frame
// with gaze stands for all.
struct SamplingNotes {
  std::string decision;
  Warnings warnings;
};
SamplingNotes sampling_notes(const Job& job, const FramePlan& plan);

}  // namespace gazetrace
