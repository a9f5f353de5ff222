// SPDX-License-Identifier: Apache-2.0
#include "gazelog/row_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace gazetrace {
namespace {

std::string place_of(const GazeLog& log, std::int64_t row) {
  return fmt::format("{}:{}", log.source, row);
}

bool is_same_position(const GazeSample& a, const GazeSample& b) {
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return same(a.u, b.u) && same(a.v, b.v) && same(a.direction.x, b.direction.x) && same(a.direction.y, b.direction.y) &&
         same(a.direction.z, b.direction.z);
}

}  // namespace

std::string unordered_problem(const GazeOrder& order) {
  return fmt::format("time {} ns is before that of line {} ({} ns)", order.first_backward_ns, order.row_before,
                     order.before_ns);
}

std::string duplicate_problem(const GazeOrder& order) {
  return fmt::format("time {} ns repeats that of line {}", order.first_duplicate_ns, order.row_repeated);
}

void order_samples(GazeLog& log, UnorderedPolicy policy) {
  GazeOrder& order = log.order;
  order.rows = log.samples.size();
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    const GazeSample& before = log.samples[i - 1];
    const GazeSample& sample = log.samples[i];
    if (sample.t_ns >= before.t_ns) {
      continue;
    }
    if (order.backward_steps++ == 0) {
      order.first_backward_row = sample.row;
      order.first_backward_ns = sample.t_ns;
      order.row_before = before.row;
      order.before_ns = before.t_ns;
      if (policy == UnorderedPolicy::error) {
        throw Error(ErrorKind::input, place_of(log, sample.row), unordered_problem(order),
                    "sort the log, or use `gaze-sort`");
      }
    }
    std::int64_t back_ns = 0;
    if (__builtin_sub_overflow(before.t_ns, sample.t_ns, &back_ns)) {
      back_ns = std::numeric_limits<std::int64_t>::max();
    }
    order.longest_backward_ns = std::max(order.longest_backward_ns, back_ns);
  }
  if (order.backward_steps > 0) {
    std::stable_sort(log.samples.begin(), log.samples.end(),
                     [](const GazeSample& a, const GazeSample& b) { return a.t_ns < b.t_ns; });
    log.warnings.push_back(fmt::format("{}: sorted by time; {} {} backwards", log.source, order.backward_steps,
                                       order.backward_steps == 1 ? "step went" : "steps went"));
  }
}

void drop_duplicates(GazeLog& log, UnorderedPolicy policy) {
  GazeOrder& order = log.order;
  std::vector<GazeSample>& samples = log.samples;
  std::size_t kept = 0;
  std::size_t group = 0;  // index of the first kept row of the current time
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (kept > 0 && samples[kept - 1].t_ns != samples[i].t_ns) {
      group = kept;
    }
    std::size_t twin = group;
    while (twin < kept && samples[twin].eye != samples[i].eye) {
      ++twin;
    }
    if (twin < kept) {
      if (order.duplicates++ == 0) {
        order.first_duplicate_row = samples[i].row;
        order.first_duplicate_ns = samples[i].t_ns;
        order.row_repeated = samples[twin].row;
        if (policy == UnorderedPolicy::error) {
          throw Error(ErrorKind::input, place_of(log, samples[i].row), duplicate_problem(order),
                      "remove one of them, or use `gaze-sort`, which keeps the last");
        }
      }
      order.identical_duplicates += is_same_position(samples[twin], samples[i]) ? 1 : 0;
      samples[twin] = samples[i];
      continue;
    }
    if (kept != i) {
      samples[kept] = samples[i];
    }
    ++kept;
  }
  samples.resize(kept);
  if (order.duplicates > 0) {
    log.warnings.push_back(fmt::format("{}: {} {} dropped: the last row of equal times is kept", log.source,
                                       order.duplicates, order.duplicates == 1 ? "duplicate was" : "duplicates were"));
  }
}

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

}  // namespace gazetrace
