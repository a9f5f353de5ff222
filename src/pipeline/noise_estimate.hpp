// SPDX-License-Identifier: Apache-2.0
// Smooth estimates of noise from the few samples of a pilot.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// The mean over 5 x 5 pixels, where a single value that is more than half of the sum counts as at most kMostOfOthers
// times the mean of the others. So one firefly raises its surroundings by less than they hold already, and a place with
// several keeps them. By a plain mean, rates would follow chance, and the picture would flicker with them. What is
// negative counts as 0. What is not finite is not known and is left out; 0 where nothing else is near.
inline constexpr double kMostOfOthers = 16;
ImageGray pooled(const ImageGray& values, int threads = 0);

}  // namespace gazetrace
