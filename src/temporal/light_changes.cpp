// SPDX-License-Identifier: Apache-2.0
#include "temporal/light_changes.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

// Means that differ by less than this share of them are the same: what the frames see there differs a little, too.
constexpr double kSameShare = 0.02;

LightSums operator+(const LightSums& a, const LightSums& b) {
  return {a.luminance + b.luminance, a.square + b.square, a.samples + b.samples};
}

// What the samples of each frame spread about its own mean: sum of squares, and how many are independent.
struct Spread {
  double squares = 0, freedom = 0;

  void add(const LightSums& sums) {
    if (sums.samples > 1) {
      const auto n = static_cast<double>(sums.samples);
      squares += std::max(sums.square - sums.luminance * sums.luminance / n, 0.0);
      freedom += n - 1;
    }
  }
};

// How many deviations two means are apart, squared.
double apart(const LightSums& a, const LightSums& b, const Spread& spread) {
  if (a.samples == 0 || b.samples == 0 || !(spread.freedom > 0)) {
    return 0;
  }
  const auto na = static_cast<double>(a.samples);
  const auto nb = static_cast<double>(b.samples);
  const double mean_a = a.luminance / na;
  const double mean_b = b.luminance / nb;
  const double same = kSameShare * (mean_a + mean_b) / 2;
  const double variance = spread.squares / spread.freedom * (1 / na + 1 / nb) + same * same;
  return variance > 0 ? (mean_a - mean_b) * (mean_a - mean_b) / variance : 0;
}

// How many frames from the first of `frames` on, outwards from the frame, are in one light.
std::size_t in_one_light(const std::vector<LightSums>& frames) {
  std::size_t end = frames.size();
  while (end > 1) {
    Spread spread;
    LightSums beyond;
    for (std::size_t i = 0; i < end; ++i) {
      spread.add(frames[i]);
      beyond = beyond + frames[i];
    }
    LightSums near;
    double most = kSigmas * kSigmas;
    std::size_t change = end;
    for (std::size_t i = 0; i + 1 < end; ++i) {
      near = near + frames[i];
      beyond = {beyond.luminance - frames[i].luminance, beyond.square - frames[i].square,
                beyond.samples - frames[i].samples};
      const double off = apart(near, beyond, spread);
      if (off > most) {
        most = off;
        change = i + 1;
      }
    }
    if (change == end) {
      break;
    }
    end = change;
  }
  return end;
}

}  // namespace

FrameRange frames_in_same_light(const std::vector<LightSums>& frames, std::size_t own) {
  const auto at = frames.begin() + static_cast<std::ptrdiff_t>(own);
  std::vector<LightSums> before(frames.begin(), at + 1);
  std::reverse(before.begin(), before.end());
  return {own + 1 - in_one_light(before), own + in_one_light({at, frames.end()}) - 1};
}

LightChanges::LightChanges(int width_px, int height_px, std::size_t frames)
    : width_((width_px + kBlockPx - 1) / kBlockPx),
      height_((height_px + kBlockPx - 1) / kBlockPx),
      frames_(frames),
      sums_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * frames) {}

std::vector<FrameRange> LightChanges::same_light(std::size_t own, int threads) const {
  std::vector<FrameRange> ranges(sums_.size() / frames_);
  parallel_for(static_cast<std::size_t>(height_), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width_; ++x) {
      const auto block = row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      std::vector<LightSums> alone(frames_);
      std::vector<LightSums> around(frames_);
      for (int by = std::max(y - 1, 0); by <= std::min(y + 1, height_ - 1); ++by) {
        for (int bx = std::max(x - 1, 0); bx <= std::min(x + 1, width_ - 1); ++bx) {
          const auto other =
              static_cast<std::size_t>(by) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(bx);
          for (std::size_t frame = 0; frame < frames_; ++frame) {
            around[frame] = around[frame] + sums_[other * frames_ + frame];
            if (other == block) {
              alone[frame] = sums_[other * frames_ + frame];
            }
          }
        }
      }
      const FrameRange small = frames_in_same_light(alone, own);
      const FrameRange large = frames_in_same_light(around, own);
      ranges[block] = {std::max(small.first, large.first), std::min(small.last, large.last)};
    }
  });
  return ranges;
}

}  // namespace gazetrace
