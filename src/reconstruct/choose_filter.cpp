// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

FilterChoice choose_filter(const FilterFacts& facts) {
  if (facts.accumulates_sites) {
    return {"linear", "accumulation before the filter leaves sites, which cannot be taken apart by surfaces"};
  }
  if (!facts.foveated && facts.means_frames) {
    return {"linear", "frames are uniform, and their running mean is to tend to that of the samples"};
  }
  if (!facts.foveated && facts.single_pixel) {
    return {"linear", "one pixel is replayed, which has no neighbours to be smoothed with"};
  }
  if (facts.accumulates) {
    return {"guided", "it joins the light of several frames surface by surface"};
  }
  if (facts.single_pixel) {
    return {"guided", "one pixel is replayed, of which a network would see nothing"};
  }
  if (facts.has_denoiser) {
    return {"oidn", "Open Image Denoise was found"};
  }
  return {"guided",
          "Open Image Denoise was not found, with which stills of 1 to 16 samples a pixel score 0.2 to 0.5 JOD more "
          "(cmake/denoiser.sh brings it)"};
}

}  // namespace gazetrace
