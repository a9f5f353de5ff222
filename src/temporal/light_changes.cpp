// SPDX-License-Identifier: Apache-2.0
#include "temporal/light_changes.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

// Means that differ by less than this share of them are the same: what the frames see there differs a little, too.
constexpr double kSameShare = 0.02;

// Sites of two groups of frames have about as many samples.
constexpr double kAsMany = 1.25;

LightSums sum_of(const LightSums& a, const LightSums& b) {
  return {a.light + b.light,     a.light_square + b.light_square,
          a.root + b.root,       a.root_square + b.root_square,
          a.samples + b.samples, a.sites + b.sites};
}

// Of one kind of values: their mean in some frames.
struct Mean {
  double sum = 0;
  std::uint64_t count = 0;
};

// What they spread about the mean of each frame: sum of squares, and how many are independent.
struct Spread {
  double squares = 0, freedom = 0;

  void add(const Mean& mean, double square) {
    if (mean.count > 1) {
      const auto n = static_cast<double>(mean.count);
      squares += std::max(square - mean.sum * mean.sum / n, 0.0);
      freedom += n - 1;
    }
  }
};

// How many deviations two means are apart, squared.
double apart(const Mean& a, const Mean& b, const Spread& spread) {
  if (a.count == 0 || b.count == 0 || !(spread.freedom > 0)) {
    return 0;
  }
  const auto na = static_cast<double>(a.count);
  const auto nb = static_cast<double>(b.count);
  const double difference = a.sum / na - b.sum / nb;
  const double same = kSameShare * (a.sum / na + b.sum / nb) / 2;
  const double variance = spread.squares / spread.freedom * (1 / na + 1 / nb) + same * same;
  return variance > 0 ? difference * difference / variance : 0;
}

bool as_many(const LightSums& a, const LightSums& b) {
  const double in_a = static_cast<double>(a.samples) * static_cast<double>(b.sites);
  const double in_b = static_cast<double>(b.samples) * static_cast<double>(a.sites);
  return in_a < kAsMany * in_b && in_b < kAsMany * in_a;
}

struct Spreads {
  Spread light, root;

  void add(const LightSums& sums) {
    light.add({sums.light, sums.samples}, sums.light_square);
    root.add({sums.root, sums.sites}, sums.root_square);
  }
  [[nodiscard]] double apart(const LightSums& a, const LightSums& b) const {
    const double by_light = gazetrace::apart({a.light, a.samples}, {b.light, b.samples}, light);
    return as_many(a, b) ? std::max(by_light, gazetrace::apart({a.root, a.sites}, {b.root, b.sites}, root)) : by_light;
  }
};

// How many frames from the first of `frames` on, outwards from the frame, are in one light.
std::size_t in_one_light(const std::vector<LightSums>& frames) {
  std::size_t end = frames.size();
  while (end > 1) {
    Spreads spreads;
    // Of the frames from each one on.
    std::vector<LightSums> beyond(end + 1);
    for (std::size_t i = end; i-- > 0;) {
      spreads.add(frames[i]);
      beyond[i] = sum_of(beyond[i + 1], frames[i]);
    }
    LightSums near;
    double most = kSigmas * kSigmas;
    std::size_t change = end;
    for (std::size_t i = 0; i + 1 < end; ++i) {
      near = sum_of(near, frames[i]);
      const double off = spreads.apart(near, beyond[i + 1]);
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

void LightSums::add(double luminance, double square, std::uint32_t count) {
  if (count == 0) {
    return;
  }
  const double mean = std::max(luminance / count, 0.0);
  light += luminance;
  light_square += square;
  root += std::sqrt(mean);
  root_square += mean;
  samples += count;
  ++sites;
}

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
            around[frame] = sum_of(around[frame], sums_[other * frames_ + frame]);
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
