// SPDX-License-Identifier: Apache-2.0
// Gaze is biometric, and a time of day tells whose it is. Files must contain neither times of day nor an
// experiment's words on its participants, unless the user keeps them. This is the one place that hides
// them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// Stamps that count from 1970 and fall into this century are times of day, which identify a session.
bool is_wall_clock(const GazeLog& log);
// Counts all stamps of a log from its first sample on; returns the time that was taken off. Mapping to video time only
// knows differences, so nothing else changes.
std::int64_t count_from_first_sample(GazeLog& log);
// Dates and times of day in a text become "(date)".
std::string without_dates(const std::string& text);
// Numbers of 18 or 19 digits, nanoseconds since 1970, become "(stamp)".
std::string without_stamps(const std::string& text);

struct LogWithoutTimesOfDay {
  GazeLog log;
  // The time taken off every stamp; empty where the stamps are no times of day and stay as they are.
  std::optional<std::int64_t> taken_off_ns;
};
// The log with its stamps counted from the first sample where they are times of day, those of rows out of order, too,
// and without dates in its clock's description and its warnings. Its messages and events keep their words.
LogWithoutTimesOfDay without_times_of_day(GazeLog log);

// For copies of a log, whose stamps stay, because other programs hold them against recordings of the same clock: takes
// dates out of the words on the clock and out of the warnings, and leaves out the messages of the experiment, into
// which participants, serial numbers and dates are written. Returns a message about that.
Warnings leave_out_identities(GazeLog& log);

}  // namespace gazetrace
