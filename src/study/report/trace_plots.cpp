// SPDX-License-Identifier: Apache-2.0
// Values over time. A column of half a pixel shows the lowest and highest value in it, so that no excursion is lost.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/statistics.hpp"
#include "study/report/drawing.hpp"

namespace gazetrace {
namespace {

constexpr double kHeight = 250;

std::string path_of(const std::vector<double>& seconds, const std::vector<double>& values, const Axis& x, const Axis& y,
                    double gap_s) {
  std::string path;
  bool open = false;
  double column = -1;
  double low = 0;
  double high = 0;
  double last_s = 0;
  const auto flush = [&] {
    if (column >= 0) {
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", open ? "L" : "M", column, y.at(low));
      if (high - low > 0) {
        fmt::format_to(std::back_inserter(path), "V{:.1f}", y.at(high));
      } else if (!open) {
        path += "h0.5";  // a single value would be invisible
      }
      open = true;
    }
    column = -1;
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i]) || seconds[i] - last_s > gap_s) {
      flush();
      open = false;
    }
    if (std::isnan(values[i])) {
      continue;
    }
    last_s = seconds[i];
    const double value = std::clamp(values[i], std::min(y.low, y.high), std::max(y.low, y.high));
    const double at = std::floor(2 * x.at(seconds[i])) / 2;
    if (at != column) {
      flush();
      column = at;
      low = high = value;
    }
    low = std::min(low, value);
    high = std::max(high, value);
  }
  flush();
  return path;
}

}  // namespace

std::optional<GazePlot> trace_plot(const std::string& name, const std::string& title, const std::string& label,
                                   const std::vector<double>& seconds, const std::vector<GazeTrace>& traces) {
  std::vector<double> known;
  for (const GazeTrace& trace : traces) {
    const std::size_t stride = trace.values.size() / 200'000 + 1;
    for (std::size_t i = 0; i < trace.values.size(); i += stride) {
      if (std::isfinite(trace.values[i])) {
        known.push_back(trace.values[i]);
      }
    }
  }
  if (known.empty() || seconds.size() < 2) {
    return std::nullopt;
  }
  // The outermost values in a thousand are noise at the edges of losses more often than gaze.
  const double low = lower_quantile(known, 0.001);
  const double high = lower_quantile(known, 0.999);
  const double room = std::max(0.06 * (high - low), 1e-3 * std::max(std::abs(high), 1e-6));
  const Axis x{seconds.front(), std::max(seconds.back(), seconds.front() + 1e-3), 66, kWideWidth - 16};
  const Axis y{low - room, high + room, kHeight - 48, 30};
  std::vector<double> steps;
  for (std::size_t i = 1; i < seconds.size(); ++i) {
    steps.push_back(seconds[i] - seconds[i - 1]);
  }
  const double gap_s = 3 * upper_median(steps);
  Drawing svg(kWideWidth, kHeight, title);
  svg.x_axis(x, y, 10, "time [s]");
  svg.y_axis(x, y, 5, label);
  double legend = x.begin;
  for (const GazeTrace& trace : traces) {
    svg.add(fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="1" stroke-linejoin="round"/>)",
                        path_of(seconds, trace.values, x, y, gap_s), trace.color));
    if (traces.size() > 1) {
      svg.add(fmt::format(R"(<path d="M{:.1f} 16h22" stroke="{}" stroke-width="3"/>)", legend, trace.color));
      svg.text(legend + 28, 20.5, trace.name);
      legend += 120;
    }
  }
  svg.frame(x, y);
  return GazePlot{name, title, svg.str(), true, {}};
}

}  // namespace gazetrace
