// SPDX-License-Identifier: Apache-2.0
// Velocity thresholds that are derived from the noise of the data. Nystrom & Holmqvist, "An adaptive algorithm for
// fixation, saccade, and glissade detection in eyetracking data", 2010.
//
//   velocity, acceleration   Savitzky-Golay of order 2 over twice the shortest saccade (20 ms), and at least 3 samples
//   noise                    faster than 1000 deg/s or 100 000 deg/s^2: left out, with its flanks down to twice the
//                            median speed
//   peak threshold           PT = mean + 6 SD of the speeds below PT, from 100 deg/s until it changes by less than 1
//   onset                    back from the peak to a local minimum below mean + 3 SD of the speeds below PT
//   offset                   on from the peak to a local minimum below 0.7 onset + 0.3 (mean + 3 SD of the 40 ms before
//                            the onset)
//
// Left out: glissades. Here, what follows a saccade is a fixation, or another saccade where it exceeds PT. On the unit
// sphere, speed is the length of the direction's derivative.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

struct Motion {
  std::vector<double> speed;         // deg/s, NaN where not known
  std::vector<double> acceleration;  // deg/s^2
};

// Order 2 over 2 m + 1 samples: sum(k x_k) / sum(k^2) and 2 (sum(k^2 x_k) - mean(k^2) sum(x_k)) / (sum(k^4) - ...), per
// step and step squared. Near the ends of a run the window shrinks.
Motion motion_of(const GazeDirections& gaze, const std::vector<LabelRun>& runs, std::size_t half) {
  Motion motion{std::vector<double>(gaze.t_ns.size(), kNan), std::vector<double>(gaze.t_ns.size(), kNan)};
  for (const LabelRun& run : runs) {
    if (run.movement != EyeMovement::unclassified) {
      continue;
    }
    for (std::size_t i = run.first + 1; i < run.last; ++i) {
      const std::size_t m = std::min({half, i - run.first, run.last - i});
      Vec3d first;
      Vec3d sum = gaze.direction[i];
      Vec3d second;
      double k2 = 0;
      double k4 = 0;
      for (std::size_t k = 1; k <= m; ++k) {
        const auto distance = static_cast<double>(k);
        const Vec3d& a = gaze.direction[i - k];
        const Vec3d& b = gaze.direction[i + k];
        first += distance * (b - a);
        sum += a + b;
        second += distance * distance * (a + b);
        k2 += 2 * distance * distance;
        k4 += 2 * distance * distance * distance * distance;
      }
      const auto count = static_cast<double>(2 * m + 1);
      const double step_s = static_cast<double>(gaze.t_ns[i + m] - gaze.t_ns[i - m]) * 1e-9 / (count - 1);
      if (step_s > 0) {
        motion.speed[i] = length(first) / (k2 * step_s) * kDegPerRad;
        const Vec3d curve = (second - (k2 / count) * sum) * (2 / (k4 - k2 * k2 / count));
        // The part of the acceleration along the direction comes from moving on a sphere, and not from moving faster.
        const Vec3d along = gaze.direction[i] * dot(curve, gaze.direction[i]);
        motion.acceleration[i] = length(curve - along) / (step_s * step_s) * kDegPerRad;
      }
    }
    if (run.last > run.first) {
      motion.speed[run.first] = motion.speed[std::min(run.first + 1, run.last)];
      motion.speed[run.last] = motion.speed[std::max(run.last, run.first + 1) - 1];
    }
  }
  return motion;
}

double median_of_known(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }), values.end());
  return upper_median(values);
}

// Removes the speeds that no eye can reach, together with the flanks of these peaks.
void remove_noise(Motion& motion, const EventSettings& settings) {
  const double quiet = 2 * median_of_known(motion.speed);
  std::vector<double>& speed = motion.speed;
  std::vector<char> bad(speed.size(), 0);
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (!(speed[i] > settings.max_velocity_deg_s) && !(motion.acceleration[i] > settings.max_acceleration_deg_s2)) {
      continue;
    }
    for (std::size_t k = i + 1; k-- > 0 && bad[k] == 0 && (k == i || speed[k] > quiet);) {
      bad[k] = 1;
    }
    for (std::size_t k = i + 1; k < speed.size() && bad[k] == 0 && speed[k] > quiet; ++k) {
      bad[k] = 1;
    }
  }
  for (std::size_t i = 0; i < speed.size(); ++i) {
    speed[i] = bad[i] != 0 ? kNan : speed[i];
  }
}

