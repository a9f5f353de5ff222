// SPDX-License-Identifier: Apache-2.0
#include "gaze/events/absence.hpp"

#include <algorithm>

namespace gazetrace {

std::vector<EyeMovement> absence_labels(const GazeLog& log, const std::vector<std::int64_t>& t_ns) {
  std::vector<EyeMovement> labels(log.samples.size(), EyeMovement::unclassified);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!is_usable(log.samples[i].validity)) {
      labels[i] = log.samples[i].validity == GazeValidity::blink ? EyeMovement::blink : EyeMovement::lost;
    }
  }
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::blink) {
      continue;
    }
    const auto begin = std::lower_bound(t_ns.begin(), t_ns.end(), event.begin_ns);
    for (auto at = begin; at != t_ns.end() && *at <= event.end_ns; ++at) {
      const auto i = static_cast<std::size_t>(at - t_ns.begin());
      labels[i] = labels[i] == EyeMovement::lost ? EyeMovement::blink : labels[i];
    }
  }
  return labels;
}

void infer_blinks(const std::vector<std::int64_t>& t_ns, std::int64_t min_ns, std::int64_t max_ns,
                  std::vector<EyeMovement>& labels) {
  const auto is_away = [&](std::size_t i) { return labels[i] == EyeMovement::lost || labels[i] == EyeMovement::blink; };
  for (std::size_t i = 0; max_ns > 0 && i < labels.size(); ++i) {
    if (!is_away(i)) {
      continue;
    }
    std::size_t end = i;
    bool named = false;
    while (end < labels.size() && is_away(end)) {
      named = named || labels[end] == EyeMovement::blink;
      ++end;
    }
    const bool between = i > 0 && end < labels.size();
    const std::int64_t away_ns = between ? t_ns[end] - t_ns[i - 1] : 0;
    if (between && away_ns <= max_ns && (named || away_ns >= min_ns)) {
      std::fill(labels.begin() + static_cast<std::ptrdiff_t>(i), labels.begin() + static_cast<std::ptrdiff_t>(end),
                EyeMovement::blink);
    }
    i = end;
  }
}

}  // namespace gazetrace
