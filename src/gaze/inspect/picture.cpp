// SPDX-License-Identifier: Apache-2.0
// An inspection as a picture: x and y over time, below them what the log says about each moment, and the scanpath. Long
// logs are thinned to the extremes of every column of pixels, so that no excursion is lost.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/statistics.hpp"
#include "core/svg.hpp"
#include "core/text.hpp"
#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr double kLeft = 78, kRight = 24, kTop = 64, kTrace = 170, kBetween = 22, kStrip = 13;
constexpr std::size_t kMostPoints = 30'000;  // of a scanpath drawn as a line; longer ones become densities
constexpr std::array<const char*, 3> kEventColors{"#4c8c5a", "#d08a2e", "#8a5aa8"};
constexpr std::array<const char*, 3> kEventNames{"fixation", "saccade", "blink"};

class Svg {
 public:
  template <class... Values>
  void add(fmt::format_string<Values...> pattern, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), pattern, std::forward<Values>(values)...);
    text_ += '\n';
  }
  void raw(const std::string& text) { text_ += text; }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
};

// What is drawn: two coordinates over seconds.
struct Track {
  std::vector<double> s, x, y;  // NaN where not usable
  double x_low = 0, x_high = 1, y_top = 0, y_bottom = 1;
  double frame_width = 1, frame_height = 1;  // of the display, in the unit; 0: there is none
  std::string x_label, y_label;
};

double beyond(double quantile_value, double edge, double most, int sign) {
  return sign < 0 ? std::max(std::min(quantile_value, edge), edge - most)
                  : std::min(std::max(quantile_value, edge), edge + most);
}

Track make_track(const GazeLog& log, const GazeInspection& inspection) {
  Track track;
  const bool direction = log.kind == GazeKind::direction;
  const GazePlane plane(log, std::nullopt);
  double width = 1;
  double height = 1;
  const bool px = !direction && inspection.geometry && inspection.geometry->width_px > 0;
  if (px) {
    width = inspection.geometry->width_px;
    height = inspection.geometry->height_px;
  }
  const std::int64_t first = log.samples.front().t_ns;
  std::vector<double> xs;
  std::vector<double> ys;
  for (std::vector<double>* const values : {&track.s, &track.x, &track.y}) {
    values->reserve(log.samples.size());
  }
  const std::size_t stride = log.samples.size() / 200'000 + 1;  // of the samples that decide the range of the axes
  for (const GazeSample& sample : log.samples) {
    Vec2d at{std::nan(""), std::nan("")};
    if (is_usable(sample.validity)) {
      at = direction ? plane.of(sample) : Vec2d{sample.u * width, sample.v * height};
      if (track.s.size() % stride == 0) {
        xs.push_back(at.x);
        ys.push_back(at.y);
      }
    }
    track.s.push_back(static_cast<double>(sample.t_ns - first) * 1e-9);
    track.x.push_back(at.x);
    track.y.push_back(at.y);
  }
  const double x_low = lower_quantile(xs, 0.002);
  const double x_high = lower_quantile(xs, 0.998);
  const double y_low = lower_quantile(ys, 0.002);
  const double y_high = lower_quantile(ys, 0.998);
  if (direction) {
    const double pad = xs.empty() ? 5 : std::max(1.0, 0.08 * std::max(x_high - x_low, y_high - y_low));
    track.x_low = (xs.empty() ? 0 : x_low) - pad;
    track.x_high = (xs.empty() ? 0 : x_high) + pad;
    track.y_top = (xs.empty() ? 0 : y_high) + pad;
    track.y_bottom = (xs.empty() ? 0 : y_low) - pad;
    track.frame_width = track.frame_height = 0;
    track.x_label = "azimuth [deg], right";
    track.y_label = "elevation [deg], up";
    return track;
  }
  track.x_low = xs.empty() ? 0 : beyond(x_low, 0, 0.3 * width, -1);
  track.x_high = xs.empty() ? width : beyond(x_high, width, 0.3 * width, 1);
  track.y_top = xs.empty() ? 0 : beyond(y_low, 0, 0.3 * height, -1);
  track.y_bottom = xs.empty() ? height : beyond(y_high, height, 0.3 * height, 1);
  track.frame_width = width;
  track.frame_height = height;
  const char* const of = log.kind == GazeKind::screen ? "display" : "picture";
  track.x_label = px ? "x [px]" : fmt::format("x [share of the {}]", of);
  track.y_label = px ? "y [px], down" : fmt::format("y [share of the {}], down", of);
  return track;
}

