// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gaze/angles.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_process.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kLeastEvents = 8;      // fewer tell nothing about their median
constexpr double kLeastSeenS = 3;            // nor does a shorter recording tell about rates
constexpr double kShortFixationMs = 90;      // median
constexpr double kLeastFixationShare = 0.4;  // of the time that the eye was seen
constexpr double kMostSaccadesPerS = 8;
constexpr double kSaccadesPerFixation = 2;
constexpr double kMainSequenceFactor = 2.5;
constexpr double kLeastRateHz = 100;  // for peak velocities
constexpr double kNoisyShare = 0.5;   // of a threshold that noise alone reaches in the median

std::size_t count_of(const EyeEvents& events, EyeMovement movement) {
  return static_cast<std::size_t>(std::count_if(events.events.begin(), events.events.end(),
                                                [&](const EyeEvent& event) { return event.movement == movement; }));
}

double published_duration_ms(double amplitude_deg) {
  return 21 + 2.2 * amplitude_deg;
}
double published_peak_deg_s(double amplitude_deg) {
  return 500 * (1 - std::exp(-amplitude_deg / 10.2));
}
// The amplitude whose peak velocity that is.
double published_amplitude_deg(double peak_deg_s) {
  return peak_deg_s < 499 ? -10.2 * std::log(1 - peak_deg_s / 500) : std::numeric_limits<double>::infinity();
}

// The extent in azimuth plus that in elevation which white noise alone gives so many samples: twice the expected range
// of n normal values, whose largest is about sqrt(2 ln n) - (ln ln n + ln 4 pi) / (2 sqrt(2 ln n)) (Cramer,
// Mathematical Methods of Statistics, 1946, 28.6). From sample to sample, white noise of two axes steps twice its
// standard deviation, as a root mean square.
double noise_extent_deg(double rms_s2s_deg, double samples) {
  const double root = std::sqrt(2 * std::log(std::max(samples, 3.0)));
  const double largest = root - (std::log(std::log(std::max(samples, 3.0))) + std::log(4 * kPi)) / (2 * root);
  return 4 * largest * (rms_s2s_deg / 2);
}

// Extents of neighbouring windows of that length in which the eye was seen throughout.
double median_extent_deg(const GazeDirections& gaze, std::int64_t window_ns) {
  std::vector<double> extents;
  const std::int64_t break_ns = break_step_ns(median_step_ns(gaze.t_ns));
  std::size_t first = 0;
  std::array<double, 4> box{};  // least and most azimuth, least and most elevation
  const TangentFrame frame;
  for (std::size_t i = 0; i < gaze.t_ns.size(); ++i) {
    if (!is_seen(gaze.direction[i])) {
      first = i + 1;
      continue;
    }
    if (i > first && gaze.t_ns[i] - gaze.t_ns[i - 1] > break_ns) {
      first = i;
    }
    const Vec2d at = frame.angles(gaze.direction[i]);
    box = i == first ? std::array{at.x, at.x, at.y, at.y}
                     : std::array{std::min(box[0], at.x), std::max(box[1], at.x), std::min(box[2], at.y),
                                  std::max(box[3], at.y)};
    if (gaze.t_ns[i] - gaze.t_ns[first] >= window_ns) {
      extents.push_back((box[1] - box[0] + box[3] - box[2]) * kDegPerRad);
      first = i + 1;
    }
  }
  return lower_quantile(extents, 0.5);
}

class Check {
 public:
  Check(const GazeLog& log, const EyeEvents& events)
      : log_(log), events_(events), step_ns_(median_step_ns(times_of(log))) {
    for (const EyeEvent& event : events.events) {
      const double ms = static_cast<double>(event.end_ns - event.begin_ns + step_ns_) * 1e-6;
      const bool is_seen_then = event.movement != EyeMovement::lost && event.movement != EyeMovement::blink;
      seen_s_ += is_seen_then ? ms * 1e-3 : 0;
      if (event.movement == EyeMovement::fixation) {
        fixations_ms_.push_back(ms);
        fixations_s_ += ms * 1e-3;
      }
    }
    saccades_ = count_of(events, EyeMovement::saccade);
  }

