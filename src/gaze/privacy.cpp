// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_privacy.hpp"

#include <fmt/format.h>

#include <regex>
#include <utility>

namespace gazetrace {
namespace {

// What a log says in words of its clock, and of what had to be guessed or mended. Of recordings the numbers stay.
void take_dates_out(GazeLog& log) {
  for (GazeRecording& recording : log.recordings) {
    recording.name.clear();
  }
  log.clock = without_dates(log.clock);
  for (Warnings* const warnings : {&log.warnings, &log.conventions.warnings}) {
    for (std::string& warning : *warnings) {
      warning = without_dates(warning);
    }
  }
}

}  // namespace

std::string without_dates(const std::string& text) {
  // 2022/09/19, 19.09.2022, 2022-09-19T13:34:49.156, 13:34:49.156
  static const std::regex kDate(
      R"((\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{4})([T ]?\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?Z?)?|\d{1,2}:\d{2}:\d{2}([.,]\d+)?)");
  return std::regex_replace(text, kDate, "(date)");
}

std::string without_stamps(const std::string& text) {
  static const std::regex kStamp(R"(\b\d{18,19}\b)");
  return std::regex_replace(text, kStamp, "(stamp)");
}

bool is_wall_clock(const GazeLog& log) {
  constexpr std::int64_t kYear2000 = 946'684'800'000'000'000;
  constexpr std::int64_t kYear2100 = 4'102'444'800'000'000'000;
  return !log.samples.empty() && log.samples.front().t_ns >= kYear2000 && log.samples.front().t_ns < kYear2100;
}

std::int64_t count_from_first_sample(GazeLog& log) {
  const std::int64_t first = log.samples.empty() ? 0 : log.samples.front().t_ns;
  const auto shift = [&](std::int64_t& t_ns) {
    if (__builtin_sub_overflow(t_ns, first, &t_ns)) {
      t_ns = 0;  // half an age away from the recording: no time of it
    }
  };
  for (GazeSample& sample : log.samples) {
    shift(sample.t_ns);
  }
  for (EyeOrigins& origins : log.origins) {
    shift(origins.t_ns);
  }
  for (HeadPose& pose : log.head) {
    shift(pose.t_ns);
  }
  for (GazeEvent& event : log.events) {
    shift(event.begin_ns);
    shift(event.end_ns);
  }
  for (GazeCalibration& calibration : log.calibrations) {
    shift(calibration.t_ns);
  }
  if (log.trial) {
    shift(log.trial->begin_ns);
    shift(log.trial->end_ns);
  }
  for (GazeRecording& recording : log.recordings) {
    shift(recording.first_ns);
    shift(recording.last_ns);
  }
  if (log.order.first_backward_row != 0) {
    shift(log.order.first_backward_ns);
    shift(log.order.before_ns);
  }
  if (log.order.first_duplicate_row != 0) {
    shift(log.order.first_duplicate_ns);
  }
  return first;
}

LogWithoutTimesOfDay without_times_of_day(GazeLog log) {
  LogWithoutTimesOfDay result{std::move(log), std::nullopt};
  take_dates_out(result.log);
  if (is_wall_clock(result.log)) {
    result.taken_off_ns = count_from_first_sample(result.log);
  }
  return result;
}

Warnings leave_out_identities(GazeLog& log) {
  take_dates_out(log);
  for (GazeEvent& event : log.events) {
    event.text = event.type == GazeEventType::trial ? std::string() : std::move(event.text);  // as messages name them
  }
  const std::size_t left_out =
      std::erase_if(log.events, [](const GazeEvent& event) { return event.type == GazeEventType::message; });
  if (left_out == 0) {
    return {};
  }
  return {fmt::format("{}: {} left out, as messages may say who was recorded; `keep-ids` keeps them", log.source,
                      left_out == 1 ? "1 message is" : fmt::format("{} messages are", left_out))};
}

}  // namespace gazetrace
