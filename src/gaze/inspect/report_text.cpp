// SPDX-License-Identifier: Apache-2.0
// An inspection for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gaze/inspect/inspect.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

double ms(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
}

// Nanoseconds in the unit that people would choose.
std::string duration_text(std::int64_t ns) {
  const double s = static_cast<double>(ns) * 1e-9;
  return s < 1       ? fmt::format("{:.1f} ms", ms(ns))
         : s < 120   ? fmt::format("{:.2f} s", s)
         : s < 7200  ? fmt::format("{:.1f} min", s / 60)
         : s < 1.7e5 ? fmt::format("{:.1f} h", s / 3600)
                     : fmt::format("{:.1f} days", s / 86400);
}

class Text {
 public:
  template <class... Values>
  void line(std::string_view label, fmt::format_string<Values...> pattern, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), "{:<13}", label);
    fmt::format_to(std::back_inserter(text_), pattern, std::forward<Values>(values)...);
    text_ += '\n';
  }
  void plain(const std::string& text) { text_ += text + "\n"; }
  void append(const std::string& lines) { text_ += lines; }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
};

std::string geometry_text(const DisplayGeometry& g) {
  const auto px = g.width_px > 0 ? fmt::format("{} x {} px", g.width_px, g.height_px) : "pixels not stated";
  const auto size = g.width_cm > 0 ? fmt::format("{:.5g} x {:.5g} cm", g.width_cm, g.height_cm) : "size not stated";
  const auto distance = g.distance_cm > 0 ? fmt::format("at {:.5g} cm", g.distance_cm) : "distance not stated";
  return fmt::format("{}, {}, {}", px, size, distance);
}

void write_log(const GazeInspection& r, Text& text) {
  text.plain(r.source);
  text.line("format", "{}{}, {}", r.format,
            r.format == "generic"     ? " (a table that no format claims; `format` names one)"
            : r.format_confidence < 1 ? fmt::format(" (known by the content of the file, with {:.0f} % certainty; "
                                                    "`format` names another)",
                                                    100 * r.format_confidence)
                                      : "",
            r.kind == GazeKind::direction ? "directions from the head"
            : r.kind == GazeKind::screen  ? "on a screen"
                                          : "on a scene camera's picture");
  text.append(decisions_in_words(r.facts));
  text.line("geometry", "{}", r.geometry ? geometry_text(*r.geometry) : "not stated by the log");
}

void write_recordings(const GazeInspection& r, Text& text) {
  if (r.recordings.empty()) {
    return;
  }
  text.line("recordings", "the file holds {} {}; {}", r.recordings.size(),
            r.recordings.front().is_block ? "blocks of one recording" : "recordings",
            r.recording == 0 ? "this is all of them, and `gaze-recording` takes one"
                             : fmt::format("this is number {}", r.recording));
  for (std::size_t i = 0; i < r.recordings.size(); ++i) {
    const GazeRecording& recording = r.recordings[i];
    const double seconds = static_cast<double>(duration_ns(recording)) * 1e-9;
    text.plain(fmt::format("  {:<17} {} rows from line {} on, {:.1f} s{}", i + 1, recording.rows, recording.first_row,
                           seconds, recording.name.empty() ? "" : ", " + recording.name));
  }
}

void write_time(const GazeInspection& r, Text& text) {
  const GazeTiming& t = r.timing;
  if (r.is_wall_clock && t.first_ns == 0) {
    text.line("time", "{}; the stamps are times of day, and are not shown without `keep-ids`",
              duration_text(r.span_ns));
  } else {
    text.line("time", "{}, from {:.3f} s to {:.3f} s{} ({} ns to {} ns)", duration_text(r.span_ns),
              static_cast<double>(t.first_ns) * 1e-9, static_cast<double>(t.last_ns) * 1e-9,
              r.clock.empty() ? "" : " of the clock: " + r.clock, t.first_ns, t.last_ns);
  }
  if (r.loss.samples < 2) {
    text.line("rate", "not known: the log holds one row");
    return;
  }
  text.line("rate", "{:.2f} Hz by the median step, {:.2f} Hz by the mean{}; {}", t.median_rate_hz, t.mean_rate_hz,
            t.gaps > 0 ? " without the gaps" : "",
            t.nominal_rate_hz > 0 ? fmt::format("the log states {:g} Hz", t.nominal_rate_hz) : "the log states none");
  text.line("steps", "half of them last {:.3f} to {:.3f} ms; their standard deviation (jitter) is {:.3f} ms",
            t.step_q1_ns * 1e-6, t.step_q3_ns * 1e-6, t.jitter_ns * 1e-6);
  text.line("gaps", "{}{}", t.gaps,
            t.gaps == 0 ? ""
                        : fmt::format(", longest {}, {} in all", duration_text(t.longest_gap_ns),
                                      duration_text(t.gaps_total_ns)));
  if (t.pauses > 0) {
    text.line("pauses", "{} between blocks of the recording, {} in all; they are no losses", t.pauses,
              duration_text(t.pauses_total_ns));
  }
  text.line("order", "{} of {} rows go back in time, {} repeat a time", r.order.backward_steps, r.order.rows,
            r.order.duplicates);
}

