// SPDX-License-Identifier: Apache-2.0
// The lid covers part of the pupil before and after a tracker loses it, which moves the gaze that it reports. Blinks
// are those that the log names, and losses of 50 to 500 ms.
#include <fmt/format.h>

#include "gaze/events/event_method.hpp"
#include "gaze/process/gaze_step.hpp"

namespace gazetrace {

std::string apply_pad_blinks(GazeLog& log, const GazeStep& step) {
  constexpr std::int64_t kMinBlinkNs = 50'000'000;
  constexpr std::int64_t kMaxBlinkNs = 500'000'000;
  const std::vector<std::int64_t> t_ns = times_of(log);
  std::vector<EyeMovement> labels = absence_labels(log, t_ns);
  infer_blinks(t_ns, kMinBlinkNs, kMaxBlinkNs, labels);
  const std::int64_t before_ns = step.duration_ns("before");
  const std::int64_t after_ns = step.duration_ns("after");
  std::size_t blinks = 0;
  std::size_t padded = 0;
  const auto pad = [&](std::size_t i) {
    if (is_usable(log.samples[i].validity)) {
      log.samples[i].validity = GazeValidity::blink;
      ++padded;
    }
  };
  std::size_t done = 0;  // all samples before it have been handled
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != EyeMovement::blink) {
      continue;
    }
    ++blinks;
    for (std::size_t k = i; k > done && t_ns[i] - t_ns[k - 1] <= before_ns; --k) {
      pad(k - 1);
    }
    while (i + 1 < labels.size() && labels[i + 1] == EyeMovement::blink) {
      ++i;
    }
    const std::size_t last = i;
    for (done = last + 1;
         done < labels.size() && labels[done] != EyeMovement::blink && t_ns[done] - t_ns[last] <= after_ns; ++done) {
      pad(done);
    }
    i = done - 1;
  }
  return fmt::format("{} blinks, {} samples beside them taken for blink", blinks, padded);
}

}  // namespace gazetrace
