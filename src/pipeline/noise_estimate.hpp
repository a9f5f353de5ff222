// SPDX-License-Identifier: Apache-2.0
// Smooth estimates of noise from the few samples of a pilot.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// The mean over 5 x 5 pixels of what is not negative, where a value counts as at most kMostOfMedian times the median of
// the window (of those above 0). A single firefly raises its surroundings by less than as much as those hold already;
// a place with many keeps them. Where noise is spread as widely as that of path tracing is, the plain mean follows
// chance instead: rates would differ from frame to frame, and the picture would flicker with them.
inline constexpr double kMostOfMedian = 16;
ImageGray pooled(const ImageGray& values, int threads = 0);

}  // namespace gazetrace
