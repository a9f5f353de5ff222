// SPDX-License-Identifier: Apache-2.0
// What is the same for every method: which samples are lost or in a blink, which constants are allowed, and presets.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/enum_name.hpp"
#include "core/named.hpp"
#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"
#include "gazelog/eyes.hpp"

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

void label_samples(std::vector<EyeMovement>& labels, std::size_t first, std::size_t end, EyeMovement movement) {
  std::fill(labels.begin() + static_cast<std::ptrdiff_t>(first), labels.begin() + static_cast<std::ptrdiff_t>(end),
            movement);
}

void drop_short(EyeMovement movement, const GazeDirections& gaze, EyeEvents& events) {
  // Each sample stands for one step of the clock.
  const std::int64_t step_ns = median_step_ns(gaze.t_ns);
  for (const LabelRun& run : label_runs(events.labels, gaze.t_ns)) {
    if (run.movement == movement &&
        gaze.t_ns[run.last] - gaze.t_ns[run.first] + step_ns < events.settings.min_fixation_ns) {
      label_samples(events.labels, run.first, run.last + 1, EyeMovement::unclassified);
    }
  }
}

std::vector<EyeMovement> absence_labels(const GazeLog& log, const std::vector<std::int64_t>& t_ns) {
  std::vector<EyeMovement> labels(log.samples.size(), EyeMovement::unclassified);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!is_usable(log.samples[i].validity)) {
      labels[i] = log.samples[i].validity == GazeValidity::blink ? EyeMovement::blink : EyeMovement::lost;
    }
  }
  for (const GazeEvent& event : log.events) {
    if (event.type != GazeEventType::blink) {
      continue;
    }
    const auto begin = std::lower_bound(t_ns.begin(), t_ns.end(), event.begin_ns);
    for (auto at = begin; at != t_ns.end() && *at <= event.end_ns; ++at) {
      const auto i = static_cast<std::size_t>(at - t_ns.begin());
      labels[i] = labels[i] == EyeMovement::lost ? EyeMovement::blink : labels[i];
    }
  }
  return labels;
}

void infer_blinks(const std::vector<std::int64_t>& t_ns, std::int64_t min_ns, std::int64_t max_ns,
                  std::vector<EyeMovement>& labels) {
  const auto is_away = [&](std::size_t i) { return labels[i] == EyeMovement::lost || labels[i] == EyeMovement::blink; };
  for (std::size_t i = 0; max_ns > 0 && i < labels.size(); ++i) {
    if (!is_away(i)) {
      continue;
    }
    std::size_t end = i;
    bool named = false;
    while (end < labels.size() && is_away(end)) {
      named = named || labels[end] == EyeMovement::blink;
      ++end;
    }
    const bool between = i > 0 && end < labels.size();
    const std::int64_t away_ns = between ? t_ns[end] - t_ns[i - 1] : 0;
    if (between && away_ns <= max_ns && (named || away_ns >= min_ns)) {
      label_samples(labels, i, end, EyeMovement::blink);
    }
    i = end;
  }
}

EyeEvents detect_events(const GazeLog& log, const EventSettings& settings) {
  check_settings(settings);
  const EventMethod& method = find_named(methods(), settings.method, "event algorithm", "");
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
                fmt::format("use {}, or name the device of the recording by `device`", fitting));
  }
  EyeEvents events = detect_events(log, preset.settings);
  events.preset = preset.name;
  return events;
}

// The two eyes of a log, each by itself and held against each other.
GazeLog one_eye(const GazeLog& log, Eye eye) {
  if (log.eyes.size() != log.samples.size() || log.samples.empty()) {
    throw Error(ErrorKind::input, log.source, "does not hold both eyes separately");
  }
  GazeLog alone = log;
  alone.eyes.clear();
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const EyeGaze& gaze = eye == Eye::left ? log.eyes[i].left : log.eyes[i].right;
    GazeSample& sample = alone.samples[i];
    sample.eye = eye;
    take_eye(sample, gaze, log.kind);
    if (is_usable(sample.validity) && (std::isnan(gaze.at.x) || std::isnan(gaze.at.y))) {
      sample.validity = GazeValidity::lost;
    }
  }
  return alone;
}

EyeEvents binocular_events(const GazeLog& log, const EventPreset& preset, std::optional<GazeDevice> device) {
  const GazeLog left = one_eye(log, Eye::left);
  EyeEvents events = detect_events(left, preset, device);
  const EyeEvents other = detect_events(one_eye(log, Eye::right), preset, device);
  const auto is_fast = [](EyeMovement m) { return m == EyeMovement::saccade || m == EyeMovement::microsaccade; };
  for (const EyeEvent& event : events.events) {
    const auto first = other.labels.begin() + static_cast<std::ptrdiff_t>(event.first);
    const auto end = other.labels.begin() + static_cast<std::ptrdiff_t>(event.last) + 1;
    if (is_fast(event.movement) && std::none_of(first, end, is_fast)) {
      label_samples(events.labels, event.first, event.last + 1, EyeMovement::fixation);
    }
  }
  events.events = measure_events(left, gaze_directions(left, events.settings.space), events);
  return events;
}

const std::vector<EventPreset>& event_presets() {
  static const std::vector<EventPreset> kPresets{
#define EVENT_PRESET(name, device, description, ...) \
  EventPreset{name, description, GazeDevice::device, EventSettings{__VA_ARGS__}},
#include "gaze/events/presets.def"
#undef EVENT_PRESET
  };
  return kPresets;
}

const EventPreset& event_preset(std::string_view name) {
  return find_named(event_presets(), name, "event method", "");
}

const EventPreset& default_event_preset(const GazeLog& log, std::optional<GazeDevice> device) {
  return event_preset(device.value_or(recorded_device(log)) == GazeDevice::desktop ? "ivt"
                      : log.head.empty()                                           ? "ivt-attention"
                                                                                   : "ivt-hmd");
}

GazeDevice recorded_device(const GazeLog& log) {
  return log.device.value_or(log.kind == GazeKind::screen ? GazeDevice::desktop : GazeDevice::head_mounted);
}

std::string_view to_string(GazeSpace space) {
  return space == GazeSpace::head ? "head" : "world";
}

std::string_view to_string(EyeMovement movement) {
  return name_of(movement, {"fixation", "saccade", "pursuit", "blink", "lost", "unclassified", "microsaccade"});
}

}  // namespace gazetrace
