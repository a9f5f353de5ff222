// SPDX-License-Identifier: Apache-2.0
// Variance of noise at the resolution of a pyramid's bands.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

// The variances that the pixels of the next level average over: the *squares* of the kernel of metrics/pyramid.hpp,
// which is how variances of independent pixels add, brought to a sum of 1, so that an even variance stays as it is and
// only ErrorSpectrum's gains say how much of it a band holds. Beyond the border pixels are mirrored.
ImageGray halved_variance(const ImageGray& variance, int threads);

}  // namespace gazetrace