  std::vector<EventDoubt> run() {
    noise();
    fixations();
    saccades();
    return std::move(doubts_);
  }

 private:
  void doubt(std::string code, std::string what) { doubts_.push_back({std::move(code), std::move(what)}); }

  void doubt_noise(const EventNoise& noise, const std::string& what) {
    doubt("noise", fmt::format("noise of {:.2g} deg RMS from sample to sample {}", noise.rms_s2s_deg, what));
  }

  void noise() {
    const EventSettings& s = events_.settings;
    const EventNoise noise = measure_event_noise(log_, s);
    if (s.method == "ivt" && noise.median_speed_deg_s > kNoisyShare * s.velocity_deg_s) {
      doubt_noise(
          noise,
          fmt::format("stands for {:.0f} deg/s in the median over the method's window of {:g} ms, and saccades "
                      "begin at {:g} deg/s",
                      noise.median_speed_deg_s, static_cast<double>(s.velocity_window_ns) * 1e-6, s.velocity_deg_s));
    }
    if (s.method == "idt" && noise.median_extent_deg > kNoisyShare * s.dispersion_deg) {
      doubt_noise(
          noise, fmt::format("spreads {:g} ms of gaze over {:.2g} deg in the median, and a fixation may spread "
                             "over {:g} deg",
                             static_cast<double>(s.min_fixation_ns) * 1e-6, noise.median_extent_deg, s.dispersion_deg));
    }
    // The adaptive method finds no saccade that is slower than the threshold to which the noise raised it. Its filter
    // lowers the peaks of small saccades besides, so that those of 2 deg are lost before a threshold of 89 deg/s. Of
    // the method for microsaccades the threshold is a multiple of the noise.
    constexpr double kSmallSaccadeDeg = 1.5;
    const bool is_micro = s.method == "ek";
    const double least_deg = is_micro ? s.max_microsaccade_deg : kSmallSaccadeDeg;
    if ((is_micro || s.method == "adaptive") && events_.peak_threshold_deg_s > published_peak_deg_s(least_deg)) {
      doubt_noise(noise,
                  fmt::format("raised the threshold to {:.0f} deg/s, at which saccades below {:.1f} deg are not "
                              "found{}",
                              events_.peak_threshold_deg_s, published_amplitude_deg(events_.peak_threshold_deg_s),
                              is_micro ? fmt::format(", and microsaccades are below {:g} deg", least_deg) : ""));
    }
    // Noise that leaves the dispersion makes pursuit of fixation. The gaze's own extent would not tell, as pursuit
    // moves.
    const double samples = static_cast<double>(s.dispersion_window_ns) / static_cast<double>(step_ns_) + 1;
    const double extent_deg = s.method == "ivdt" && step_ns_ > 0 ? noise_extent_deg(noise.rms_s2s_deg, samples) : 0;
    if (extent_deg > kNoisyShare * s.dispersion_deg) {
      doubt_noise(noise,
                  fmt::format("would alone spread {:g} ms of gaze over {:.2g} deg, and what spreads over {:g} deg "
                              "is pursuit",
                              static_cast<double>(s.dispersion_window_ns) * 1e-6, extent_deg, s.dispersion_deg));
    }
  }

  void fixations() {
    const double share = seen_s_ > 0 ? fixations_s_ / seen_s_ : 1;
    if (seen_s_ >= kLeastSeenS && share < kLeastFixationShare) {
      doubt("few-fixations", fmt::format("{} fixations fill {:.0f} % of the time in which the eye was seen; 80 % and "
                                         "more are usual where nothing moves",
                                         fixations_ms_.size(), 100 * share));
    }
    if (fixations_ms_.size() >= kLeastEvents) {
      const double median = lower_quantile(fixations_ms_, 0.5);
      if (median < kShortFixationMs) {
        doubt("short-fixations",
              fmt::format("fixations last {:.0f} ms in the median; 200 to 400 ms are usual", median));
      }
    }
  }

