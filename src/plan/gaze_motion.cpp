// SPDX-License-Identifier: Apache-2.0
#include "plan/gaze_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "gaze/angles.hpp"

namespace gazetrace {
namespace {

constexpr double kFramesOfLatency = 4;

double frame_ns(const PlanSettings& settings) {
  return 1e9 * static_cast<double>(settings.fps.denominator) / static_cast<double>(settings.fps.numerator);
}

}  // namespace

GazeMotion::GazeMotion(const GazeLog* log, const PlanSettings& settings)
    : log_(log), max_gap_ns_(settings.gaze.max_interpolation_gap_ns) {
  // Gaze of a single row never moves.
  if (log == nullptr || log->samples.size() < 2 || !knows_angles(*log)) {
    return;
  }
  if (settings.find_events) {
    movements_ = detect_events(*log, default_event_preset(*log)).labels;
  }
}

std::size_t GazeMotion::row_at(std::int64_t t_log_ns) const {
  const auto after = std::upper_bound(log_->samples.begin(), log_->samples.end(), t_log_ns,
                                      [](std::int64_t t, const GazeSample& sample) { return t < sample.t_ns; });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - log_->samples.begin() - 1, 0));
}

bool GazeMotion::is_seen(std::int64_t t_log_ns) const {
  return t_log_ns >= log_->samples.front().t_ns && !is_unseen(log_->samples, row_at(t_log_ns), t_log_ns, max_gap_ns_);
}

bool GazeMotion::in_saccade(std::int64_t t_log_ns) const {
  return !movements_.empty() && is_seen(t_log_ns) && movements_[row_at(t_log_ns)] == EyeMovement::saccade;
}

bool GazeMotion::did(EyeMovement movement, std::int64_t after_log_ns, std::int64_t t_log_ns) const {
  if (movements_.empty()) {
    return false;
  }
  const auto first = movements_.begin() + static_cast<std::ptrdiff_t>(row_at(std::min(after_log_ns, t_log_ns)));
  const auto last = movements_.begin() + static_cast<std::ptrdiff_t>(row_at(t_log_ns));
  // The first row was already counted for the frame before; where it is the only one, it counts for this frame, too, as
  // long as it says what the eye does.
  if (first == last) {
    return is_seen(t_log_ns) && *first == movement;
  }
  return std::find(first + 1, last + 1, movement) != last + 1;
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

}  // namespace gazetrace
