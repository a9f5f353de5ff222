// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

FilterChoice choose_filter(const FilterFacts& facts) {
  if (!facts.foveated) {
    return {"linear", "frames are uniform, and single pixels keep their samples' mean"};
  }
  if (facts.accumulates_sites) {
    return {"linear", "accumulation before the filter leaves sites, which cannot be taken apart by surfaces"};
  }
  if (facts.enhances_contrast) {
    return {"linear", "only filters that blur blocks leave contrast to bring back"};
  }
  if (facts.part_of_samples) {
    return {"linear", "guided filters need every sample of a frame, and this is a part of them"};
  }
  return {"guided", "frames are foveated, and first hits show edges and texture at full resolution"};
}

}  // namespace gazetrace