  void saccades() {
    if (saccades_ < kLeastEvents) {
      return;
    }
    const double per_s = static_cast<double>(saccades_) / std::max(seen_s_, 1e-9);
    const double per_fixation =
        static_cast<double>(saccades_) / static_cast<double>(std::max<std::size_t>(fixations_ms_.size(), 1));
    if (per_s > kMostSaccadesPerS || per_fixation > kSaccadesPerFixation) {
      doubt("many-saccades",
            fmt::format("{} saccades for {} fixations, {:.1f} a second; one between two fixations, and "
                        "two to four a second, are usual",
                        saccades_, fixations_ms_.size(), per_s));
    }
    long_saccades();
    main_sequence();
  }

  void long_saccades() {
    std::size_t longer = 0;
    const EyeEvent* worst = nullptr;
    double worst_excess_ms = 0;
    // The filter's window and two samples smear the ends of a saccade.
    const double smear_ms = static_cast<double>(events_.settings.velocity_window_ns + 2 * step_ns_) * 1e-6;
    for (const EyeEvent& event : events_.events) {
      if (event.movement != EyeMovement::saccade || std::isnan(event.amplitude_deg)) {
        continue;
      }
      const double ms = static_cast<double>(event.end_ns - event.begin_ns + step_ns_) * 1e-6;
      const double excess_ms = ms - (2 * published_duration_ms(event.amplitude_deg) + smear_ms);
      longer += excess_ms > 0 ? 1 : 0;
      if (excess_ms > worst_excess_ms) {
        worst_excess_ms = excess_ms;
        worst = &event;
      }
    }
    if (worst != nullptr && longer * 10 > saccades_) {
      doubt("long-saccades",
            fmt::format("{} of {} saccades last more than twice as long as saccades of their amplitude do, one {:.0f} "
                        "ms over {:.1f} deg; {:.0f} ms are usual for that",
                        longer, saccades_, static_cast<double>(worst->end_ns - worst->begin_ns + step_ns_) * 1e-6,
                        worst->amplitude_deg, published_duration_ms(worst->amplitude_deg)));
    }
  }

  void main_sequence() {
    if (step_ns_ <= 0 || 1e9 / static_cast<double>(step_ns_) < kLeastRateHz) {
      return;  // slower trackers miss the peaks
    }
    std::vector<double> ratios;
    for (const EyeEvent& event : events_.events) {
      if (event.movement == EyeMovement::saccade && event.amplitude_deg >= 1 && event.peak_velocity_deg_s > 0) {
        ratios.push_back(event.peak_velocity_deg_s / published_peak_deg_s(event.amplitude_deg));
      }
    }
    if (ratios.size() < kLeastEvents) {
      return;
    }
    const double median = lower_quantile(ratios, 0.5);
    if (median > kMainSequenceFactor || median < 1 / kMainSequenceFactor) {
      doubt("main-sequence",
            fmt::format("the peak velocities of the saccades are {:.2g} times those that the published main sequence "
                        "has for their amplitudes, in the median of {}",
                        median, ratios.size()));
    }
  }

  const GazeLog& log_;
  const EyeEvents& events_;
  std::int64_t step_ns_;
  std::size_t saccades_ = 0;
  double seen_s_ = 0, fixations_s_ = 0;
  std::vector<double> fixations_ms_;
  std::vector<EventDoubt> doubts_;
};

std::string in_words(const EyeEvents& events) {
  return fmt::format("{} fixations, {} saccades", count_of(events, EyeMovement::fixation),
                     count_of(events, EyeMovement::saccade));
}

}  // namespace

