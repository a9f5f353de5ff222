// SPDX-License-Identifier: Apache-2.0
// What samples of another frame are worth at a pixel of this one, for accumulation from one side and from both.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "foveation/site_images.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/history_lookup.hpp"

namespace gazetrace {

inline constexpr float kFullRatePx = 1.5F;
inline constexpr float kKnowsNoise = 2;  // from so many samples on a pixel states its own variance
// In samples: a past that is worth less counts as none. It would show in no digit, and squares of its count would leave
// the range of numbers.
inline constexpr double kLeastWorth = 1e-9;

// Of each pixel, the side of the square that the samples of its site are spread over.
inline ImageGray footprints_of(const SamplingMap& map) {
  constexpr float kElsewhere = 1;
  return image_of_sites(
      map, [&](std::size_t i) { return std::sqrt(static_cast<float>(map.sites[i].pixels)); }, kElsewhere);
}

// The share that is kept of another frame's samples from frame to frame.
inline double share_kept_a_frame(const AccumulateSettings& settings) {
  return settings.frames > 0 ? 1 - 1 / std::max(settings.frames, 1.0) : 1;
}

// How many times larger the squares are that samples of the other frame were spread over, at least 1: by this ratio of
// areas they count less.
inline double ratio_of_areas(const PastSums& past, double footprint_px) {
  const double coarseness = past.footprint_px / footprint_px;
  return std::max(1.0, coarseness * coarseness);
}

// AccumulateSettings::blend, where it is set: the worth of a past beside a frame of `count` samples becomes what gives
// the frame that share.
inline void scale_to_blend(const AccumulateSettings& settings, double count, PastSums& past) {
  if (settings.blend > 0 && count > 0) {
    scale_worth(past, count * (1 / settings.blend - 1) / past.count);
  }
}

// Whether the eye has moved or was closed since the frame before, where that forbids taking anything across.
inline bool eye_forbids(const FrameRequest& request, const AccumulateSettings& settings) {
  return (settings.reset_at_saccades && request.saccade_since_last_frame) ||
         (settings.reset_at_blinks && request.blink_since_last_frame);
}

}  // namespace gazetrace
