// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/nan.hpp"
#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_synth.hpp"

namespace gazetrace {
namespace {

// The purposes for which random numbers are drawn.
enum Stream : std::uint64_t { kDurations, kTargets, kBlinks, kPursuits, kDrift, kNoise, kLoss };

// A movement of the eye from one direction to another, or a rest.
struct Phase {
  EyeMovement movement;
  std::int64_t begin_ns, end_ns;  // the end is excluded
  Vec3d from, to;
};

void check(const SynthSettings& s) {
  const auto bad = [](std::string_view what) {
    throw Error(ErrorKind::usage, "", fmt::format("{} of a synthetic log is out of range", what));
  };
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (s.duration_ns <= 0 || !within(s.rate_hz, 1, 1e5) || static_cast<double>(s.duration_ns) * 1e-9 * s.rate_hz > 1e9) {
    bad("the duration or rate");
  }
  if (!within(s.fixation_s, 0.03, 100) || !within(s.amplitude_deg, 1, 30) || !within(s.pursuit_deg_s, 0, 100)) {
    bad("a fixation's duration, an amplitude or a speed");
  }
  if (!within(s.noise_deg, 0, 10) || !within(s.drift_deg, 0, 10) || !within(s.lost_share, 0, 1) ||
      !within(s.pursuit_share, 0, 1) || !within(s.blinks_per_min, 0, 100)) {
    bad("noise, drift, a share or the rate of blinks");
  }
  if (s.kind == GazeKind::scene_camera) {
    bad("the kind");
  }
  if (s.kind == GazeKind::screen) {
    check_display(s.display);
  }
}

class Scanpath {
 public:
  Scanpath(const SynthSettings& settings, const ScreenAngles& screen)
      : settings_(settings),
        screen_(screen),
        durations_(settings.seed, kDurations),
        targets_(settings.seed, kTargets),
        blinks_(settings.seed, kBlinks),
        pursuits_(settings.seed, kPursuits) {}

  std::vector<Phase> phases() {
    Vec3d at{0, 0, -1};
    for (std::uint64_t i = 0; now_ns_ < settings_.duration_ns; ++i) {
      const double least = settings_.fixation_s / 3;
      const double stay_s = least - (settings_.fixation_s - least) * std::log(durations_.uniform(i, 0));
      if (pursuits_.uniform(i, 0) < settings_.pursuit_share) {
        const Vec3d to = target(i, 1, at, settings_.pursuit_deg_s * stay_s);
        add(EyeMovement::pursuit, stay_s, at, to);
        at = to;
      } else {
        fixate(i, stay_s, at);
      }
      const double least_deg = 1;
      const double amplitude = least_deg - (settings_.amplitude_deg - least_deg) * std::log(targets_.uniform(i, 0));
      const Vec3d to = target(i, 2, at, std::min(amplitude, 30.0));
      add(EyeMovement::saccade, main_sequence_duration_s(angle_between_rad(at, to) * kDegPerRad), at, to);
      at = to;
    }
    return std::move(phases_);
  }

 private:
  void add(EyeMovement movement, double duration_s, const Vec3d& from, const Vec3d& to) {
    const std::int64_t end_ns = now_ns_ + std::max<std::int64_t>(1, std::llround(duration_s * 1e9));
    phases_.push_back({movement, now_ns_, end_ns, from, to});
    now_ns_ = end_ns;
  }

  void fixate(std::uint64_t i, double stay_s, const Vec3d& at) {
    if (blinks_.uniform(i, 0) < settings_.blinks_per_min / 60 * settings_.fixation_s) {
      const double before = 0.1 + 0.1 * blinks_.uniform(i, 1);
      add(EyeMovement::fixation, before, at, at);
      add(EyeMovement::blink, 0.1 + 0.15 * blinks_.uniform(i, 2), at, at);
      stay_s = std::max(0.1, stay_s - before);
    }
    add(EyeMovement::fixation, stay_s, at, at);
  }

