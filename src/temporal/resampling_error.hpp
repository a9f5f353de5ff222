// SPDX-License-Identifier: Apache-2.0
// What looking up another frame between its pixels costs at this pixel alone: where texture is finer than the pixels,
// and where a silhouette slides over what lies behind it.
#pragma once

#include <cstddef>

#include "gazetrace/motion.hpp"
#include "gazetrace/reconstruct.hpp"
#include "temporal/history_lookup.hpp"

namespace gazetrace {

// The share of the worth of `past` that is kept. A squared error b^2 that all its samples have in common, beside a
// variance v of one sample of the frame, makes n samples worth n / (1 + n b^2 / v). For b stands how far two ways of
// interpolation are apart; where the pixel shows two surfaces that move apart, or showed another one than now, how far
// the past is from the frame. All is kept where the frame does not know its own noise. `pasts`: so many of like worth
// and like error will be added up.
double share_kept_between_pixels(const PastSums& past, const Frame& frame, const HistorySurfaces& was,
                                 const SurfaceMotion& motion, std::size_t pixel, int pasts = 1);

}  // namespace gazetrace
