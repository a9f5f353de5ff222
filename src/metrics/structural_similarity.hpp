// SPDX-License-Identifier: Apache-2.0
// The two factors of structural similarity, computed from local means, variances and covariance.
#pragma once

#include "gazetrace/image.hpp"

namespace gazetrace {

using ImageDouble = Image<double>;

inline constexpr int kSsimRadiusPx = 5;  // of the Gaussian window, 11 x 11 with a sigma of 1.5

struct SsimFactors {
  ImageDouble luminance;           // (2 mr mt + C1) / (mr^2 + mt^2 + C1)
  ImageDouble contrast_structure;  // (2 srt + C2) / (sr^2 + st^2 + C2)
};

// The factors of those pixels whose window lies inside the picture, so the results lack a rim of kSsimRadiusPx. For
// code values with peak 1, with K1 = 0.01, K2 = 0.03 and population covariance (Wang et al., "Image quality assessment:
// from error visibility to structural similarity", 2004, eq. 6-10 and section III-C).
SsimFactors ssim_factors(const ImageDouble& reference, const ImageDouble& test, int threads);

}  // namespace gazetrace
