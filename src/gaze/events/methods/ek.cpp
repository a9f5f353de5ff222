// SPDX-License-Identifier: Apache-2.0
// Saccades and microsaccades against a threshold from the data's own noise. Engbert & Kliegl, "Microsaccades uncover
// the orientation of covert attention", Vision Research 43, 2003.
//
//   velocity     of azimuth and elevation, from five samples: (x[+2] + x[+1] - x[-1] - x[-2]) / 6 dt (their eq. 1);
//                near the ends of a stretch from three
//   spread       of each component, by medians: sigma^2 = <v^2> - <v>^2 (their eq. 2)
//   saccade      samples in a row outside the ellipse with the radii lambda sigma_x and lambda sigma_y (their eq. 3)
//   microsaccade a saccade whose extent, hypot(max x - min x, max y - min y), is below 1 degree
//
// Their further condition, that both eyes do it at once, is binocular_events().
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

// 200 Hz on a clock that jitters: below, three samples last longer than most microsaccades.
constexpr std::int64_t kLongestStepNs = 5'100'000;
constexpr std::size_t kLeastSamples = 3;

// Degrees per second to the right and up; NaN where not known.
std::vector<Vec2d> velocities(const GazeDirections& gaze, const std::vector<LabelRun>& runs) {
  std::vector<Vec2d> velocity(gaze.t_ns.size(), Vec2d{kNan, kNan});
  for (const LabelRun& run : runs) {
    if (run.movement != EyeMovement::unclassified) {
      continue;
    }
    for (std::size_t i = run.first + 1; i < run.last; ++i) {
      const bool is_inside = i >= run.first + 2 && i + 2 <= run.last;
      const TangentFrame frame(gaze.direction[i]);
      const Vec2d near_before = frame.angles(gaze.direction[i - 1]);
      const Vec2d near_after = frame.angles(gaze.direction[i + 1]);
      Vec2d change{near_after.x - near_before.x, near_after.y - near_before.y};
      // The steps over which the differences are taken, added up: 2 + 4 for five samples, 2 for three.
      auto span_ns = static_cast<double>(gaze.t_ns[i + 1] - gaze.t_ns[i - 1]);
      if (is_inside) {
        const Vec2d before = frame.angles(gaze.direction[i - 2]);
        const Vec2d after = frame.angles(gaze.direction[i + 2]);
        change = {change.x + after.x - before.x, change.y + after.y - before.y};
        span_ns += static_cast<double>(gaze.t_ns[i + 2] - gaze.t_ns[i - 2]);
      }
      if (span_ns > 0) {
        velocity[i] = {change.x * kDegPerRad / (span_ns * 1e-9), change.y * kDegPerRad / (span_ns * 1e-9)};
      }
    }
  }
  return velocity;
}

double spread_by_medians(const std::vector<Vec2d>& velocity, double Vec2d::*component) {
  std::vector<double> plain;
  std::vector<double> squared;
  for (const Vec2d& v : velocity) {
    if (!std::isnan(v.*component)) {
      plain.push_back(v.*component);
      squared.push_back(v.*component * (v.*component));
    }
  }
  const double middle = upper_median(plain);
  return std::sqrt(std::max(upper_median(squared) - middle * middle, 0.0));
}

double extent_deg(const GazeDirections& gaze, std::size_t first, std::size_t last) {
  const TangentFrame frame(gaze.direction[first]);
  Vec2d low{};
  Vec2d high{};
  for (std::size_t i = first; i <= last; ++i) {
    const Vec2d at = frame.angles(gaze.direction[i]);
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  return std::hypot(high.x - low.x, high.y - low.y) * kDegPerRad;
}

}  // namespace

void classify_ek(const GazeDirections& gaze, EyeEvents& events) {
  const EventSettings& settings = events.settings;
  const std::int64_t step_ns = median_step_ns(gaze.t_ns);
  if (step_ns <= 0) {
    return;
  }
  if (step_ns > kLongestStepNs) {
    throw Error(ErrorKind::input, "",
                fmt::format("{:.4g} Hz are too few for microsaccades, which last 6 to 30 ms",
                            1e9 / static_cast<double>(step_ns)),
                "use a recording of 200 Hz or more, or another method");
  }
  const std::vector<LabelRun> runs = label_runs(events.labels, gaze.t_ns);
  const std::vector<Vec2d> velocity = velocities(gaze, runs);
  const double radius_x = settings.noise_factor * spread_by_medians(velocity, &Vec2d::x);
  const double radius_y = settings.noise_factor * spread_by_medians(velocity, &Vec2d::y);
  if (!(radius_x > 0) || !(radius_y > 0)) {
    throw Error(ErrorKind::input, "", "half of the gaze does not move at all, so that its noise gives no threshold",
                "the log holds samples or was smoothed: use another method");
  }
  events.peak_threshold_deg_s = std::max(radius_x, radius_y);
  events.onset_threshold_deg_s = std::min(radius_x, radius_y);
  const auto is_fast = [&](std::size_t i) {
    return std::hypot(velocity[i].x / radius_x, velocity[i].y / radius_y) > 1;  // false for NaN
  };
  for (const LabelRun& run : runs) {
    if (run.movement != EyeMovement::unclassified) {
      continue;
    }
    for (std::size_t i = run.first; i <= run.last; ++i) {
      std::size_t end = i;
      while (end <= run.last && is_fast(end)) {
        ++end;
      }
      const bool lasts =
          end - i >= kLeastSamples && gaze.t_ns[end - 1] - gaze.t_ns[i] + step_ns >= settings.min_saccade_ns;
      EyeMovement movement = EyeMovement::fixation;
      if (lasts) {
        movement = extent_deg(gaze, i, end - 1) < settings.max_microsaccade_deg ? EyeMovement::microsaccade
                                                                                : EyeMovement::saccade;
      }
      end = std::max(end, i + 1);
      label_samples(events.labels, i, end, movement);
      i = end - 1;
    }
  }
  drop_short(EyeMovement::fixation, gaze, events);
}

}  // namespace gazetrace
