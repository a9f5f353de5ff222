// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// A warning where the sampling leaves nearly every pixel at its full rate, so that there is nothing to gain or to
// measure: at few pixels a degree, everything that the pixels can show is seen everywhere. Empty where it saves, and
// where the rates are known only once the frame is rendered. One frame with gaze stands for all.
Warnings saving_warnings(const JobSettings& job, const FramePlan& plan);

}  // namespace gazetrace
