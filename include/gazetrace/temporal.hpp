// SPDX-License-Identifier: Apache-2.0
// Frames over time: the samples that a frame takes from those around it.
#pragma once

#include <cstdint>

namespace gazetrace {

// off: every frame stands for itself. automatic: window where a job has more than one frame, off for a single still;
// resolve() decides, and nothing else knows it. window: a frame is reconstructed from its own samples and from those of
// the frames around it, joined where they saw the same places (src/temporal/join_window.hpp). Nothing is accumulated
// from frame to frame: a picture is a function of its request and of the samples of its window. Frames that are still
// to come are known only where whole sequences are rendered: a window with a future is not causal, and nobody could be
// shown such a picture while looking.
enum class AccumulateMode : std::uint8_t { off, window, automatic };

struct AccumulateSettings {
  AccumulateMode mode = AccumulateMode::off;
  // So many frames before a frame and after it are read, as far as they exist.
  std::int32_t past_frames = 0, future_frames = 0;

  // The number that stands for a frame in its random numbers. The frames of a window all differ. Frames as far apart as
  // a window is long, which no window holds together, have the same: where camera and scene are at rest, every window
  // then holds the same samples, and nothing flickers.
  [[nodiscard]] constexpr std::int32_t scrambling(std::int32_t frame) const {
    const std::int32_t length = 1 + past_frames + future_frames;
    return mode == AccumulateMode::window && length > 1 ? (frame % length + length) % length : frame;
  }
};

}  // namespace gazetrace
