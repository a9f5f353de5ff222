// SPDX-License-Identifier: Apache-2.0
#include "output/gaze_text.hpp"

#include <fmt/format.h>

#include "gazetrace/output.hpp"

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

GazeNumbers gaze_numbers(const FrameRequest& request) {
  const GazeAtTime& gaze = request.gaze_true;
  GazeNumbers numbers;
  if (gaze.state == GazeState::none) {
    return numbers;
  }
  numbers.u = gaze.u;
  numbers.v = gaze.v;
  if (gaze.kind == GazeKind::direction) {
    const Vec2d px = request.view.pixel(request.gaze_direction_true.value_or(gaze.direction));
    numbers.u = px.x / request.view.width_px;
    numbers.v = px.y / request.view.height_px;
  }
  numbers.valid = gaze.no_gaze ? 0 : 1;
  return numbers;
}

}  // namespace gazetrace
