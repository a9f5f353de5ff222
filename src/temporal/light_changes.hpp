// SPDX-License-Identifier: Apache-2.0
// When light changes in a part of the picture: a lamp goes off, a shadow passes. Frames from before the change, or from
// after it, show other light than the frame, and must not join it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gazetrace {

// The light of some sites in one frame.
struct LightSums {
  // Luminance summed over samples, and its square.
  double light = 0, light_square = 0;
  // The root of a site's mean luminance, summed over sites, and its square. A few samples that are far brighter than
  // all others, which is most of the noise of many scenes, hardly change it.
  double root = 0, root_square = 0;
  std::uint64_t samples = 0, sites = 0;

  // A site's samples. Does nothing where it has none.
  void add(double luminance, double square, std::uint32_t count);
};

// From the first to the last of consecutive frames.
struct FrameRange {
  std::size_t first = 0, last = 0;
  [[nodiscard]] bool holds(std::size_t frame) const { return first <= frame && frame <= last; }
};

// The frames around frame `own` that show the same light as it does, so far as noise lets that be told: between two
// neighbours the light changes where the mean of those from the frame to there and the mean of those beyond differ by
// more than kSigmas standard deviations. That deviation is of the values within frames, of all that are compared, so
// that a rare bright path in one of them is no change. Roots are compared only where sites have about as many samples,
// since the mean of a root depends on the noise.
FrameRange frames_in_same_light(const std::vector<LightSums>& frames, std::size_t own);

inline constexpr double kSigmas = 4;

// The same for each block of a frame, looked at by itself and together with the blocks around it: a small shadow shows
// in the one, a faint light in the other.
class LightChanges {
 public:
  static constexpr int kBlockPx = 8;

  LightChanges(int width_px, int height_px, std::size_t frames);

  static std::size_t block_of(int x_px, int y_px, int width_px) {
    return static_cast<std::size_t>(y_px / kBlockPx) * static_cast<std::size_t>((width_px + kBlockPx - 1) / kBlockPx) +
           static_cast<std::size_t>(x_px / kBlockPx);
  }
  [[nodiscard]] LightSums& at(std::size_t block, std::size_t frame) { return sums_[block * frames_ + frame]; }

  // Of each block.
  [[nodiscard]] std::vector<FrameRange> same_light(std::size_t own, int threads) const;

 private:
  int width_, height_;
  std::size_t frames_;
  std::vector<LightSums> sums_;
};

}  // namespace gazetrace
