// SPDX-License-Identifier: Apache-2.0
// Curves of quality over time: their Pareto fronts, and the ratio of the times at which two of them reach a level.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/sweep.hpp"

namespace gazetrace {
namespace {

bool is_usable(const QualityAtTime& point) {
  return std::isfinite(point.time_s) && point.time_s > 0 && std::isfinite(point.quality);
}

// When a curve reaches a level. Without a time, it reaches it before its first point or not at all.
struct Crossing {
  std::optional<double> time_s;
  double least_s = 0, most_s = 0;  // the first and the last time of the curve
  bool is_later = false;           // it never gets there
};

Crossing crossing_of(const std::vector<QualityAtTime>& points, MetricDirection better, double level) {
  const double sign = better == MetricDirection::higher ? 1.0 : -1.0;
  std::vector<QualityAtTime> front;
  for (const std::size_t i : pareto_front(points, better)) {
    front.push_back(points[i]);
  }
  Crossing crossing;
  crossing.least_s = front.front().time_s;
  crossing.most_s = front.back().time_s;
  if (sign * front.back().quality < sign * level) {
    crossing.is_later = true;
    return crossing;
  }
  if (sign * front.front().quality > sign * level) {
    return crossing;
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (front[i].quality == level) {
      crossing.time_s = front[i].time_s;
      return crossing;
    }
    if (sign * front[i].quality > sign * level) {
      const QualityAtTime& a = front[i - 1];
      const QualityAtTime& b = front[i];
      const double part = (level - a.quality) / (b.quality - a.quality);
      crossing.time_s = std::exp(std::log(a.time_s) + part * (std::log(b.time_s) - std::log(a.time_s)));
      return crossing;
    }
  }
  return crossing;
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<QualityAtTime>& points, MetricDirection better) {
  const double sign = better == MetricDirection::higher ? 1.0 : -1.0;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_usable(points[i])) {
      order.push_back(i);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].time_s != points[b].time_s ? points[a].time_s < points[b].time_s
                                                : sign * points[a].quality > sign * points[b].quality;
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    if (front.empty() || sign * points[i].quality > sign * points[front.back()].quality) {
      front.push_back(i);
    }
  }
  return front;
}

FixedQuality speed_up_at_quality(const std::vector<QualityAtTime>& uniform, const std::vector<QualityAtTime>& foveated,
                                 MetricDirection better, double level) {
  FixedQuality result;
  const auto has_points = [](const auto& curve) {
    return std::any_of(curve.begin(), curve.end(), [](const auto& point) { return is_usable(point); });
  };
  if (!has_points(uniform) || !has_points(foveated)) {
    result.why = "a curve has no points";
    return result;
  }
  const Crossing u = crossing_of(uniform, better, level);
  const Crossing f = crossing_of(foveated, better, level);
  if (u.time_s && f.time_s) {
    result.speed_up = *u.time_s / *f.time_s;
    return result;
  }
  const auto told = [](const Crossing& crossing, const char* name) {
    return crossing.time_s     ? std::string()
           : crossing.is_later ? fmt::format("{} does not reach it in {:.4g} s", name, crossing.most_s)
                               : fmt::format("{} is better already in {:.4g} s", name, crossing.least_s);
  };
  const std::string of_uniform = told(u, "uniform");
  const std::string of_foveated = told(f, "foveated");
  result.why = of_uniform + (of_uniform.empty() || of_foveated.empty() ? "" : ", ") + of_foveated;
  // Where the uniform time can only be longer and the foveated time only shorter, the ratio is a lower bound; the other
  // way round it is an upper bound.
  const bool more = (u.time_s || u.is_later) && (f.time_s || !f.is_later);
  const bool less = (u.time_s || !u.is_later) && (f.time_s || f.is_later);
  if (more || less) {
    const double uniform_s = u.time_s.value_or(u.is_later ? u.most_s : u.least_s);
    const double foveated_s = f.time_s.value_or(f.is_later ? f.most_s : f.least_s);
    result.speed_up = uniform_s / foveated_s;
    result.bound = more ? ">" : "<";
  }
  return result;
}

}  // namespace gazetrace
