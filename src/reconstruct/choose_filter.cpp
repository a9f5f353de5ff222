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
  if (!facts.foveated) {
    return {"guided",
            "noise is smoothed along surfaces as far as it is noise, and samples are kept where they know better"};
  }
  return {"guided", "frames are foveated, and first hits show edges and texture at full resolution"};
}

}  // namespace gazetrace
