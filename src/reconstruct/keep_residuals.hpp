// SPDX-License-Identifier: Apache-2.0
// The last step of guided filters: what their picture lacks of the samples' own mean is given back as far as it is more
// than noise. First hits through pinholes, one or a few per pixel, miss the blur of lens and shutter, transparency,
// and light that changes faster than surfaces do; with enough samples their mean knows better.
#pragma once

#include <cstdint>

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

// The residual of a site is the mean of its samples less the mean of the picture over its pixels. It is split into
// bands, each twice as coarse as the one before, and of every band the share (q - v) / q is added to the picture: q is
// the mean square of the residual around the pixel, and v that of a replica of its noise, the difference of the halves
// (SparseFrame::half_difference) less what the picture has of it. Where that is in doubt, the share is what it is on
// average over a wider neighbourhood. With more and more samples v falls to 0, and the picture becomes the samples' own
// mean. Pixels that PassThrough keeps are not changed.
void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, SurfacePicture& picture);

}  // namespace gazetrace
