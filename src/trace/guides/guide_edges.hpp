// SPDX-License-Identifier: Apache-2.0
// More rays through the pixels that an edge may cross. Most of them see what their own pixel's centre or a neighbour's
// sees, and need no shading of their own.
#pragma once

#include "trace/guides/guide_rays.hpp"

namespace gazetrace {

// Fills in edge_rays and edge_surfaces of guides whose images are complete. `smooth` has FirstHit::smooth of each
// pixel.
void trace_edges(const GuideFrame& frame, const Image<RoughNormal>& smooth, Guides& guides, int threads);

}  // namespace gazetrace
