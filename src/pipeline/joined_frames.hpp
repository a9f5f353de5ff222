// SPDX-License-Identifier: Apache-2.0
// Frames in order: each by itself, or beside those around it, which are traced ahead and kept while frames to come read
// them. Frames at rest share one guiding field.
#pragma once

#include <cstdint>
#include <map>
#include <set>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// Holds the samples of at most 1 + AccumulateSettings::past_frames + ::future_frames frames.
class JoinedFrames {
 public:
  // Keeps references to both, which must outlive it. `counted` are the frames whose own samples and times are counted
  // where they themselves are rendered.
  JoinedFrames(const FrameRenderer& renderer, const FramePlan& plan, std::set<std::int32_t> counted);

  // Frames must be asked for in ascending order. The samples of frames beside `counted` ones are counted in
  // RenderedFrame::others of the first frame that reads them.
  RenderedFrame render(const FrameRequest& request);

 private:
  const FrameRenderer* renderer_;
  std::map<std::int32_t, const FrameRequest*> requests_;  // of the plan, those around its frames included
  std::set<std::int32_t> counted_;
  std::map<std::int32_t, WindowFrame> in_memory_;
  TrainedField light_;
};

}  // namespace gazetrace