  // A direction about `distance_deg` away and within the field; the distance shrinks where the field is too small.
  [[nodiscard]] Vec3d target(std::uint64_t i, std::uint64_t purpose, const Vec3d& from, double distance_deg) const {
    const TangentFrame frame(from);
    double distance = distance_deg * kRadPerDeg;
    for (std::uint64_t trial = 0;; ++trial) {
      const double angle = 2 * kPi * targets_.uniform(i, 1000 * purpose + trial);
      const Vec3d side = frame.right * std::cos(angle) + frame.up * std::sin(angle);
      const Vec3d to = normalize(frame.forward * std::cos(distance) + side * std::sin(distance));
      if (is_inside(to)) {
        return to;
      }
      distance *= trial > 20 ? 0.8 : 1;
      if (trial > 200) {
        return from;
      }
    }
  }

  [[nodiscard]] bool is_inside(const Vec3d& direction) const {
    if (settings_.kind == GazeKind::screen) {
      const Vec2d place = screen_.place(direction);
      return place.x > 0.05 && place.x < 0.95 && place.y > 0.05 && place.y < 0.95;
    }
    const Vec2d angles = TangentFrame().angles(direction);
    return std::abs(angles.x) < 20 * kRadPerDeg && std::abs(angles.y) < 15 * kRadPerDeg;
  }

  const SynthSettings& settings_;
  const ScreenAngles& screen_;
  CounterRandom durations_, targets_, blinks_, pursuits_;
  std::int64_t now_ns_ = 0;
  std::vector<Phase> phases_;
};

// Slow sinusoids of different rates, which have no step and no end and the same root mean square everywhere.
class Drift {
 public:
  Drift(std::uint64_t seed, double rms_deg) : rms_(rms_deg * kRadPerDeg) {
    const CounterRandom random(seed, kDrift);
    for (std::uint64_t i = 0; i < waves_.size(); ++i) {
      waves_[i] = {0.2 + 1.5 * random.uniform(i, 0), 2 * kPi * random.uniform(i, 1), 2 * kPi * random.uniform(i, 2)};
    }
  }
  [[nodiscard]] Vec2d at(double t_s) const {
    Vec2d sum;
    for (const Wave& wave : waves_) {
      const double phase = 2 * kPi * wave.rate_hz * t_s;
      sum.x += std::sin(phase + wave.phase_x);
      sum.y += std::sin(phase + wave.phase_y);
    }
    // A sinusoid's mean square is a half, in each of two coordinates.
    const double scale = rms_ / std::sqrt(static_cast<double>(waves_.size()));
    return {sum.x * scale, sum.y * scale};
  }

