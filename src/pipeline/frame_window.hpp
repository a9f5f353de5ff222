// SPDX-License-Identifier: Apache-2.0
// Frames in order that read their neighbours on both sides: traces ahead, and keeps what frames to come still read.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {

// Neighbours are read in one of three ways. Where nothing moves between them and a frame, and their sites are the same,
// their samples are added to the frame's own before the filter (temporal/frames_at_rest.hpp). Where only the camera
// moves, what they saw of the frame's surfaces is (temporal/moving_views.hpp). Others are looked up in their own
// reconstructed pictures (temporal/two_sided.hpp).
//
// Holds the samples of at most 2 * AccumulateSettings::window + 1 frames, and the pictures of those that are looked up,
// beside which one frame is being joined.
class FrameWindow {
 public:
  // Keeps references to both, which must outlive it. `counted` are the frames whose own samples and times are counted
  // where they themselves are rendered.
  FrameWindow(const FrameRenderer& renderer, const FramePlan& plan, std::set<std::int32_t> counted);

  // Frames must be asked for in ascending order. `history` is as for FrameRenderer::render(). The samples of frames
  // beside `counted` ones are counted in RenderedFrame::others of the first frame that reads them.
  RenderedFrame render(const FrameRequest& request, TemporalHistory& history);

 private:
  struct WindowFrame {
    TracedFrame traced;
    std::optional<ReconstructedFrame> alone;  // once it was looked up, or shown without neighbours at rest
  };
  // The first and the last of consecutive frames.
  struct Run {
    std::int32_t first = 0, last = 0;
    friend bool operator==(const Run&, const Run&) = default;
  };
  struct Rested {
    Run run;
    ReconstructedFrame frame;
  };
  struct FirstHits {
    FrameRequest request;  // whose they are
    std::optional<Guides> guides;
  };

  [[nodiscard]] const FrameRequest& request_of(std::int32_t frame) const { return *requests_.at(frame); }
  [[nodiscard]] Run window_around(std::int32_t frame) const;
  // The frames of the window whose samples join those of the frame.
  [[nodiscard]] Run at_rest_with(std::int32_t frame, const Run& window) const;
  [[nodiscard]] bool joins_next(std::int32_t earlier) const;
  // What a frame shows of its window where all of that is at rest: the same as all of its group.
  [[nodiscard]] Run of_group(const Run& window, std::int32_t frame) const;
  const Guides* guides_of(const FrameRequest& request, StageTimes& times);
  const ReconstructedFrame& alone(std::int32_t frame, bool read_by_others, StageTimes& times);
  const ReconstructedFrame& rested(const Run& run, std::int32_t frame, bool beside_others, StageTimes& times);
  // The sums over the frames of a run at rest.
  TracedFrame sum_of(const Run& run, const Guides* guides) const;
  // The frames of the window that no movement of the eye, nor a blink, keeps from being read by the frame.
  [[nodiscard]] Run seen_by(std::int32_t frame, Run window) const;
  // Whether surfaces of all these frames can be joined before the filter.
  [[nodiscard]] bool only_views_move(const Run& window) const;
  // The frame with the samples of `run`, those at rest with it, and what the others of `window` saw of its surfaces.
  ReconstructedFrame among_views(const Run& run, const Run& window, std::int32_t frame, StageTimes& times);

  const FrameRenderer* renderer_;
  std::map<std::int32_t, const FrameRequest*> requests_;  // of the plan, those around its frames included
  std::set<std::int32_t> counted_;
  std::map<std::int32_t, WindowFrame> in_memory_;
  std::optional<Rested> rested_;  // the last one: while nothing moves, the next frame may be the same
  std::optional<FirstHits> first_hits_;
  KnownLight light_;
};

}  // namespace gazetrace