// For each column of pixels the first, lowest, highest and last value, joined by lines; losses and gaps interrupt them.
std::string trace_path(const Track& track, const std::vector<double>& values, const Axis& time, const Axis& value,
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
  void draw(Svg& svg, double top, double height, const char* color, double opacity) const {
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
      svg.add(R"(<path d="{}" fill="{}" fill-opacity="{}"/>)", path, color, opacity);
    }
  }

 private:
  Axis time_;
  std::vector<bool> covered_;
};

struct Losses {
  Spans lost, gaps;
};

Losses find_losses(const Track& track, const Axis& time, double gap_s) {
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

void draw_trace(Svg& svg, const Track& track, const std::vector<double>& values, const Axis& time, const Axis& value,
                const Losses& losses, double gap_s, const std::string& label, const char* color, int clip) {
  const double top = std::min(value.begin, value.end);
  const double height = std::abs(value.end - value.begin);
  losses.gaps.draw(svg, top, height, "#9a9a9a", 0.22);
  losses.lost.draw(svg, top, height, "#c8463c", 0.20);
  for (const double t : ticks(value, 4)) {
    const double y = value.at(t);
    svg.add(R"(<path d="M{:.1f} {:.1f}H{:.1f}" stroke="#e2e2e2"/>)", time.begin, y, time.end);
    svg.add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", time.begin - 7, y + 4, t);
  }
  svg.add(R"(<clipPath id="c{}"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)", clip,
          time.begin, top, time.end - time.begin, height);
  svg.add(
      R"-(<path d="{}" fill="none" stroke="{}" stroke-width="0.9" stroke-linejoin="round" clip-path="url(#c{})"/>)-",
      trace_path(track, values, time, value, gap_s), color, clip);
  svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#444"/>)", time.begin, top,
          time.end - time.begin, height);
  svg.add(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)-", 20.0,
          top + height / 2, label);
}

double draw_events(Svg& svg, const GazeLog& log, const Axis& time, double top) {
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
    svg.add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{}s</text>)", time.begin - 7, top + kStrip - 3,
            kEventNames[type]);
    spans.draw(svg, top, kStrip - 3, kEventColors[type], 0.9);
    top += kStrip;
  }
  return top;
}

void draw_density(Svg& svg, const Track& track, const Axis& x, const Axis& y) {
  constexpr double kCell = 4;
  const auto columns = static_cast<std::size_t>(std::abs(x.end - x.begin) / kCell) + 1;
  const auto rows = static_cast<std::size_t>(std::abs(y.end - y.begin) / kCell) + 1;
  std::vector<double> counts(columns * rows);
  double most = 1;
  for (std::size_t i = 0; i < track.x.size(); ++i) {
    const double column = (x.at(track.x[i]) - x.begin) / kCell;
    const double row = (y.at(track.y[i]) - y.begin) / kCell;
    if (column >= 0 && row >= 0 && column < static_cast<double>(columns) && row < static_cast<double>(rows)) {
      double& count = counts[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
      most = std::max(most, ++count);
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) {
      svg.add(R"(<rect x="{:.0f}" y="{:.0f}" width="{}" height="{}" fill="#1f4e79" fill-opacity="{:.2f}"/>)",
              x.begin + kCell * static_cast<double>(i % columns), y.begin + kCell * static_cast<double>(i / columns),
              kCell, kCell, 0.08 + 0.92 * std::log1p(counts[i]) / std::log1p(most));
    }
  }
}

void draw_scanpath(Svg& svg, const GazeLog& log, const Track& track, const Axis& x, const Axis& y, double gap_s,
                   const GazePictureOptions& options) {
  const double left = x.begin;
  const double top = y.begin;
  const double width = x.end - x.begin;
  const double height = y.end - y.begin;
  svg.add(R"(<clipPath id="scan"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)", left, top,
          width, height);
  svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="#f4f4f2"/>)", left, top, width, height);
  if (track.frame_width > 0) {
    const double fx = x.at(0);
    const double fy = y.at(0);
    const double fw = x.at(track.frame_width) - fx;
    const double fh = y.at(track.frame_height) - fy;
    svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="#ffffff" stroke="#888"/>)", fx, fy, fw,
            fh);
    if (!options.frame_image.empty()) {
      const std::string lower = to_lower(options.frame_image);
      const char* const type = lower.ends_with(".jpg") || lower.ends_with(".jpeg") ? "jpeg" : "png";
      svg.add(
          R"(<image x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" preserveAspectRatio="none" href="data:image/{};base64,{}"/>)",
          fx, fy, fw, fh, type, base64(read_file_bytes(options.frame_image)));
    }
  }
  svg.add(R"-(<g clip-path="url(#scan)">)-");
  if (track.x.size() > kMostPoints) {
    draw_density(svg, track, x, y);
  } else {
    std::string path;
    bool open = false;
    for (std::size_t i = 0; i < track.x.size(); ++i) {
      open = open && (i == 0 || track.s[i] - track.s[i - 1] <= gap_s);
      if (std::isnan(track.x[i])) {
        open = false;
        continue;
      }
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", open ? "L" : "M", x.at(track.x[i]), y.at(track.y[i]));
      open = true;
    }
    svg.add(R"(<path d="{}" fill="none" stroke="{}" stroke-width="0.8" stroke-opacity="0.7"/>)", path,
            options.frame_image.empty() ? "#1f4e79" : "#ffd400");
  }
  // The log's own fixations: their mean place, area by duration.
  std::size_t at = 0;
  std::string circles;
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::fixation || track.x.size() > kMostPoints) {
      continue;
    }
    at = at < log.samples.size() && log.samples[at].t_ns <= event.begin_ns ? at : 0;
    while (at < log.samples.size() && log.samples[at].t_ns < event.begin_ns) {
      ++at;
    }
    double count = 0;
    Vec2d sum;
    for (std::size_t i = at; i < log.samples.size() && log.samples[i].t_ns <= event.end_ns; ++i) {
      if (!std::isnan(track.x[i])) {
        ++count;
        sum = {sum.x + track.x[i], sum.y + track.y[i]};
      }
    }
    if (count > 0) {
      const double radius =
          std::clamp(0.45 * std::sqrt(static_cast<double>(event.end_ns - event.begin_ns) * 1e-6), 2.0, 18.0);
      circles += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}"/>)", x.at(sum.x / count),
                             y.at(sum.y / count), radius);
    }
  }
  svg.add(R"(<g fill="#4c8c5a" fill-opacity="0.35" stroke="#2f6a3d" stroke-width="0.8">{}</g></g>)", circles);
  for (const double t : ticks(x, 5)) {
    svg.add(R"(<path d="M{:.1f} {:.1f}v5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)",
            x.at(t), top + height, x.at(t), top + height + 18, t);
  }
  for (const double t : ticks(y, 5)) {
    svg.add(R"(<path d="M{:.1f} {:.1f}h-5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)",
            left, y.at(t), left - 8, y.at(t) + 4, t);
  }
  svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#444"/>)", left, top, width,
          height);
  svg.add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", left + width / 2, top + height + 36,
          track.x_label);
  svg.add(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)-", 20.0,
          top + height / 2, track.y_label);
}

