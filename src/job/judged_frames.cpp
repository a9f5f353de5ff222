// SPDX-License-Identifier: Apache-2.0
#include "job/judged_frames.hpp"

#include <algorithm>
#include <numeric>

#include "metrics/temporal_channels.hpp"

namespace gazetrace {
namespace {

std::vector<std::int32_t> run_of(std::int32_t first, std::int32_t count) {
  std::vector<std::int32_t> run(static_cast<std::size_t>(count));
  std::iota(run.begin(), run.end(), first);
  return run;
}

}  // namespace

bool sees_changes(const FrameRate& fps) {
  return static_cast<double>(fps.numerator) > 4 * static_cast<double>(fps.denominator);
}

JudgedNumbers judged_numbers(std::int32_t frames, LaterFrames later, const FrameRate& fps) {
  JudgedNumbers judged;
  judged.sequence_frames = frames;
  if (frames == 1) {
    judged.runs = {{1}, {2}, {3}, {4}};
    return judged;
  }
  const double rate = static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
  const auto taps = static_cast<std::int32_t>(temporal_filters(rate).sustained.size());
  const std::int32_t first = std::min(frames, taps + 2);
  judged.runs.push_back(run_of(1, first));
  // A run tells of its last two frames: those before them are what the metric has in view.
  const std::int32_t length = std::min(frames, taps + 1);
  const std::int32_t last = frames - length + 1;
  std::vector<std::int32_t> begins;
  if (later != LaterFrames::as_early_ones) {
    begins.push_back((1 + last) / 2);
  }
  if (later == LaterFrames::all_differ) {
    begins.push_back(last);
  }
  for (std::int32_t begin : begins) {
    const std::int32_t after = judged.runs.back().back() + 1;
    if (later == LaterFrames::as_the_middle) {
      begin = std::max(begin, after);
    }
    const std::int32_t count = std::min(length, frames - begin + 1);
    if (begin >= after && count >= length) {
      judged.runs.push_back(run_of(begin, count));
    }
  }
  return judged;
}

}  // namespace gazetrace
