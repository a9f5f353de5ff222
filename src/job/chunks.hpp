// SPDX-License-Identifier: Apache-2.0
// How a sequence is divided among the tasks of an array job.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

struct DividedFrames {
  std::vector<FrameChunk> chunks;
  ChunkBorders borders;  // to be written down where they are not; without a path where there is no output
};

// How `chunk` divides the frames; which chunk it is does not matter. As the first task wrote it down
// or, for that task, as it follows from the plan alone. `whole`: the plan of all frames.
DividedFrames divide_frames(const JobSettings& job, const FramePlan& whole);

// Writes the file of the borders unless it is there. Tasks that begin at the same moment have all computed them; those
// of the first one count, and Error(runtime) tells a task that found others.
void write_down(const ChunkBorders& borders);

struct ChosenChunk {
  std::vector<std::int32_t> frames;
  std::string decision;  // in words, what the borders follow from
  ChunkBorders borders;  // to be written down where they are not; without a path where there is no output
};

// The chunk that the job asks for. Error(nothing_to_do) where it has no frames.
ChosenChunk choose_chunk(const JobSettings& job, const FramePlan& whole);

}  // namespace gazetrace
