// SPDX-License-Identifier: Apache-2.0
#include "plan/gaze_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/nan.hpp"
#include "core/statistics.hpp"

namespace gazetrace {
namespace {

constexpr std::int64_t kSpeedWindowNs = 20'000'000;
constexpr double kFramesOfLatency = 4;

double frame_ns(const PlanSettings& settings) {
  return 1e9 * static_cast<double>(settings.fps.denominator) / static_cast<double>(settings.fps.numerator);
}

}  // namespace

GazeMotion::GazeMotion(const GazeLog* log, const PlanSettings& settings)
    : log_(log), uncertainty_(settings.uncertainty) {
  // Gaze of a single row never moves.
  if (log == nullptr || log->samples.size() < 2 || !knows_angles(*log)) {
    return;
  }
  if (settings.find_events) {
    movements_ = detect_events(*log, default_event_preset(*log)).labels;
  }
  if (uncertainty_ || settings.find_speed) {
    speed_deg_s_ = angular_speed_deg_s(gaze_directions(*log), kSpeedWindowNs);
  }
}

std::size_t GazeMotion::row_at(std::int64_t t_log_ns) const {
  const auto after = std::upper_bound(log_->samples.begin(), log_->samples.end(), t_log_ns,
                                      [](std::int64_t t, const GazeSample& sample) { return t < sample.t_ns; });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - log_->samples.begin() - 1, 0));
}

double GazeMotion::speed_deg_s(std::int64_t t_log_ns) const {
  if (speed_deg_s_.empty()) {
    return 0;
  }
  const double speed = speed_deg_s_[row_at(t_log_ns)];
  return std::isnan(speed) ? 0 : speed;
}

bool GazeMotion::in_saccade(std::int64_t t_log_ns) const {
  return !movements_.empty() && movements_[row_at(t_log_ns)] == EyeMovement::saccade;
}

bool GazeMotion::did(EyeMovement movement, std::int64_t after_log_ns, std::int64_t t_log_ns) const {
  if (movements_.empty()) {
    return false;
  }
  const auto first = movements_.begin() + static_cast<std::ptrdiff_t>(row_at(std::min(after_log_ns, t_log_ns)));
  const auto last = movements_.begin() + static_cast<std::ptrdiff_t>(row_at(t_log_ns));
  // The first row was already counted for the frame before; where it is the only one, it counts for this frame, too.
  return std::find(first == last ? first : first + 1, last + 1, movement) != last + 1;
}

double GazeMotion::uncertainty_deg(const FrameRequest& request) const {
  const auto age_ns = effective_age_ns(request);
  // A fixed gaze has no rows and no age. It does not move, but may be off all the same.
  const bool is_fixed = !age_ns && request.gaze_render.state == GazeState::measured;
  if (!uncertainty_ || (!age_ns && !is_fixed)) {
    return 0;
  }
  const double moved_deg =
      is_fixed ? 0 : speed_deg_s(request.gaze_true.t_log_ns - *age_ns) * std::abs(static_cast<double>(*age_ns)) * 1e-9;
  return uncertainty_->accuracy_deg + uncertainty_->precision_deg + moved_deg;
}

std::optional<std::int64_t> effective_age_ns(const FrameRequest& request) {
  const GazeAtTime& gaze = request.gaze_render;
  if (gaze.row_before == 0 && gaze.row_after == 0) {
    return std::nullopt;
  }
  const bool between = gaze.row_before != 0 && gaze.row_after != 0;
  return request.gaze_true.t_log_ns - gaze.t_log_ns + (between ? 0 : gaze.age_ns);
}

std::optional<GazeAges> gaze_ages(const FramePlan& plan, const PlanSettings& settings) {
  GazeAges ages;
  std::vector<double> all;
  for (const FrameRequest& request : plan.frames) {
    if (request.gaze_render.no_gaze) {
      ++ages.without;
    } else if (request.gaze_effective_age_ns) {
      all.push_back(static_cast<double>(*request.gaze_effective_age_ns));
    } else if (effective_age_ns(request)) {
      ++ages.unknown;
    }
  }
  if (all.empty() && ages.unknown == 0) {
    return std::nullopt;
  }
  ages.half_frame_ns = 0.5 * frame_ns(settings);
  ages.frames = all.size();
  if (!all.empty()) {
    std::sort(all.begin(), all.end());
    const auto at = [&](double share) { return all[covering_rank(share, all.size())]; };
    ages.min_ns = all.front();
    ages.median_ns = at(0.5);
    ages.p95_ns = at(0.95);
    ages.max_ns = all.back();
    for (const double age : all) {
      ages.mean_ns += age / static_cast<double>(all.size());
    }
  }
  return ages;
}

void warn_about_latency(const PlanSettings& settings, Warnings& warnings) {
  const auto latency_ns = static_cast<double>(settings.gaze_latency_ns);
  const double frames = latency_ns / frame_ns(settings);
  if (settings.gaze_latency_ns == 0 || frames >= kFramesOfLatency) {
    return;
  }
  const double half_ms = 0.5e-6 * frame_ns(settings);
  warnings.push_back(fmt::format(
      "a latency of {:.4g} ms is {:.1f} frames at {} fps: while a frame is shown, the age of its gaze grows "
      "from {:.1f} to {:.1f} ms; a study of latency needs `fps` {:.0f} or more",
      latency_ns * 1e-6, frames, to_string(settings.fps), latency_ns * 1e-6 - half_ms, latency_ns * 1e-6 + half_ms,
      std::ceil(kFramesOfLatency * 1e9 / latency_ns)));
}

GazeUncertainty uncertainty_of(const GazeLog& log) {
  GazeUncertainty uncertainty{kNan, kNan};
  double sum = 0;
  double count = 0;
  for (const GazeCalibration& calibration : log.calibrations) {
    if (!std::isnan(calibration.mean_error_deg)) {
      sum += calibration.mean_error_deg;
      ++count;
    }
  }
  if (count > 0) {
    uncertainty.accuracy_deg = sum / count;
  }
  if (log.samples.size() > 1 && knows_angles(log)) {
    double squares = 0;
    double samples = 0;
    for (const EyeEvent& event : detect_events(log, default_event_preset(log)).events) {
      if (event.movement == EyeMovement::fixation && !std::isnan(event.dispersion_deg)) {
        const auto weight = static_cast<double>(event.last - event.first + 1);
        squares += weight * event.dispersion_deg * event.dispersion_deg;
        samples += weight;
      }
    }
    if (samples > 0) {
      uncertainty.precision_deg = std::sqrt(squares / samples);
    }
  }
  return uncertainty;
}

}  // namespace gazetrace
