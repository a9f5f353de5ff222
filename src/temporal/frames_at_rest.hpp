// SPDX-License-Identifier: Apache-2.0
// Frames between which nothing moves see the same through the same pixels. Their samples are those of one frame with
// as many: they are added up before the filter, which then finds less noise to take away, and leaves less bias.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// How many frames at rest are in a group, which shows one sum: at least 1.
std::int32_t frames_in_group(const AccumulateSettings& settings);

// The frames whose samples a frame at rest shows, the last one included, as far as they exist: those in the windows of
// all frames of its group (AccumulateSettings::hold). They hold the frame itself. `end`: the last frame that exists, or
// one beyond its window.
struct ShownAtRest {
  std::int64_t first = 0, last = 0;
};
ShownAtRest shown_at_rest(std::int64_t frame, std::int64_t end, const AccumulateSettings& settings);

// Whether both maps divide the frame into the same sites, whatever the numbers of samples.
bool same_sites(const SamplingMap& a, const SamplingMap& b);

struct SamplesOfFrame {
  std::int32_t frame = 1;
  const SamplingMap* map = nullptr;
  const SparseFrame* sparse = nullptr;
};

struct SamplesAtRest {
  SamplingMap map;  // with the samples of all frames
  SparseFrame sparse;
};

// `frames`: at least one, with the same sites and of different numbers; the result does not depend on which of them is
// to be shown. What SparseFrame states of two halves of the samples is stated of the frames with odd and with even
// numbers, each of which has a scrambling of its own, so that it is known where a frame has a single sample as well.
// `camera`: that of the guides; nullptr where the frames hold no surfaces. Without stats.
SamplesAtRest add_up(const std::vector<SamplesOfFrame>& frames, const GuideCamera* camera, int threads);

}  // namespace gazetrace
