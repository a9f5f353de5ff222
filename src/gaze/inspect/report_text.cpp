// SPDX-License-Identifier: Apache-2.0
// An inspection for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr std::array kValidities{GazeValidity::ok,   GazeValidity::low_confidence, GazeValidity::blink,
                                 GazeValidity::lost, GazeValidity::off_screen,     GazeValidity::interpolated};
constexpr std::array kEvents{GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink,
                             GazeEventType::message, GazeEventType::segment};

double ms(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-6;
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
  text.line("format", "{} ({:.0f} % sure), {}", r.format, 100 * r.format_confidence,
            r.kind == GazeKind::direction ? "directions from the head"
            : r.kind == GazeKind::screen  ? "on a screen"
                                          : "on a scene camera's picture");
  for (const GazeFact& fact : r.facts) {
    text.plain(fmt::format("  {:<17} {} ({}{}{})", fact.what, fact.value,
                           fact.evidence == Evidence::statistics ? "a guess by statistics" : to_string(fact.evidence),
                           fact.detail.empty() ? "" : ": ", fact.detail));
  }
  text.line("geometry", "{}", r.geometry ? geometry_text(*r.geometry) : "not stated by the log");
}

void write_time(const GazeInspection& r, Text& text) {
  const GazeTiming& t = r.timing;
  if (r.is_wall_clock && t.first_ns == 0) {
    text.line("time", "a clock that counts from 1970; stamps are not shown without `keep-ids`");
  } else {
    text.line("time", "{} ns to {} ns{}", t.first_ns, t.last_ns, r.clock.empty() ? "" : " (clock: " + r.clock + ")");
  }
  text.line("rate", "{:.2f} Hz by the median step, {:.2f} Hz by the mean; {}", t.median_rate_hz, t.mean_rate_hz,
            t.nominal_rate_hz > 0 ? fmt::format("the log states {:g} Hz", t.nominal_rate_hz) : "the log states none");
  text.line("steps", "{:.3f} to {:.3f} ms (middle half), jitter {:.3f} ms", t.step_q1_ns * 1e-6, t.step_q3_ns * 1e-6,
            t.jitter_ns * 1e-6);
  text.line("gaps", "{}{}", t.gaps,
            t.gaps == 0
                ? ""
                : fmt::format(", longest {:.1f} ms, {:.1f} ms in all", ms(t.longest_gap_ns), ms(t.gaps_total_ns)));
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
  for (const GazeValidity validity : kValidities) {
    if (const std::size_t count = loss.by_validity[static_cast<std::size_t>(validity)]; count > 0) {
      text.plain(fmt::format("  {:<17} {} ({:.2f} %)", to_string(validity), count, percent(count)));
    }
  }
  text.line("losses", "{} like blinks (50 to 500 ms{}), {} longer, longest {:.1f} ms", loss.blink_like,
            loss.blink_like > 0 ? fmt::format(", median {:.0f} ms", loss.blink_like_median_ms) : "", loss.longer,
            ms(loss.longest_ns));
  text.line("frozen", "{} runs of one position{}; {:.2f} % of the samples repeat the one before", r.frozen.runs,
            r.frozen.runs > 0
                ? fmt::format(", longest {:.0f} ms in line {}", ms(r.frozen.longest_ns), r.frozen.longest_row)
                : "",
            100 * r.frozen.repeated_share);
  if (loss.usable > 0) {
    const bool screen = r.kind != GazeKind::direction;
    text.line("range", "{} {:.4f} to {:.4f}, {} {:.4f} to {:.4f}", screen ? "u" : "x", r.range_x[0], r.range_x[1],
              screen ? "v" : "y", r.range_y[0], r.range_y[1]);
  }
  const int digits = r.unit == "of the picture" ? 5 : r.unit == "px" ? 2 : 3;
  if (r.precision) {
    text.line("precision", "RMS-S2S {:.{}f} {}, SD {:.{}f} {}, medians of {} fixations", r.precision->rms_s2s, digits,
              r.unit, r.precision->sd, digits, r.unit, r.precision->fixations);
  } else {
    text.line("precision", "no stretch of 100 ms is still enough to measure it");
  }
  if (r.calibrations.empty()) {
    text.line("accuracy", "the log has no validation");
  }
  for (const GazeCalibration& c : r.calibrations) {
    text.line("accuracy", "{} eye: {} deg mean, {} deg at most, by the validation in line {}", to_string(c.eye),
              c.mean_error_deg, std::isnan(c.max_error_deg) ? "?" : fmt::format("{}", c.max_error_deg), c.row);
  }
  if (r.disparity) {
    const GazeDisparity& d = *r.disparity;
    text.line("disparity", "left minus right: {:.{}f} {} to the right (spread {:.{}f}), {:.{}f} {} up (spread {:.{}f})",
              d.horizontal, digits, r.unit, d.horizontal_spread, digits, d.vertical, digits, r.unit, d.vertical_spread,
              digits);
  }
  std::string events;
  for (std::size_t i = 0; i < kEvents.size(); ++i) {
    if (r.events[i] > 0) {
      events += fmt::format("{}{} {}{}", events.empty() ? "" : ", ", r.events[i], to_string(kEvents[i]),
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
      text.plain(fmt::format("  mended by       {}", finding.setting));
    }
  }
  text.line("verdict", "{}", r.verdict);
  return text.str();
}

}  // namespace gazetrace
