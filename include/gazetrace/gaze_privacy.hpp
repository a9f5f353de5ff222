// SPDX-License-Identifier: Apache-2.0
// Gaze is biometric, and a time of day tells whose it is. What is written by itself shall carry neither times of day
// nor what an experiment said of its participants; this is the one place that says how that is done.
#pragma once

#include <cstdint>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// For what is computed from a log: takes dates out of its warnings and, where its stamps are times of day, counts them
// from the first sample. Returns what was taken off the stamps, ns; 0: they are no times of day.
std::int64_t hide_times_of_day(GazeLog& log);

// For copies of a log, whose stamps stay, because other programs hold them against recordings of the same clock: takes
// dates out of what is said of the clock, and leaves out messages of the experiment, into which participants, serial
// numbers and dates are written. Returns what to tell of that.
Warnings leave_out_identities(GazeLog& log);

}  // namespace gazetrace