struct MeanAndSpread {
  double mean = 0, sd = 0;
};

MeanAndSpread statistics(const std::vector<double>& values, std::size_t begin, std::size_t end, double below) {
  RunningSpread spread;
  for (std::size_t i = begin; i < end; ++i) {
    if (values[i] < below) {
      spread.add(values[i]);
    }
  }
  return {spread.mean(), spread.deviation()};
}

struct Thresholds {
  double peak, onset;
};

Thresholds thresholds_of(const std::vector<double>& speed, double start) {
  constexpr int kMostRounds = 100;
  double peak = start;
  MeanAndSpread noise;
  for (int round = 0; round < kMostRounds; ++round) {
    noise = statistics(speed, 0, speed.size(), peak);
    const double next = noise.mean + 6 * noise.sd;
    const bool settled = std::abs(next - peak) < 1;
    peak = next;
    if (settled) {
      break;
    }
  }
  return {peak, noise.mean + 3 * noise.sd};
}

void find_saccades(const GazeDirections& gaze, const std::vector<double>& speed, const LabelRun& run,
                   const Thresholds& thresholds, EyeEvents& events) {
  constexpr std::int64_t kNoiseWindowNs = 40'000'000;
  const EventSettings& settings = events.settings;
  for (std::size_t i = run.first; i <= run.last; ++i) {
    if (!(speed[i] > thresholds.peak)) {
      continue;
    }
    std::size_t begin = i;
    while (begin > run.first && events.labels[begin - 1] == EyeMovement::unclassified && speed[begin - 1] >= 0 &&
           (speed[begin] >= thresholds.onset || speed[begin - 1] < speed[begin])) {
      --begin;
    }
    std::size_t window = begin;
    while (window > run.first && gaze.t_ns[begin] - gaze.t_ns[window] < kNoiseWindowNs) {
      --window;
    }
    const MeanAndSpread local = statistics(speed, window, begin, thresholds.peak);
    const double local_threshold = local.mean + 3 * local.sd;
    // A window that still lies within another movement says nothing about the noise.
    const double offset = local_threshold > 0 && local_threshold < thresholds.peak
                              ? 0.7 * thresholds.onset + 0.3 * local_threshold
                              : thresholds.onset;
    std::size_t end = i;
    while (end < run.last && speed[end + 1] >= 0 && (speed[end] >= offset || speed[end + 1] < speed[end])) {
      ++end;
    }
    if (gaze.t_ns[end] - gaze.t_ns[begin] >= settings.min_saccade_ns) {
      label_samples(events.labels, begin, end + 1, EyeMovement::saccade);
    }
    i = end;
  }
}

}  // namespace

void classify_adaptive(const GazeDirections& gaze, EyeEvents& events) {
  const std::int64_t step_ns = median_step_ns(gaze.t_ns);
  if (step_ns <= 0) {
    return;
  }
  const std::vector<LabelRun> runs = label_runs(events.labels, gaze.t_ns);
  const auto half = static_cast<std::size_t>(
      std::max<std::int64_t>(1, (events.settings.velocity_window_ns / 2 + step_ns / 2) / step_ns));
  Motion motion = motion_of(gaze, runs, half);
  remove_noise(motion, events.settings);
  const Thresholds thresholds = thresholds_of(motion.speed, events.settings.start_velocity_deg_s);
  events.peak_threshold_deg_s = thresholds.peak;
  events.onset_threshold_deg_s = thresholds.onset;
  for (const LabelRun& run : runs) {
    if (run.movement == EyeMovement::unclassified) {
      find_saccades(gaze, motion.speed, run, thresholds, events);
    }
  }
  for (std::size_t i = 0; i < motion.speed.size(); ++i) {
    if (events.labels[i] == EyeMovement::unclassified && !std::isnan(motion.speed[i])) {
      events.labels[i] = EyeMovement::fixation;
    }
  }
  drop_short(EyeMovement::fixation, gaze, events);
}

}  // namespace gazetrace
