// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "gazetrace/trace.hpp"

namespace gazetrace {

// A frame of this map's size, whose sites have no samples; of the other arrays only `guides`, where they are wanted.
SparseFrame empty_frame(const SamplingMap& map, bool guides);

// Rounds the sums of a site and stores them in the arrays of `out`, which must be long enough. `guides` may be nullptr.
void store_rounded(const SiteSums& sums, const SiteGuideSums* guides, std::size_t site, SparseFrame& out);

}  // namespace gazetrace
