// SPDX-License-Identifier: Apache-2.0
// Chooses the frames by which the quality of a sequence is judged before it is rendered.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/plan.hpp"

namespace gazetrace {

// Numbers of the frames to judge, in runs of consecutive ones.
struct JudgedNumbers {
  std::vector<std::vector<std::int32_t>> runs;
  std::int32_t sequence_frames = 0;
};

// What later frames of a sequence look like, beside its early ones.
enum class LaterFrames : std::uint8_t { as_early_ones, as_the_middle, all_differ };

// Whether frames follow each other fast enough for FovVideoVDP to see changes: it needs two of them in 250 ms.
bool sees_changes(const FrameRate& fps);

// FovVideoVDP sees 250 ms at a time, and takes a sequence to have stood still before its first frame. So the first run
// begins the sequence, and is two frames longer than that time: its last frames show what later ones look like, unless
// these differ. Then a further run looks at the middle, or two look at the middle and at the end. `frames` is the
// length of the whole sequence, whose frames follow each other fast enough (sees_changes()). A single frame is judged
// as a still, by four of its kind.
JudgedNumbers judged_numbers(std::int32_t frames, LaterFrames later, const FrameRate& fps);

}  // namespace gazetrace
