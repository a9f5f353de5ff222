// SPDX-License-Identifier: Apache-2.0
// How long events of the eye last, for tables, areas of interest and reports alike.
#pragma once

#include <cstdint>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace {

// As `duration_ms` in the tables: the tracker's value, else as many steps of the clock as the event has
// samples, so that one sample does not last 0 ms. `step_ns` is the log's.
std::int64_t event_duration_ns(const EyeEvent& event, std::int64_t step_ns);

// The median step of the log's clock; 0 for fewer than two samples.
std::int64_t event_step_ns(const GazeLog& log);

}  // namespace gazetrace
