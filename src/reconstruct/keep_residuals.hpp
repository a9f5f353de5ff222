// SPDX-License-Identifier: Apache-2.0
// The last step of guided filters: what their picture lacks of the samples' own mean is given back as far as it is more
// than noise. First hits, one or a few per pixel, miss reflections, what is behind glass, and light that changes faster
// than surfaces do; with enough samples their mean knows better.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/surface_lookup.hpp"

namespace gazetrace {

// The residual of a site is the mean of its samples less the mean of the picture over its pixels. It is split into
// bands, each twice as coarse as the one before, and of every band the share (q - v) / q is added to the picture: q is
// the mean square of the residual around the pixel, and v that of a replica of its noise, the difference of the halves
// (SparseFrame::half_difference) less what the picture has of it. Where that is in doubt, the share is what it is on
// average over a wider neighbourhood. No block is changed by more than the larger of two amounts: a tenth of its light,
// and what its own samples say. With more and more samples v falls to 0, and the picture becomes the samples'
// own mean.
void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, SurfacePicture& picture);

// What the picture lacks of a better one over the pixels of a site.
struct SiteResidual {
  Vec3f radiance;
  float replica = 0;  // of the error of its luminance
  Vec3f shown;        // mean of the picture
};
// The same for residuals of any kind, one for each site of the map. `of_light`: what is given back takes the place of
// the picture's light and of its noise. Else it is of first hits under the picture's light, and its own noise and error
// are noted in SurfacePicture::first_hits_variance and ::first_hits_error.
void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, const std::vector<SiteResidual>& residuals,
                    bool of_light, SurfacePicture& picture);

// The replica of a residual of a single sample. Nobody knows what of it is noise: all of it, with a sign of its own, so
// that around a pixel such noise cancels out as the noise of the samples does.
float replica_of_single_sample(std::size_t site, const Vec3f& residual);

}  // namespace gazetrace
