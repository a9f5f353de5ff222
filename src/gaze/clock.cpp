// SPDX-License-Identifier: Apache-2.0
// Fits the relation of two clocks to events that both of them saw.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gaze/angles.hpp"
#include "gazetrace/gaze.hpp"

namespace gazetrace {

ClockFit fit_clock(const std::vector<ClockAnchor>& anchors) {
  if (anchors.empty()) {
    throw Error(ErrorKind::usage, "", "clocks cannot be fitted without an anchor");
  }
  // Differences to the first anchor are small enough for doubles, which could not hold the times themselves.
  const ClockAnchor& origin = anchors.front();
  const auto count = static_cast<double>(anchors.size());
  const auto since = [](std::int64_t t, std::int64_t begin) {
    return static_cast<double>(static_cast<long double>(t) - static_cast<long double>(begin));
  };
  double mean_log = 0;
  double mean_video = 0;
  for (const ClockAnchor& anchor : anchors) {
    mean_log += since(anchor.t_log_ns, origin.t_log_ns) / count;
    mean_video += since(anchor.t_video_ns, origin.t_video_ns) / count;
  }
  double square = 0;
  double product = 0;
  for (const ClockAnchor& anchor : anchors) {
    const double x = since(anchor.t_log_ns, origin.t_log_ns) - mean_log;
    square += x * x;
    product += x * (since(anchor.t_video_ns, origin.t_video_ns) - mean_video);
  }
  ClockFit fit;
  fit.event_ns = origin.t_log_ns;
  if (anchors.size() > 1) {
    fit.scale = square > 0 ? product / square : 0;
    if (!(fit.scale > 0) || !std::isfinite(fit.scale)) {
      throw Error(ErrorKind::usage, "`gaze-anchor`", "the anchors do not let both clocks go forward",
                  "give anchors at different times, in the same order on both clocks");
    }
  }
  const double offset = mean_video - fit.scale * mean_log;  // to the first anchor's video time
  // 9e18 fits int64, and is farther than 285 years.
  if (!(std::abs(offset) < 9e18) ||
      __builtin_add_overflow(origin.t_video_ns, std::int64_t{std::llround(offset)}, &fit.offset_ns)) {
    throw Error(ErrorKind::usage, "`gaze-anchor`", "the anchors lie so far apart that int64 nanoseconds do not reach",
                "give anchors within the log and the video");
  }
  for (const ClockAnchor& anchor : anchors) {
    const double left =
        since(anchor.t_video_ns, origin.t_video_ns) - (fit.scale * since(anchor.t_log_ns, origin.t_log_ns) + offset);
    fit.rms_residual_ns += left * left / count;
    fit.max_residual_ns = std::max(fit.max_residual_ns, std::abs(left));
  }
  fit.rms_residual_ns = std::sqrt(fit.rms_residual_ns);
  return fit;
}

std::int64_t time_of_message(const GazeLog& log, std::string_view text) {
  // "IMAGE ON#2" is the second one of them.
  std::size_t nth = 0;
  if (const std::size_t hash = text.rfind('#'); hash != std::string_view::npos) {
    nth = count_from(text.substr(hash + 1)).value_or(0);
    text = nth > 0 ? text.substr(0, hash) : text;
  }
  std::vector<const GazeEvent*> found =
      events_in_time(log, [&](const GazeEvent& event) { return trim(event.text) == text; });
  if (found.empty() && !text.empty()) {
    found = events_in_time(log, [&](const GazeEvent& event) { return event.text.find(text) != std::string::npos; });
  }
  if (found.empty()) {
    throw Error(ErrorKind::input, log.source, fmt::format("has no message '{}' to anchor its clock at", text),
                "give the text of a message, or a time such as 12.5s");
  }
  if (nth > found.size()) {
    throw Error(ErrorKind::input, log.source, fmt::format("has only {} messages with '{}'", found.size(), text));
  }
  if (nth > 0) {
    return found[nth - 1]->begin_ns;
  }
  if (found.size() > 1) {
    throw Error(ErrorKind::input, log.source,
                fmt::format("has {} messages with '{}', the first two in lines {} and {}", found.size(), text,
                            found[0]->row, found[1]->row),
                "give more of the text, #1 behind it for the first of them, or a time such as 12.5s");
  }
  return found.front()->begin_ns;
}

}  // namespace gazetrace
