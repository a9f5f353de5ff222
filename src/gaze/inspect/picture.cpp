// SPDX-License-Identifier: Apache-2.0
// An inspection as a picture: x and y over time, below them what the log says about each moment, and the scanpath.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gaze/inspect/picture_parts.hpp"

namespace gazetrace {
namespace {

constexpr double kLeft = 78, kRight = 24, kTop = 64, kTrace = 170, kBetween = 22;

// The scanpath takes the left part of the picture, with the aspect ratio of what it shows.
Vec2d scanpath_size(const GazeTrack& track, double picture_width) {
  constexpr double kMostHeight = 460;
  const double span_x = track.x_high - track.x_low;
  const double span_y = std::abs(track.y_bottom - track.y_top);
  const double shape =
      track.frame_width == 1 && track.frame_height == 1 ? 16.0 / 9 : 1;  // fractions: the aspect of a usual display
  const double width = 0.52 * picture_width;
  const double height = width * span_y / (span_x * shape);
  return height > kMostHeight ? Vec2d{width * (kMostHeight / height), kMostHeight} : Vec2d{width, height};
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

double draw_figures(PictureSvg& svg, const GazeInspection& r, double left, double top, double width) {
  const auto most = static_cast<std::size_t>(width / 6.6);
  const auto put = [&](const std::string& label, const std::string& text, const char* color = "#222") {
    bool first = true;
    for (const std::string& line : wrapped(text, most > 16 ? most - 14 : 20)) {
      if (first) {
        svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" fill="#777">{}</text>)", left, top, label));
      }
      svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" fill="{}">{}</text>)", left + 84, top, color, escaped(line)));
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
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="14" height="11" fill="#c8463c" fill-opacity="0.20"/>)",
                      left, top - 9));
  svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}">no usable gaze</text>)", left + 20, top));
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="14" height="11" fill="#9a9a9a" fill-opacity="0.22"/>)",
                      left + 130, top - 9));
  svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}">no rows</text>)", left + 150, top));
  return top + 12;
}

}  // namespace

std::string inspection_svg(const GazeLog& log, const GazeInspection& inspection, const GazePictureOptions& options) {
  const GazeTrack track = make_track(log, inspection);
  const double width = options.width_px;
  const double step_s = inspection.timing.median_rate_hz > 0 ? 1 / inspection.timing.median_rate_hz : 0;
  const double gap_s = 3.0 * step_s;
  Axis time{0, std::max(track.s.back(), 1e-3), kLeft, width - kRight};
  const Axis x_trace{track.x_high, track.x_low, kTop, kTop + kTrace};
  const double y_begin = kTop + kTrace + kBetween;
  const Axis y_trace{track.y_top, track.y_bottom, y_begin, y_begin + kTrace};

  PictureSvg body;
  draw_traces(body, track, time, x_trace, y_trace, gap_s);
  const double top = draw_events(body, log, time, y_trace.end + 48) + 22;

  const Vec2d scan = scanpath_size(track, width);
  const Axis x_scan{track.x_low, track.x_high, kLeft, kLeft + scan.x};
  const Axis y_scan{track.y_top, track.y_bottom, top, top + scan.y};
  draw_scanpath(body, log, track, x_scan, y_scan, gap_s, options);
  const double figures_left = kLeft + scan.x + 34;
  const double figures_end = draw_figures(body, inspection, figures_left, top, width - kRight - figures_left);
  const double height = std::max(top + scan.y + 52, figures_end + 16);

  const std::size_t slash = inspection.source.find_last_of('/');
  PictureSvg svg;
  svg.add(fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{:.0f}" height="{:.0f}" viewBox="0 0 {:.0f} {:.0f}" )"
      R"(font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#222" stroke-width="1">)",
      width, height, width, height));
  svg.add(R"(<rect width="100%" height="100%" fill="#ffffff"/>)");
  svg.add(fmt::format(R"(<text x="{:.1f}" y="28" font-size="16" font-weight="bold">{}</text>)", kLeft,
                      escaped(slash == std::string::npos ? inspection.source : inspection.source.substr(slash + 1))));
  svg.add(fmt::format(R"(<text x="{:.1f}" y="48" fill="#777">{}, {:.0f} % sure; {}</text>)", kLeft, inspection.format,
                      100 * inspection.format_confidence,
                      inspection.kind == GazeKind::direction ? "directions from the head"
                      : inspection.kind == GazeKind::screen  ? "gaze on a screen"
                                                             : "gaze on a scene camera's picture"));
  svg.raw(body.str());
  svg.add("</svg>");
  return svg.str();
}

}  // namespace gazetrace
