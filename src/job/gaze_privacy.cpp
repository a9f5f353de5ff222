// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_privacy.hpp"

#include <fmt/format.h>

#include "gazetrace/gaze_inspect.hpp"

namespace gazetrace {

std::int64_t hide_times_of_day(GazeLog& log) {
  for (std::string& warning : log.warnings) {
    warning = without_dates(warning);
  }
  return is_wall_clock(log) ? count_from_first_sample(log) : 0;
}

Warnings leave_out_identities(GazeLog& log) {
  log.clock = without_dates(log.clock);
  const std::size_t left_out =
      std::erase_if(log.events, [](const GazeEvent& event) { return event.type == GazeEventType::message; });
  if (left_out == 0) {
    return {};
  }
  return {fmt::format("{}: {} left out, as messages may say who was recorded; `keep-ids` keeps them", log.source,
                      left_out == 1 ? "1 message is" : fmt::format("{} messages are", left_out))};
}

}  // namespace gazetrace
