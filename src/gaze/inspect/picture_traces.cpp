// SPDX-License-Identifier: Apache-2.0
// x and y over time, and below them what the log says about each moment. Long logs are thinned to the extremes of every
// column of pixels, so that no excursion is lost.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "gaze/inspect/picture_parts.hpp"

namespace gazetrace {
namespace {

constexpr double kStrip = 13;
constexpr std::array<const char*, 3> kEventColors{"#4c8c5a", "#d08a2e", "#8a5aa8"};
constexpr std::array<const char*, 3> kEventNames{"fixation", "saccade", "blink"};

// For each column of pixels the first, lowest, highest and last value, joined by lines; losses and gaps interrupt them.
std::string trace_path(const GazeTrack& track, const std::vector<double>& values, const Axis& time, const Axis& value,
                       double gap_s) {
  std::string path;
  double column = -1;
  double first = 0;
  double low = 0;
  double high = 0;
  double last = 0;
  bool open = false;     // a run has begun
  bool started = false;  // its first point is written
  const auto point = [&](double x, double y) {
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", started ? "L" : "M", x, y);
    started = true;
  };
  const auto flush = [&] {
    if (open && column >= 0) {
      const double x = column + 0.5;
      point(x, value.at(first));
      if (low < std::min(first, last)) {
        point(x, value.at(low));
      }
      if (high > std::max(first, last)) {
        point(x, value.at(high));
      }
      point(x, value.at(last));
    }
  };
  double before_s = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i]) || (open && track.s[i] - before_s > gap_s)) {
      flush();
      open = started = false;
      if (std::isnan(values[i])) {
        continue;
      }
    }
    before_s = track.s[i];
    // A resolution of half pixels is enough for print.
    const double at = std::floor(2 * time.at(track.s[i])) / 2;
    if (open && at == column) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    } else {
      flush();
      column = at;
      first = low = high = values[i];
    }
    last = values[i];
    open = true;
  }
  flush();
  return path;
}

// Spans of time in half pixels of the axis; overlapping ones are drawn once.
class Spans {
 public:
  explicit Spans(const Axis& time) : time_(time), covered_(static_cast<std::size_t>(2 * (time.end - time.begin)) + 2) {}
  void add(double begin_s, double end_s) {
    const double last = static_cast<double>(covered_.size()) - 1;
    const auto cell = [&](double s) {
      return static_cast<std::size_t>(std::clamp(2 * (time_.at(s) - time_.begin), 0.0, last));
    };
    std::fill(covered_.begin() + static_cast<std::ptrdiff_t>(cell(begin_s)),
              covered_.begin() + static_cast<std::ptrdiff_t>(cell(end_s)) + 1, true);
  }
  void draw(PictureSvg& svg, double top, double height, const char* color, double opacity) const {
    std::string path;
    for (std::size_t i = 0; i < covered_.size();) {
      std::size_t end = i;
      while (end < covered_.size() && covered_[end]) {
        ++end;
      }
      if (end > i) {
        fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z",
                       time_.begin + static_cast<double>(i) / 2, top, static_cast<double>(end - i) / 2, height,
                       static_cast<double>(end - i) / 2);
      }
      i = std::max(end, i + 1);
    }
    if (!path.empty()) {
      svg.add(fmt::format(R"(<path d="{}" fill="{}" fill-opacity="{}"/>)", path, color, opacity));
    }
  }

 private:
  Axis time_;
  std::vector<bool> covered_;
};

struct Losses {
  Spans lost, gaps;
};

Losses find_losses(const GazeTrack& track, const Axis& time, double gap_s) {
  Losses losses{Spans(time), Spans(time)};
  for (std::size_t i = 0; i < track.s.size(); ++i) {
    if (i > 0 && track.s[i] - track.s[i - 1] > gap_s) {
      losses.gaps.add(track.s[i - 1], track.s[i]);
    }
    if (std::isnan(track.x[i])) {
      losses.lost.add(track.s[i], i + 1 < track.s.size() ? std::min(track.s[i + 1], track.s[i] + gap_s) : track.s[i]);
    }
  }
  return losses;
}

void draw_trace(PictureSvg& svg, const GazeTrack& track, const std::vector<double>& values, const Axis& time,
                const Axis& value, const Losses& losses, double gap_s, const std::string& label, const char* color,
                int clip) {
  const double top = std::min(value.begin, value.end);
  const double height = std::abs(value.end - value.begin);
  losses.gaps.draw(svg, top, height, "#9a9a9a", 0.22);
  losses.lost.draw(svg, top, height, "#c8463c", 0.20);
  for (const double t : ticks(value, 4)) {
    const double y = value.at(t);
    svg.add(fmt::format(R"(<path d="M{:.1f} {:.1f}H{:.1f}" stroke="#e2e2e2"/>)", time.begin, y, time.end));
    svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", time.begin - 7, y + 4, t));
  }
  svg.add(fmt::format(R"(<clipPath id="c{}"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)",
                      clip, time.begin, top, time.end - time.begin, height));
  svg.add(fmt::format(
      R"-(<path d="{}" fill="none" stroke="{}" stroke-width="0.9" stroke-linejoin="round" clip-path="url(#c{})"/>)-",
      trace_path(track, values, time, value, gap_s), color, clip));
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#444"/>)",
                      time.begin, top, time.end - time.begin, height));
  svg.add(fmt::format(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)-",
                      20.0, top + height / 2, label));
}

}  // namespace

void draw_traces(PictureSvg& svg, const GazeTrack& track, const Axis& time, const Axis& x, const Axis& y,
                 double gap_s) {
  const Losses losses = find_losses(track, time, gap_s);
  draw_trace(svg, track, track.x, time, x, losses, gap_s, track.x_label, "#1f4e79", 0);
  draw_trace(svg, track, track.y, time, y, losses, gap_s, track.y_label, "#8c3b1e", 1);
  for (const double t : ticks(time, 10)) {
    svg.add(fmt::format(
        R"(<path d="M{:.1f} {:.1f}v5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)",
        time.at(t), y.end, time.at(t), y.end + 18, t));
  }
  svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">time from the first sample [s]</text>)",
                      (time.begin + time.end) / 2, y.end + 36));
}

double draw_events(PictureSvg& svg, const GazeLog& log, const Axis& time, double top) {
  const std::int64_t first = log.samples.front().t_ns;
  const auto seconds = [&](std::int64_t t) { return static_cast<double>(t - first) * 1e-9; };
  for (std::size_t type = 0; type < kEventNames.size(); ++type) {
    Spans spans(time);
    bool any = false;
    for (const GazeEvent& event : log.events) {
      if (static_cast<std::size_t>(event.type) == type) {
        spans.add(seconds(event.begin_ns), seconds(event.end_ns));
        any = true;
      }
    }
    if (!any) {
      continue;
    }
    svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{}s</text>)", time.begin - 7, top + kStrip - 3,
                        kEventNames[type]));
    spans.draw(svg, top, kStrip - 3, kEventColors[type], 0.9);
    top += kStrip;
  }
  return top;
}

}  // namespace gazetrace
