// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "gazetrace/gaze_events.hpp"

// Compares the events of one kind in `found` with those in `truth`. Two events agree where they overlap for at least
// half of the longer one's time. At most one event can agree with each, so it is enough to count in one direction. F1
// is the harmonic mean of precision and recall.
struct EventScore {
  std::size_t truth = 0, found = 0, agreeing = 0;
  [[nodiscard]] double f1() const {
    return truth + found == 0 ? 1 : 2.0 * static_cast<double>(agreeing) / static_cast<double>(truth + found);
  }
};

inline EventScore score_events(const std::vector<gazetrace::EyeEvent>& truth,
                               const std::vector<gazetrace::EyeEvent>& found, gazetrace::EyeMovement movement) {
  std::vector<gazetrace::EyeEvent> a;
  std::vector<gazetrace::EyeEvent> b;
  const auto is_wanted = [&](const gazetrace::EyeEvent& e) { return e.movement == movement; };
  std::copy_if(truth.begin(), truth.end(), std::back_inserter(a), is_wanted);
  std::copy_if(found.begin(), found.end(), std::back_inserter(b), is_wanted);
  EventScore score{a.size(), b.size(), 0};
  std::size_t from = 0;
  for (const gazetrace::EyeEvent& t : a) {
    while (from < b.size() && b[from].end_ns < t.begin_ns) {
      ++from;
    }
    for (std::size_t i = from; i < b.size() && b[i].begin_ns <= t.end_ns; ++i) {
      const auto shared = std::min(t.end_ns, b[i].end_ns) - std::max(t.begin_ns, b[i].begin_ns);
      const auto longer = std::max(t.end_ns - t.begin_ns, b[i].end_ns - b[i].begin_ns);
      if (2 * shared > longer) {
        ++score.agreeing;
        break;
      }
    }
  }
  return score;
}