EventNoise measure_event_noise(const GazeLog& log, const EventSettings& settings) {
  const GazeDirections gaze = gaze_directions(log, settings.space);
  const std::int64_t break_ns = break_step_ns(median_step_ns(gaze.t_ns));
  std::vector<double> steps_deg;
  std::vector<double> speeds;
  const std::vector<double> all_speeds = angular_speed_deg_s(gaze, settings.velocity_window_ns);
  constexpr std::size_t kMostLookedAt = 400'000;
  const std::size_t stride = gaze.t_ns.size() / kMostLookedAt + 1;
  for (std::size_t i = stride; i < gaze.t_ns.size(); i += stride) {
    if (is_seen(gaze.direction[i]) && is_seen(gaze.direction[i - 1]) && gaze.t_ns[i] - gaze.t_ns[i - 1] <= break_ns) {
      steps_deg.push_back(angle_between_rad(gaze.direction[i], gaze.direction[i - 1]) * kDegPerRad);
    }
    if (!std::isnan(all_speeds[i])) {
      speeds.push_back(all_speeds[i]);
    }
  }
  constexpr std::size_t kLeastPairs = 10;
  EventNoise noise{kNan, kNan, kNan};
  if (steps_deg.size() >= kLeastPairs) {
    noise.rms_s2s_deg = lower_quantile(steps_deg, 0.5) / std::sqrt(std::log(2.0));
    noise.median_speed_deg_s = lower_quantile(speeds, 0.5);
    noise.median_extent_deg = median_extent_deg(gaze, settings.min_fixation_ns);
  }
  return noise;
}

std::vector<EventDoubt> doubt_events(const GazeLog& log, const EyeEvents& events) {
  return Check(log, events).run();
}

std::vector<std::string> better_event_methods(const GazeLog& log, const EyeEvents& events) {
  std::vector<std::string> better;
  const EventPreset* own = nullptr;
  for (const EventPreset& preset : event_presets()) {
    own = preset.name == events.preset ? &preset : own;
  }
  if (own == nullptr) {
    return better;
  }
  const auto keep_if_good = [&](const GazeLog& other, const EventPreset& preset, const std::string& option) {
    try {
      const EyeEvents found = detect_events(other, preset, own->device);
      if (doubt_events(other, found).empty()) {
        better.push_back(fmt::format("{} ({})", option, in_words(found)));
      }
    } catch (const Error&) {
      // A preset for gaze in the world, without a head; a filter that does not fit the rate.
    }
  };
  for (const EventPreset& preset : event_presets()) {
    if (preset.device == own->device && preset.name != own->name) {
      keep_if_good(log, preset, "`method` " + preset.name);
    }
  }
  for (const char* const text : {"median:samples=5", "savitzky-golay", "butterworth", "one-euro"}) {
    try {
      const ProcessedGaze processed = process_gaze(log, {parse_gaze_step(text)});
      keep_if_good(processed.log, *own, std::string("`gaze-process` ") + text);
    } catch (const Error&) {
      // It does not fit the rate of the log.
    }
  }
  return better;
}

// The method itself never changes, since the participants of a study must stay comparable.
std::vector<std::string> doubts_in_words(const std::vector<EventDoubt>& found, const EyeEvents& events,
                                         const GazeLog& log) {
  std::vector<std::string> lines;
  for (const EventDoubt& doubt : found) {
    lines.push_back(fmt::format("{}: events by {}: {}", log.source, events.preset, doubt.what));
  }
  if (!found.empty()) {
    const std::vector<std::string> better = better_event_methods(log, events);
    lines.push_back(fmt::format(
        "{}: these events are not to be relied on; {}", log.source,
        better.empty()
            ? "no method and no single step of processing here suits this log: use the tracker's own events "
              "(`method` log), or record with less noise"
            : fmt::format("without such doubts: {}; choose one for all participants", fmt::join(better, ", "))));
  }
  return lines;
}

}  // namespace gazetrace
