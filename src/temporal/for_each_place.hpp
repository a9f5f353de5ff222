// SPDX-License-Identifier: Apache-2.0
// Goes over all pixels of a frame in parallel.
#pragma once

#include <cstddef>

#include "core/parallel.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

// Calls visit(x, y, i) for every pixel, with its index into the images of the frame; each row in one thread.
template <class Visit>
void for_each_place(const Frame& frame, int threads, const Visit& visit) {
  parallel_for(static_cast<std::size_t>(frame.radiance.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < frame.radiance.width_px; ++x) {
      visit(x, y, frame.radiance.index(x, y));
    }
  });
}

}  // namespace gazetrace