// Breaks the text between words into lines of at most `most` characters.
std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
  std::vector<std::string> lines(1);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + word.size() + 1 > most) {
      lines.emplace_back();
    }
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    at = end + 1;
  }
  return lines;
}

double draw_figures(Svg& svg, const GazeInspection& r, double left, double top, double width) {
  const auto most = static_cast<std::size_t>(width / 6.6);
  const auto put = [&](const std::string& label, const std::string& text, const char* color = "#222") {
    bool first = true;
    for (const std::string& line : wrapped(text, most > 16 ? most - 14 : 20)) {
      if (first) {
        svg.add(R"(<text x="{:.1f}" y="{:.1f}" fill="#777">{}</text>)", left, top, label);
      }
      svg.add(R"(<text x="{:.1f}" y="{:.1f}" fill="{}">{}</text>)", left + 84, top, color, escaped(line));
      top += 17;
      first = false;
    }
  };
  const auto share = [&](double n) {
    return 100.0 * n / static_cast<double>(std::max<std::size_t>(r.loss.samples, 1));
  };
  const int digits = r.unit == "px" ? 2 : r.unit == "deg" ? 3 : 5;
  top += 12;
  put("samples",
      fmt::format("{}, {:.2f} Hz{}", r.loss.samples, r.timing.median_rate_hz,
                  r.timing.nominal_rate_hz > 0 ? fmt::format(" (stated: {:g} Hz)", r.timing.nominal_rate_hz) : ""));
  put("usable", fmt::format("{:.2f} %; losses like blinks: {}, longer: {}", share(static_cast<double>(r.loss.usable)),
                            r.loss.blink_like, r.loss.longer));
  if (r.precision) {
    put("precision", fmt::format("RMS-S2S {:.{}f} {}, SD {:.{}f} {} in {} fixations", r.precision->rms_s2s, digits,
                                 r.unit, r.precision->sd, digits, r.unit, r.precision->fixations));
  }
  for (const GazeCalibration& c : r.calibrations) {
    put("accuracy",
        fmt::format("{} eye {} deg mean, {} deg at most", to_string(c.eye), c.mean_error_deg, c.max_error_deg));
  }
  if (r.disparity) {
    put("disparity", fmt::format("{:.{}f} {} horizontally, {:.{}f} {} vertically", r.disparity->horizontal, digits,
                                 r.unit, r.disparity->vertical, digits, r.unit));
  }
  for (const GazeAxisTest& test : r.axes) {
    put(fmt::format("axis {}", test.axis), std::string(to_string(test.verdict)));
  }
  for (const GazeFinding& f : r.findings) {
    put(std::string(to_string(f.kind)), f.what, f.kind == FindingKind::note ? "#222" : "#a8281e");
  }
  put("verdict", r.verdict, r.settings.empty() ? "#222" : "#a8281e");
  top += 8;
  svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="14" height="11" fill="#c8463c" fill-opacity="0.20"/>)", left, top - 9);
  svg.add(R"(<text x="{:.1f}" y="{:.1f}">no usable gaze</text>)", left + 20, top);
  svg.add(R"(<rect x="{:.1f}" y="{:.1f}" width="14" height="11" fill="#9a9a9a" fill-opacity="0.22"/>)", left + 130,
          top - 9);
  svg.add(R"(<text x="{:.1f}" y="{:.1f}">no rows</text>)", left + 150, top);
  return top + 12;
}

}  // namespace

