// SPDX-License-Identifier: Apache-2.0
// The quality of the data, under the names of Holmqvist, Nystrom & Mulvey 2012.
#include <algorithm>
#include <cmath>
#include <limits>

#include "gaze/angles.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazetrace/gaze_measure.hpp"

namespace gazetrace {
namespace {

struct Span {
  std::int64_t begin_ns, end_ns;
};

// The blocks of the recording; without any, all of it.
std::vector<Span> recorded_spans(const GazeLog& log) {
  std::vector<Span> spans;
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::segment && event.end_ns > event.begin_ns) {
      spans.push_back({event.begin_ns, event.end_ns});
    }
  }
  if (spans.empty()) {
    spans.push_back({log.samples.front().t_ns, log.samples.back().t_ns});
  }
  return spans;
}

void measure_accuracy(const GazeLog& log, std::optional<Eye> eye, GazeQuality& quality) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  double most = nan;
  for (const GazeCalibration& validation : log.calibrations) {
    if (std::isnan(validation.mean_error_deg) || (eye && validation.eye != *eye)) {
      continue;
    }
    ++quality.validations;
    sum += validation.mean_error_deg;
    most = std::fmax(most, std::isnan(validation.max_error_deg) ? validation.mean_error_deg : validation.max_error_deg);
  }
  quality.accuracy_deg = quality.validations > 0 ? sum / static_cast<double>(quality.validations) : nan;
  quality.accuracy_max_deg = most;
}

}  // namespace

GazeQuality measure_quality(const GazeLog& whole, std::optional<Eye> eye) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const GazeLog alone = eye ? one_eye(whole, *eye) : GazeLog{};
  const GazeLog& log = eye ? alone : whole;
  GazeQuality quality;
  quality.of = !eye ? "gaze" : *eye == Eye::left ? "left eye" : "right eye";
  quality.samples = log.samples.size();
  quality.accuracy_deg = quality.accuracy_max_deg = quality.precision_rms_s2s = quality.precision_sd = nan;
  if (log.samples.empty()) {
    quality.effective_rate_hz = quality.data_loss = nan;
    return quality;
  }
  const std::int64_t step_ns = median_step_ns(times_of(log));
  const double median_rate_hz = step_ns > 0 ? 1e9 / static_cast<double>(step_ns) : 0;
  quality.sampling_rate_hz = log.nominal_rate_hz > 0 ? log.nominal_rate_hz : median_rate_hz;
  double expected = 0;
  for (const Span& span : recorded_spans(log)) {
    const double seconds = static_cast<double>(span.end_ns - span.begin_ns) * 1e-9;
    // Each sample stands for one step of the clock, the last one too.
    quality.duration_s += seconds + static_cast<double>(step_ns) * 1e-9;
    expected += std::round(seconds * quality.sampling_rate_hz) + 1;
  }
  quality.usable = static_cast<std::size_t>(
      std::count_if(log.samples.begin(), log.samples.end(), [](const GazeSample& s) { return is_usable(s.validity); }));
  const auto usable = static_cast<double>(quality.usable);
  quality.effective_rate_hz = quality.duration_s > 0 ? usable / quality.duration_s : nan;
  quality.data_loss = std::clamp(1 - usable / std::max(expected, 1.0), 0.0, 1.0);
  measure_accuracy(log, eye, quality);
  const GazePlane plane(log, std::nullopt);
  quality.precision_unit = plane.unit();
  if (const auto precision = measure_precision(log, plane, static_cast<double>(step_ns))) {
    quality.precision_rms_s2s = precision->rms_s2s;
    quality.precision_sd = precision->sd;
  }
  return quality;
}

}  // namespace gazetrace
