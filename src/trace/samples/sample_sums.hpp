// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "gazetrace/trace.hpp"

namespace gazetrace {

// Rounds a site's sums into the arrays of `out`, which are long enough. `guides`: nullptr for none.
void store_rounded(const SiteSums& sums, const SiteGuideSums* guides, std::size_t site, SparseFrame& out);

}  // namespace gazetrace