std::string inspection_svg(const GazeLog& log, const GazeInspection& inspection, const GazePictureOptions& options) {
  const Track track = make_track(log, inspection);
  const double width = options.width_px;
  const double step_s = inspection.timing.median_rate_hz > 0 ? 1 / inspection.timing.median_rate_hz : 0;
  const double gap_s = 3.0 * step_s;
  Axis time{0, std::max(track.s.back(), 1e-3), kLeft, width - kRight};
  const Axis x_trace{track.x_high, track.x_low, kTop, kTop + kTrace};
  const double y_begin = kTop + kTrace + kBetween;
  const Axis y_trace{track.y_top, track.y_bottom, y_begin, y_begin + kTrace};

  Svg body;
  const Losses losses = find_losses(track, time, gap_s);
  draw_trace(body, track, track.x, time, x_trace, losses, gap_s, track.x_label, "#1f4e79", 0);
  draw_trace(body, track, track.y, time, y_trace, losses, gap_s, track.y_label, "#8c3b1e", 1);
  for (const double t : ticks(time, 10)) {
    body.add(
        R"(<path d="M{:.1f} {:.1f}v5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)",
        time.at(t), y_trace.end, time.at(t), y_trace.end + 18, t);
  }
  body.add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">time from the first sample [s]</text>)",
           (time.begin + time.end) / 2, y_trace.end + 36);
  double top = draw_events(body, log, time, y_trace.end + 48) + 22;

  // The scanpath takes the left part, with the aspect ratio of what it shows.
  const double span_x = track.x_high - track.x_low;
  const double span_y = std::abs(track.y_bottom - track.y_top);
  const double shape =
      track.frame_width == 1 && track.frame_height == 1 ? 16.0 / 9 : 1;  // fractions: the aspect of a usual display
  double scan_width = 0.52 * width;
  double scan_height = scan_width * span_y / (span_x * shape);
  if (scan_height > 460) {
    scan_width *= 460 / scan_height;
    scan_height = 460;
  }
  const Axis x_scan{track.x_low, track.x_high, kLeft, kLeft + scan_width};
  const Axis y_scan{track.y_top, track.y_bottom, top, top + scan_height};
  draw_scanpath(body, log, track, x_scan, y_scan, gap_s, options);
  const double figures_left = kLeft + scan_width + 34;
  const double figures_end = draw_figures(body, inspection, figures_left, top, width - kRight - figures_left);
  const double height = std::max(top + scan_height + 52, figures_end + 16);

  const std::size_t slash = inspection.source.find_last_of('/');
  Svg svg;
  svg.add(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{:.0f}" height="{:.0f}" viewBox="0 0 {:.0f} {:.0f}" )"
          R"(font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#222" stroke-width="1">)",
          width, height, width, height);
  svg.add(R"(<rect width="100%" height="100%" fill="#ffffff"/>)");
  svg.add(R"(<text x="{:.1f}" y="28" font-size="16" font-weight="bold">{}</text>)", kLeft,
          escaped(slash == std::string::npos ? inspection.source : inspection.source.substr(slash + 1)));
  svg.add(R"(<text x="{:.1f}" y="48" fill="#777">{}, {:.0f} % sure; {}</text>)", kLeft, inspection.format,
          100 * inspection.format_confidence,
          inspection.kind == GazeKind::direction ? "directions from the head"
          : inspection.kind == GazeKind::screen  ? "gaze on a screen"
                                                 : "gaze on a scene camera's picture");
  svg.raw(body.str());
  svg.add("</svg>");
  return svg.str();
}

}  // namespace gazetrace
