// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gaze/inspect/picture_parts.hpp"

namespace gazetrace {
namespace {

double beyond(double quantile_value, double edge, double most, int sign) {
  return sign < 0 ? std::max(std::min(quantile_value, edge), edge - most)
                  : std::min(std::max(quantile_value, edge), edge + most);
}

}  // namespace

GazeTrack make_track(const GazeLog& log, const GazeInspection& inspection) {
  GazeTrack track;
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

}  // namespace gazetrace