 private:
  struct Wave {
    double rate_hz, phase_x, phase_y;
  };
  std::array<Wave, 6> waves_;
  double rms_;
};

Vec3d direction_in(const Phase& phase, std::int64_t t_ns) {
  const double s = static_cast<double>(t_ns - phase.begin_ns) / static_cast<double>(phase.end_ns - phase.begin_ns);
  if (phase.movement == EyeMovement::pursuit) {
    return between_directions(phase.from, phase.to, s);
  }
  if (phase.movement == EyeMovement::saccade) {
    return between_directions(phase.from, phase.to, s * s * s * (10 + s * (6 * s - 15)));
  }
  return phase.from;
}

EyeEvent true_event(const Phase& phase, std::size_t first, const std::vector<GazeSample>& samples) {
  EyeEvent event;
  event.movement = phase.movement;
  event.first = event.last = first;
  event.begin_ns = samples[first].t_ns;
  event.u = event.v = event.dispersion_deg = event.mean_velocity_deg_s = kNan;
  event.direction = phase.movement == EyeMovement::fixation ? phase.from : Vec3d{kNan, kNan, kNan};
  event.amplitude_deg = event.peak_velocity_deg_s = event.angle_deg = kNan;
  if (phase.movement == EyeMovement::saccade || phase.movement == EyeMovement::pursuit) {
    const double duration_s = static_cast<double>(phase.end_ns - phase.begin_ns) * 1e-9;
    const TangentFrame frame(phase.from);
    event.amplitude_deg = angle_between_rad(phase.from, phase.to) * kDegPerRad;
    event.mean_velocity_deg_s = event.amplitude_deg / duration_s;
    event.peak_velocity_deg_s = event.mean_velocity_deg_s * (phase.movement == EyeMovement::saccade ? 1.875 : 1);
    event.angle_deg = std::atan2(dot(phase.to, frame.up), dot(phase.to, frame.right)) * kDegPerRad;
  }
  return event;
}

void lose(GazeSample& sample, GazeValidity validity, GazeKind kind) {
  sample.validity = validity;
  if (kind == GazeKind::direction) {
    sample.direction = {kNan, kNan, kNan};
  } else {
    sample.u = sample.v = kNan;
  }
}

}  // namespace

double main_sequence_duration_s(double amplitude_deg) {
  return 0.021 + 0.0022 * amplitude_deg;
}

SynthGaze synthesize_gaze(const SynthSettings& settings) {
  check(settings);
  SynthGaze synth;
  GazeLog& log = synth.log;
  log.kind = settings.kind;
  log.format = "gazetrace-csv";
  log.source = "synthetic";
  log.clock = "synthetic";
  log.nominal_rate_hz = settings.rate_hz;
  if (settings.kind == GazeKind::screen) {
    log.recording_geometry = settings.display;
  }
  const ScreenAngles screen(log);
  const std::vector<Phase> phases = Scanpath(settings, screen).phases();
  const Drift drift(settings.seed, settings.drift_deg);
  const CounterRandom noise(settings.seed, kNoise);
  const CounterRandom loss(settings.seed, kLoss);
  synth.truth.preset = "truth";
  synth.truth.peak_threshold_deg_s = synth.truth.onset_threshold_deg_s = kNan;

  std::size_t at = 0;
  std::size_t phase_of_event = phases.size();
  for (std::uint64_t i = 0;; ++i) {
    GazeSample sample;
    sample.t_ns = std::llround(static_cast<double>(i) * 1e9 / settings.rate_hz);
    if (sample.t_ns >= settings.duration_ns) {
      break;
    }
    while (phases[at].end_ns <= sample.t_ns) {
      ++at;
    }
    const Phase& phase = phases[at];
    sample.row = static_cast<std::int64_t>(i) + 1;
    sample.confidence = sample.pupil = std::numeric_limits<float>::quiet_NaN();
    const Vec2d wander = drift.at(static_cast<double>(sample.t_ns) * 1e-9);
    const Vec2d error = settings.noise_deg > 0 ? noise.normals(i, 0) : Vec2d{};
    const double sd = settings.noise_deg * kRadPerDeg;
    const TangentFrame frame(direction_in(phase, sample.t_ns));
    set_direction(sample, settings.kind, screen, frame.direction({wander.x + sd * error.x, wander.y + sd * error.y}));
    if (sample.validity == GazeValidity::lost) {  // turned away: an eye that looks, at no place of the screen's plane
      lose(sample, GazeValidity::off_screen, settings.kind);
    }
    EyeMovement label = phase.movement;
    if (phase.movement == EyeMovement::blink) {
      lose(sample, GazeValidity::blink, settings.kind);
    } else if (loss.uniform(i / 4, 0) < settings.lost_share) {
      lose(sample, GazeValidity::lost, settings.kind);
      label = EyeMovement::lost;
    }
    log.samples.push_back(sample);
    synth.truth.labels.push_back(label);
    // Events are those of the eye itself, so losses do not split them.
    if (phase_of_event != at) {
      phase_of_event = at;
      synth.truth.events.push_back(true_event(phase, log.samples.size() - 1, log.samples));
    }
    synth.truth.events.back().last = log.samples.size() - 1;
    synth.truth.events.back().end_ns = sample.t_ns;
  }
  return synth;
}

}  // namespace gazetrace
