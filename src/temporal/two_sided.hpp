// SPDX-License-Identifier: Apache-2.0
// Accumulation from both sides: a frame takes what the frames before and after it saw of its surfaces. It reads frames
// as they were reconstructed, never accumulated ones, so that every sample counts once and nothing is resampled more
// than once.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "gazetrace/motion.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/history_lookup.hpp"

namespace gazetrace {

// The sums that a frame would leave as history if it stood alone.
TemporalHistory history_of_frame(const Frame& frame, const SamplingMap& map, const SurfaceMotion& motion,
                                 const FrameRequest& request, int threads);

// Which frames of a window may be read by frame `own`: from it outwards on each side up to the first cut, or up to the
// first saccade or blink across which nothing may be taken. `window` holds consecutive frames in order. Returns the
// first and one past the last of them.
struct WindowReach {
  std::size_t begin = 0, end = 0;
};
struct WindowFrame {
  const FrameRequest* request;
  const TemporalHistory* alone;  // history_of_frame()
};
WindowReach reach_of(const std::vector<WindowFrame>& window, std::size_t own, const AccumulateSettings& settings);

// Adds up what neighbours have to say about the pixels of one frame. Rejections, weights and clipping are those of
// reproject(), on each side by itself, with two differences. Texture that resampling has blurred is told from noise by
// the variance that the frame's samples state alone: there is no accumulated past to compare with from one frame to the
// next. And the noise of what is clipped counts as that of the frame's light where that is darker: a few frames are
// noisier than a long past, and the noise of a light that is not on yet would excuse it.
class NeighbourSums {
 public:
  // Keeps a reference to `frame`.
  NeighbourSums(const Frame& frame, const SamplingMap& map, const AccumulateSettings& settings, int threads);

  // `motion`: what the frame's pixels see and where that is in the neighbour's view. `frames_later`: negative for
  // frames before this one, never 0. The last digits depend on the order of the calls.
  void add(const TemporalHistory& neighbour, const SurfaceMotion& motion, int frames_later);

  // The frame with all that was added; its own bits where nothing was. `motion`: one of those that were given, of which
  // only the frame's objects count.
  [[nodiscard]] Frame joined(const SurfaceMotion& motion) const;

 private:
  const Frame& frame_;
  AccumulateSettings settings_;
  int threads_;
  ImageGray footprint_;
  std::array<Image<PastSums>, 2> sides_;  // before, after
};

}  // namespace gazetrace
