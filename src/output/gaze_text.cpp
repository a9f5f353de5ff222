// SPDX-License-Identifier: Apache-2.0
#include "output/gaze_text.hpp"

#include <fmt/format.h>

namespace gazetrace {

std::string gaze_words(const GazeAtTime& gaze) {
  const std::string age = gaze.age_is_known ? fmt::format("{}", gaze.age_ns) : "unknown";
  const std::string since =
      gaze.since_saccade_ns ? fmt::format(" since_saccade_ns={}", *gaze.since_saccade_ns) : std::string();
  return fmt::format(
      "state={} u={} v={} direction={},{},{} t_log_ns={} rows={},{} age_ns={} validity={} event={}{} no_gaze={}",
      to_string(gaze.state), gaze.u, gaze.v, gaze.direction.x, gaze.direction.y, gaze.direction.z, gaze.t_log_ns,
      gaze.row_before, gaze.row_after, age, to_string(gaze.validity),
      gaze.movement ? to_string(*gaze.movement) : "none", since, gaze.no_gaze ? 1 : 0);
}

}  // namespace gazetrace
