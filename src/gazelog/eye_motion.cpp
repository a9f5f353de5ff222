// SPDX-License-Identifier: Apache-2.0
#include "gazelog/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastMs = 21, kMsPerDegree = 2.2;
constexpr std::size_t kFewestSaccades = 5;
constexpr double kLongestStepMs = 12;  // a saccade takes a few steps
constexpr std::size_t kMostRowsOfMotion = 60'000;

struct Point {
  double ms, x, y;
};

// One eye's usable rows, of the beginning of the log.
std::vector<Point> points_of(const RawGaze& raw) {
  std::vector<Point> points;
  std::optional<Eye> eye;
  const double ms_per_ns = 1e-6;
  for (std::size_t i = 0; i < raw.rows.size() && points.size() < kMostRowsOfMotion; ++i) {
    const RawSample row = raw.rows[i];
    if (!is_usable(row.validity) || !std::isfinite(row.at.x) || !std::isfinite(row.at.y) ||
        is_missing_marker(row.at.x) || is_missing_marker(row.at.y) || (row.at.x == 0 && row.at.y == 0) ||
        row.eye != eye.value_or(row.eye)) {
      continue;
    }
    eye = row.eye;
    points.push_back({static_cast<double>(row.t_ns - raw.rows.t_ns(0)) * ms_per_ns, row.at.x, row.at.y});
  }
  return points;
}

// Runs of fast steps between slow ones.
std::optional<Saccades> find_saccades(const std::vector<Point>& points) {
  std::vector<double> steps;
  std::vector<double> lengths;
  for (std::size_t i = 1; i < points.size(); ++i) {
    steps.push_back(points[i].ms - points[i - 1].ms);
    lengths.push_back(std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y));
  }
  if (steps.size() < 50) {
    return std::nullopt;
  }
  const auto quantile = [](std::vector<double> values, double share) {  // of a copy: a quantile changes the order
    return lower_quantile(values, share);
  };
  const double step_ms = quantile(steps, 0.5);
  const double rest = quantile(lengths, 0.5);
  const double fast = quantile(lengths, 0.98);
  if (!(step_ms > 0) || step_ms > kLongestStepMs || !(fast > 5 * rest)) {
    return std::nullopt;
  }
  const double threshold = std::max(4 * rest, 0.1 * fast);
  std::vector<std::pair<double, double>> saccades;  // amplitude and duration
  for (std::size_t i = 0; i < lengths.size();) {
    std::size_t end = i;
    while (end < lengths.size() && lengths[end] > threshold && steps[end] < 3 * step_ms) {
      ++end;
    }
    const double duration = static_cast<double>(end - i) * step_ms;
    if (end > i + 1 && duration >= 8 && duration <= 150) {
      saccades.emplace_back(std::hypot(points[end].x - points[i].x, points[end].y - points[i].y), duration);
    }
    i = end + 1;
  }
  if (saccades.size() < kFewestSaccades) {
    return std::nullopt;
  }
  // Of small ones noise hides the beginning and the end, so the largest tell.
  std::sort(saccades.rbegin(), saccades.rend());
  saccades.resize(std::max(kFewestSaccades, saccades.size() / 4));
  std::vector<double> amplitudes;
  std::vector<double> durations;
  for (const auto& [amplitude, duration] : saccades) {
    amplitudes.push_back(amplitude);
    durations.push_back(duration);
  }
  return Saccades{saccades.size(), lower_quantile(amplitudes, 0.5), lower_quantile(durations, 0.5)};
}

}  // namespace

std::optional<Extent> extent_of(const RawRows& rows, double Vec3d::*coordinate) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const RawSample row : rows) {
    if (is_usable(row.validity) && std::isfinite(row.at.*coordinate)) {
      values.push_back(row.at.*coordinate);
    }
  }
  if (values.empty()) {
    return std::nullopt;
  }
  constexpr std::size_t kEnough = 10;
  return Extent{lower_quantile(values, 0.05), lower_quantile(values, 0.5), lower_quantile(values, 0.95),
                values.size() < kEnough};
}

std::optional<EyeMotion> measure_motion(const RawRows& rows, const RawGaze& raw) {
  const std::optional<Extent> x = extent_of(rows, &Vec3d::x);
  const std::optional<Extent> y = extent_of(rows, &Vec3d::y);
  if (!x || !y) {
    return std::nullopt;
  }
  EyeMotion motion;
  motion.x = *x;
  motion.y = *y;
  std::size_t negative = 0;
  for (const RawSample row : rows) {
    if (is_usable(row.validity) && std::isfinite(row.at.x)) {
      ++motion.rows;
      negative += row.at.x < 0 || row.at.y < 0 ? 1 : 0;
    }
  }
  motion.share_negative = static_cast<double>(negative) / static_cast<double>(motion.rows);
  motion.saccades = find_saccades(points_of(raw));
  return motion;
}

double EyeMotion::most() const {
  return std::max({-x.low, x.high, -y.low, y.high});
}

std::optional<double> EyeMotion::degrees_per_unit() const {
  if (!saccades || !(saccades->amplitude > 0)) {
    return std::nullopt;
  }
  return std::max(0.3, (saccades->duration_ms - kLeastMs) / kMsPerDegree) / saccades->amplitude;
}

std::string EyeMotion::if_degrees(double degrees) const {
  std::string text =
      fmt::format("the eye would move over {:.3g} x {:.3g} degrees", degrees * x.spread(), degrees * y.spread());
  if (saccades) {
    const double size = degrees * saccades->amplitude;
    text += fmt::format(", and its saccades of {:.2g} degrees would last {:.0f} ms, where an eye's last {:.0f}", size,
                        saccades->duration_ms, kLeastMs + kMsPerDegree * size);
  }
  return text;
}

std::string EyeMotion::in_words() const {
  return fmt::format("90 % of x lie in {:.4g} .. {:.4g}, of y in {:.4g} .. {:.4g}", x.low, x.high, y.low, y.high);
}

}  // namespace gazetrace