void write_quality(const GazeInspection& r, Text& text) {
  const GazeLoss& loss = r.loss;
  const auto percent = [&](std::size_t n) {
    return 100.0 * static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(loss.samples, 1));
  };
  text.line("usable", "{} of {} ({:.2f} %){}", loss.usable, loss.samples, percent(loss.usable),
            loss.left_share ? fmt::format("; left eye {:.2f} %, right eye {:.2f} %", 100 * *loss.left_share,
                                          100 * *loss.right_share)
                            : "");
  for (const GazeValidity validity : kReportedValidities) {
    if (const std::size_t count = loss.by_validity[static_cast<std::size_t>(validity)]; count > 0) {
      text.plain(fmt::format("  {:<17} {} ({:.2f} %)", to_string(validity), count, percent(count)));
    }
  }
  const bool loses = loss.usable < loss.samples;
  text.line("losses", "{} as long as blinks (50 to 500 ms{}), {} longer{}{}{}", loss.blink_like,
            loss.blink_like > 0 ? fmt::format(", median {:.0f} ms", loss.blink_like_median_ms) : "", loss.longer,
            loses ? ", the longest " + duration_text(loss.longest_ns) : "",
            loss.leading_ns > 0 ? ", " + duration_text(loss.leading_ns) + " at the beginning" : "",
            loss.trailing_ns > 0 ? ", " + duration_text(loss.trailing_ns) + " at the end" : "");
  text.line(
      "frozen",
      "stretches of 100 ms or more in which the position stands still: {}{}; {:.2f} % of the samples repeat the one "
      "before",
      r.frozen.runs,
      r.frozen.runs > 0
          ? fmt::format(", at most for {} from line {} on", duration_text(r.frozen.longest_ns), r.frozen.longest_row)
          : "",
      100 * r.frozen.repeated_share);
  if (loss.usable > 0) {
    const bool screen = r.kind != GazeKind::direction;
    text.line("range", "{} {:.4f} to {:.4f}, {} {:.4f} to {:.4f}", screen ? "u" : "x", r.range_x[0], r.range_x[1],
              screen ? "v" : "y", r.range_y[0], r.range_y[1]);
  }
  const int digits = r.unit == "of the picture" ? 5 : r.unit == "px" ? 2 : 3;
  if (r.precision) {
    text.line(
        "precision",
        "{:.{}f} {} from sample to sample (RMS-S2S), standard deviation {:.{}f} {}; medians of {} still stretches",
        r.precision->rms_s2s, digits, r.unit, r.precision->sd, digits, r.unit, r.precision->fixations);
  } else {
    text.line("precision", "not known: gaze never stands still for 100 ms");
  }
  if (r.calibrations.empty()) {
    text.line("accuracy", "not known: the log has no validation by the tracker");
  }
  for (const GazeCalibration& c : r.calibrations) {
    text.line("accuracy", "{} eye: {} deg mean, {} deg at most, by the validation in line {}", to_string(c.eye),
              c.mean_error_deg, std::isnan(c.max_error_deg) ? "?" : fmt::format("{}", c.max_error_deg), c.row);
  }
  if (r.disparity) {
    const GazeDisparity& d = *r.disparity;
    text.line("disparity", "left minus right: {:.{}f} {} to the {} (spread {:.{}f}), {:.{}f} {} {} (spread {:.{}f})",
              std::abs(d.horizontal), digits, r.unit, d.horizontal < 0 ? "left" : "right", d.horizontal_spread, digits,
              std::abs(d.vertical), digits, r.unit, d.vertical < 0 ? "down" : "up", d.vertical_spread, digits);
  }
  std::string events;
  for (std::size_t i = 0; i < kReportedEvents.size(); ++i) {
    if (r.events[i] > 0) {
      events += fmt::format("{}{} {}{}", events.empty() ? "" : ", ", r.events[i], to_string(kReportedEvents[i]),
                            r.events[i] == 1 ? "" : "s");
    }
  }
  text.line("events", "{}", events.empty() ? "none in the log" : events);
  if (r.head_poses > 0) {
    text.line("head", "{} poses", r.head_poses);
  }
}

}  // namespace

std::string inspection_text(const GazeInspection& r) {
  Text text;
  write_log(r, text);
  write_recordings(r, text);
  write_time(r, text);
  write_quality(r, text);
  for (const GazeAxisTest& test : r.axes) {
    text.line(fmt::format("axis {}", test.axis), "{}: {}", to_string(test.verdict), test.evidence);
  }
  for (const std::string& warning : r.warnings) {
    text.line("warning", "{}", warning);
  }
  for (const GazeFinding& finding : r.findings) {
    text.line(to_string(finding.kind), "{} [{}]", finding.what, finding.code);
    text.plain(fmt::format("  from            {}", finding.evidence));
    if (!finding.setting.empty()) {
      text.plain(fmt::format("  {:<15} {}",
                             finding.is_open                                                             ? "answered by"
                             : finding.code == "several-recordings" || finding.code == "display-changes" ? "first part"
                                                                                                         : "mended by",
                             finding.setting));
    }
  }
  text.line("verdict", "{}", r.verdict);
  return text.str();
}

}  // namespace gazetrace
