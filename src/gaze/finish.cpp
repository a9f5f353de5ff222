// SPDX-License-Identifier: Apache-2.0
#include "gaze/finish.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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

GazeSample mean_of(const GazeSample& a, const GazeSample& b, GazeKind kind) {
  GazeSample mean = a;
  mean.eye = Eye::cyclopean;
  mean.u = 0.5 * (a.u + b.u);
  mean.v = 0.5 * (a.v + b.v);
  if (kind == GazeKind::direction) {
    const Vec3d sum = a.direction + b.direction;
    mean.direction = length(sum) > 0 ? normalize(sum) : a.direction;
  } else if (a.validity != b.validity) {
    // One eye beside the display and one on it: the mean decides.
    const bool on_display = mean.u >= 0 && mean.u <= 1 && mean.v >= 0 && mean.v <= 1;
    mean.validity = on_display ? GazeValidity::ok : GazeValidity::off_screen;
  }
  const auto mean_or_known = [](float x, float y) { return std::isnan(x) ? y : std::isnan(y) ? x : 0.5F * (x + y); };
  mean.confidence = mean_or_known(a.confidence, b.confidence);
  mean.pupil = mean_or_known(a.pupil, b.pupil);
  return mean;
}

// The cyclopean sample of the rows of one time: the log's own where usable, else the mean of the usable eyes.
GazeSample merge_group(const GazeSample* begin, const GazeSample* end, GazeKind kind) {
  const GazeSample* left = nullptr;
  const GazeSample* right = nullptr;
  for (const GazeSample* sample = begin; sample != end; ++sample) {
    if (!is_usable(sample->validity)) {
      continue;
    }
    if (sample->eye == Eye::cyclopean) {
      return *sample;
    }
    (sample->eye == Eye::left ? left : right) = sample;
  }
  if (left != nullptr && right != nullptr) {
    return mean_of(*left, *right, kind);
  }
  GazeSample merged = left != nullptr ? *left : right != nullptr ? *right : *begin;
  merged.eye = Eye::cyclopean;
  return merged;
}

void merge_eyes(GazeLog& log) {
  std::array<std::size_t, 3> rows{};
  for (const GazeSample& sample : log.samples) {
    ++rows[static_cast<std::size_t>(sample.eye)];
  }
  if (std::count(rows.begin(), rows.end(), std::size_t{0}) >= 2) {
    return;  // one eye, or one that stands for both
  }
  const auto usable_eyes = [](const GazeSample* begin, const GazeSample* end) {
    return std::count_if(begin, end, [](const GazeSample& s) { return is_usable(s.validity); });
  };
  std::vector<GazeSample>& samples = log.samples;
  std::size_t kept = 0;
  std::size_t one_eyed = 0;
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin + 1;
    while (end < samples.size() && samples[end].t_ns == samples[begin].t_ns) {
      ++end;
    }
    one_eyed += usable_eyes(&samples[begin], samples.data() + end) == 1 ? 1 : 0;
    samples[kept++] = merge_group(&samples[begin], samples.data() + end, log.kind);
    begin = end;
  }
  samples.resize(kept);
  log.warnings.push_back(
      fmt::format("{}: rows of several eyes merged to their mean: {} times, {} of them with one usable eye only",
                  log.source, kept, one_eyed));
}

}  // namespace

void finish_log(GazeLog& log, UnorderedPolicy unordered) {
  if (log.samples.empty()) {
    throw Error(ErrorKind::input, log.source, "holds no sample", "a gaze log needs at least one row below its header");
  }
  order_samples(log, unordered);
  drop_duplicates(log, unordered);
  merge_eyes(log);
  const auto usable = [](const GazeSample& sample) { return is_usable(sample.validity); };
  if (std::none_of(log.samples.begin(), log.samples.end(), usable)) {
    log.warnings.push_back(fmt::format("{}: none of its {} samples is usable", log.source, log.samples.size()));
  }
}

}  // namespace gazetrace
