// SPDX-License-Identifier: Apache-2.0
#include "output/gaze_text.hpp"

#include <fmt/format.h>

namespace gazetrace {
namespace {

std::string where(const GazeAtTime& gaze) {
  const Vec3d& d = gaze.direction;
  return gaze.kind == GazeKind::direction ? fmt::format("direction={},{},{}", d.x, d.y, d.z)
                                          : fmt::format("u={} v={}", gaze.u, gaze.v);
}

}  // namespace

std::string gaze_words(const GazeAtTime& gaze) {
  const std::string age = gaze.age_is_known ? fmt::format("{}", gaze.age_ns) : "unknown";
  const std::string since =
      gaze.since_saccade_ns ? fmt::format(" since_saccade_ns={}", *gaze.since_saccade_ns) : std::string();
  return fmt::format("state={} {} t_log_ns={} rows={},{} age_ns={} validity={} event={}{} no_gaze={}",
                     to_string(gaze.state), where(gaze), gaze.t_log_ns, gaze.row_before, gaze.row_after, age,
                     to_string(gaze.validity), gaze.movement ? to_string(*gaze.movement) : "none", since,
                     gaze.no_gaze ? 1 : 0);
}

}  // namespace gazetrace
