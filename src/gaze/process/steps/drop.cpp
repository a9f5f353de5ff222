// SPDX-License-Identifier: Apache-2.0
// Loss of data: a sample is lost when a random number that depends on the seed and the sample's time is below the
// share.
#include <fmt/format.h>

#include "gaze/process/gaze_step.hpp"

namespace gazetrace {

std::string apply_drop(GazeLog& log, const GazeStep& step) {
  constexpr std::uint64_t kStream = 0x64726f70;
  const CounterRandom random(static_cast<std::uint64_t>(step.value("seed")), kStream);
  std::size_t dropped = 0;
  for (GazeSample& sample : log.samples) {
    if (is_usable(sample.validity) &&
        random.uniform(static_cast<std::uint64_t>(sample.t_ns), 0) < step.value("share")) {
      sample.validity = GazeValidity::lost;
      ++dropped;
    }
  }
  return fmt::format("{} samples lost", dropped);
}

}  // namespace gazetrace
