// SPDX-License-Identifier: Apache-2.0
// Where gaze went: a line, or the density of many samples, and the log's own fixations.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.hpp"
#include "gaze/inspect/picture_parts.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostPoints = 30'000;  // of a scanpath drawn as a line; longer ones become densities

void draw_density(PictureSvg& svg, const GazeTrack& track, const Axis& x, const Axis& y) {
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
      svg.add(fmt::format(
          R"(<rect x="{:.0f}" y="{:.0f}" width="{}" height="{}" fill="#1f4e79" fill-opacity="{:.2f}"/>)",
          x.begin + kCell * static_cast<double>(i % columns), y.begin + kCell * static_cast<double>(i / columns), kCell,
          kCell, 0.08 + 0.92 * std::log1p(counts[i]) / std::log1p(most)));
    }
  }
}

// The display or the scene camera's picture, with what was seen where there is an image of it.
void draw_frame(PictureSvg& svg, const GazeTrack& track, const Axis& x, const Axis& y, const std::string& image) {
  const double left = x.at(0);
  const double top = y.at(0);
  const double width = x.at(track.frame_width) - left;
  const double height = y.at(track.frame_height) - top;
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="#ffffff" stroke="#888"/>)",
                      left, top, width, height));
  if (!image.empty()) {
    const std::string lower = to_lower(image);
    const char* const type = lower.ends_with(".jpg") || lower.ends_with(".jpeg") ? "jpeg" : "png";
    svg.add(fmt::format(
        R"(<image x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" preserveAspectRatio="none" href="data:image/{};base64,{}"/>)",
        left, top, width, height, type, base64(read_file_bytes(image))));
  }
}

// The samples joined by lines; losses and gaps interrupt them.
std::string path_of(const GazeTrack& track, const Axis& x, const Axis& y, double gap_s) {
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
  return path;
}

// The log's own fixations: their mean place, area by duration.
std::string fixation_circles(const GazeLog& log, const GazeTrack& track, const Axis& x, const Axis& y) {
  std::size_t at = 0;
  std::string circles;
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::fixation) {
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
  return circles;
}

void draw_axes(PictureSvg& svg, const GazeTrack& track, const Axis& x, const Axis& y) {
  const double left = x.begin;
  const double top = y.begin;
  const double width = x.end - x.begin;
  const double height = y.end - y.begin;
  for (const double t : ticks(x, 5)) {
    svg.add(fmt::format(
        R"(<path d="M{:.1f} {:.1f}v5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)",
        x.at(t), top + height, x.at(t), top + height + 18, t));
  }
  for (const double t : ticks(y, 5)) {
    svg.add(fmt::format(
        R"(<path d="M{:.1f} {:.1f}h-5" stroke="#444"/><text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", left,
        y.at(t), left - 8, y.at(t) + 4, t));
  }
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#444"/>)", left,
                      top, width, height));
  svg.add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", left + width / 2,
                      top + height + 36, track.x_label));
  svg.add(fmt::format(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)-",
                      20.0, top + height / 2, track.y_label));
}

}  // namespace

void draw_scanpath(PictureSvg& svg, const GazeLog& log, const GazeTrack& track, const Axis& x, const Axis& y,
                   double gap_s, const GazePictureOptions& options) {
  const double width = x.end - x.begin;
  const double height = y.end - y.begin;
  svg.add(fmt::format(R"(<clipPath id="scan"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)",
                      x.begin, y.begin, width, height));
  svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="#f4f4f2"/>)", x.begin,
                      y.begin, width, height));
  if (track.frame_width > 0) {
    draw_frame(svg, track, x, y, options.frame_image);
  }
  svg.add(R"-(<g clip-path="url(#scan)">)-");
  const bool is_line = track.x.size() <= kMostPoints;
  if (is_line) {
    svg.add(fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="0.8" stroke-opacity="0.7"/>)",
                        path_of(track, x, y, gap_s), options.frame_image.empty() ? "#1f4e79" : "#ffd400"));
  } else {
    draw_density(svg, track, x, y);
  }
  svg.add(fmt::format(R"(<g fill="#4c8c5a" fill-opacity="0.35" stroke="#2f6a3d" stroke-width="0.8">{}</g></g>)",
                      is_line ? fixation_circles(log, track, x, y) : ""));
  draw_axes(svg, track, x, y);
}

}  // namespace gazetrace
