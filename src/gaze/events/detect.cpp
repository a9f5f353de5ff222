// SPDX-License-Identifier: Apache-2.0
// What is the same for every method: which samples are lost or in a blink, and which constants are allowed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gaze/angles.hpp"
#include "gaze/events/absence.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {

#define EVENT_METHOD(name, ...) void classify_##name(const GazeDirections&, EyeEvents&);
#include "gaze/events/methods/methods.def"
#undef EVENT_METHOD

namespace {

const std::vector<EventMethod>& methods() {
  static const std::vector<EventMethod> kMethods{
#define EVENT_METHOD(name, text, description) {text, description, classify_##name},
#include "gaze/events/methods/methods.def"
#undef EVENT_METHOD
  };
  return kMethods;
}

const EventMethod& method_by_name(const std::string& name) {
  std::vector<std::string> known;
  for (const EventMethod& method : methods()) {
    if (method.name == name) {
      return method;
    }
    known.push_back(method.name);
  }
  throw Error(ErrorKind::usage, "", unknown_name_message("event algorithm", name, known));
}

void check_settings(const EventSettings& s) {
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  if (!positive(s.velocity_deg_s) || !positive(s.dispersion_deg) || !positive(s.start_velocity_deg_s) ||
      !positive(s.max_velocity_deg_s) || !positive(s.max_acceleration_deg_s2) || s.velocity_window_ns <= 0 ||
      !positive(s.noise_factor) || !positive(s.max_microsaccade_deg) || s.dispersion_window_ns <= 0) {
    throw Error(ErrorKind::usage, "", "a threshold of event detection is not a positive number");
  }
  if (s.min_fixation_ns < 0 || s.min_saccade_ns < 0 || s.max_gap_ns < 0 || s.merge_gap_ns < 0 ||
      !(s.merge_angle_deg >= 0) || s.min_blink_ns < 0 || s.max_blink_ns < s.min_blink_ns) {
    throw Error(ErrorKind::usage, "",
                "a duration of event detection is negative, or the longest blink the shorter one");
  }
}

}  // namespace

std::vector<LabelRun> label_runs(const std::vector<EyeMovement>& labels, const std::vector<std::int64_t>& t_ns) {
  const std::int64_t break_ns = break_step_ns(median_step_ns(t_ns));
  std::vector<LabelRun> runs;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (runs.empty() || runs.back().movement != labels[i] || t_ns[i] - t_ns[i - 1] > break_ns) {
      runs.push_back({labels[i], i, i});
    }
    runs.back().last = i;
  }
  return runs;
}

void drop_short_fixations(const GazeDirections& gaze, EyeEvents& events) {
  // Each sample stands for one step of the clock.
  const std::int64_t step_ns = median_step_ns(gaze.t_ns);
  for (const LabelRun& run : label_runs(events.labels, gaze.t_ns)) {
    if (run.movement == EyeMovement::fixation &&
        gaze.t_ns[run.last] - gaze.t_ns[run.first] + step_ns < events.settings.min_fixation_ns) {
      std::fill(events.labels.begin() + static_cast<std::ptrdiff_t>(run.first),
                events.labels.begin() + static_cast<std::ptrdiff_t>(run.last) + 1, EyeMovement::unclassified);
    }
  }
}

EyeEvents detect_events(const GazeLog& log, const EventSettings& settings) {
  check_settings(settings);
  const EventMethod& method = method_by_name(settings.method);
  const GazeDirections gaze = gaze_directions(log, settings.space);
  EyeEvents events;
  events.settings = settings;
  events.peak_threshold_deg_s = events.onset_threshold_deg_s = std::numeric_limits<double>::quiet_NaN();
  events.labels = absence_labels(log, gaze.t_ns);
  for (std::size_t i = 0; i < events.labels.size(); ++i) {
    if (events.labels[i] == EyeMovement::unclassified && !is_seen(gaze.direction[i])) {
      events.labels[i] = EyeMovement::lost;
    }
  }
  method.classify(gaze, events);
  infer_blinks(gaze.t_ns, settings.min_blink_ns, settings.max_blink_ns, events.labels);
  events.events = measure_events(log, gaze, events);
  return events;
}

EyeEvents detect_events(const GazeLog& log, const EventPreset& preset, std::optional<GazeDevice> device) {
  const GazeDevice recorded = device.value_or(recorded_device(log));
  if (preset.device != recorded) {
    std::string fitting;
    for (const EventPreset& other : event_presets()) {
      if (other.device == recorded) {
        fitting += (fitting.empty() ? "" : ", ") + other.name;
      }
    }
    throw Error(ErrorKind::input, log.source,
                fmt::format("was recorded {}, and '{}' is for {} data",
                            recorded == GazeDevice::desktop ? "on a desktop" : "on a head", preset.name,
                            to_string(preset.device)),
                fmt::format("use {}, or say with `device` what it was recorded on", fitting));
  }
  EyeEvents events = detect_events(log, preset.settings);
  events.preset = preset.name;
  return events;
}

}  // namespace gazetrace
