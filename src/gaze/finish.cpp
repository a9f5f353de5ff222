// SPDX-License-Identifier: Apache-2.0
#include "gaze/finish.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "gaze/eyes.hpp"

namespace gazetrace {
namespace {

std::string place_of(const GazeLog& log, const GazeSample& sample) {
  return fmt::format("{}:{}", log.source, sample.row);
}

void order_samples(GazeLog& log, UnorderedPolicy unordered) {
  std::size_t backwards = 0;
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    const GazeSample& before = log.samples[i - 1];
    const GazeSample& sample = log.samples[i];
    if (sample.t_ns >= before.t_ns) {
      continue;
    }
    if (unordered == UnorderedPolicy::error) {
      throw Error(ErrorKind::input, place_of(log, sample),
                  fmt::format("time {} ns is before that of line {} ({} ns)", sample.t_ns, before.row, before.t_ns),
                  "sort the log, or use --gaze-sort");
    }
    ++backwards;
  }
  if (backwards > 0) {
    std::stable_sort(log.samples.begin(), log.samples.end(),
                     [](const GazeSample& a, const GazeSample& b) { return a.t_ns < b.t_ns; });
    log.warnings.push_back(fmt::format("{}: sorted by time; {} {} backwards", log.source, backwards,
                                       backwards == 1 ? "step went" : "steps went"));
  }
}

// Keeps the last row of each eye among rows of one time.
void drop_duplicates(GazeLog& log, UnorderedPolicy unordered) {
  std::size_t dropped = 0;
  std::vector<GazeSample>& samples = log.samples;
  std::size_t kept = 0;
  std::size_t group = 0;  // where the rows of the current time begin, among the kept
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (kept > 0 && samples[kept - 1].t_ns != samples[i].t_ns) {
      group = kept;
    }
    std::size_t twin = group;
    while (twin < kept && samples[twin].eye != samples[i].eye) {
      ++twin;
    }
    if (twin < kept) {
      if (unordered == UnorderedPolicy::error) {
        throw Error(ErrorKind::input, place_of(log, samples[i]),
                    fmt::format("time {} ns repeats that of line {}", samples[i].t_ns, samples[twin].row),
                    "remove one of them, or use --gaze-sort, which keeps the last");
      }
      ++dropped;
      samples[twin] = samples[i];
      continue;
    }
    samples[kept++] = samples[i];
  }
  samples.resize(kept);
  if (dropped > 0) {
    log.warnings.push_back(fmt::format("{}: {} {} dropped: the last row of equal times is kept", log.source, dropped,
                                       dropped == 1 ? "duplicate was" : "duplicates were"));
  }
}

// Origins come in the order of the file, perhaps each eye's in a row of its own; samples have one each when this is
// done.
void align_origins(GazeLog& log) {
  if (log.origins.empty()) {
    return;
  }
  constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
  std::vector<EyeOrigins> by_time = std::move(log.origins);
  std::stable_sort(by_time.begin(), by_time.end(),
                   [](const EyeOrigins& a, const EyeOrigins& b) { return a.t_ns < b.t_ns; });
  log.origins.clear();
  log.origins.reserve(log.samples.size());
  auto at = by_time.begin();
  for (const GazeSample& sample : log.samples) {
    EyeOrigins joined{{kNanF, kNanF, kNanF}, {kNanF, kNanF, kNanF}, sample.t_ns};
    for (; at != by_time.end() && at->t_ns <= sample.t_ns; ++at) {
      if (at->t_ns == sample.t_ns) {
        joined.left_mm = std::isnan(at->left_mm.x) ? joined.left_mm : at->left_mm;
        joined.right_mm = std::isnan(at->right_mm.x) ? joined.right_mm : at->right_mm;
      }
    }
    log.origins.push_back(joined);
  }
}

}  // namespace

void finish_log(GazeLog& log, const GazeReadOptions& options) {
  if (log.samples.empty()) {
    throw Error(ErrorKind::input, log.source, "holds no sample", "a gaze log needs at least one row below its header");
  }
  order_samples(log, options.unordered);
  drop_duplicates(log, options.unordered);
  choose_eyes(log, options);
  align_origins(log);
  const auto usable = [](const GazeSample& sample) { return is_usable(sample.validity); };
  if (std::none_of(log.samples.begin(), log.samples.end(), usable)) {
    log.warnings.push_back(fmt::format("{}: none of its {} samples is usable", log.source, log.samples.size()));
  }
}

}  // namespace gazetrace
