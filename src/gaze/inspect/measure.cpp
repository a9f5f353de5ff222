// SPDX-License-Identifier: Apache-2.0
// The plane in which gaze is measured; losses, frozen values, precision and binocular disparity.
#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazelog/stamps.hpp"

namespace gazetrace {
namespace {

constexpr double kBlinkLeastMs = 50, kBlinkMostMs = 500;
constexpr std::size_t kFrozenSamples = 5;
constexpr std::int64_t kFrozenNs = 100'000'000;
constexpr double kFixationDegPerS = 30;
constexpr std::int64_t kVelocityWindowNs = 20'000'000;
constexpr std::int64_t kFixationNs = 100'000'000;
constexpr double kAssumedWidthDeg = 40;  // of a picture of unknown size, for thresholds alone

// Sums over one fixation.
class Stretch {
 public:
  void add(const Vec2d& at) {
    ++count_;
    const double share = 1.0 / static_cast<double>(count_);
    const Vec2d from{at.x - mean_.x, at.y - mean_.y};
    mean_ = {mean_.x + share * from.x, mean_.y + share * from.y};
    squares_ += from.x * (at.x - mean_.x) + from.y * (at.y - mean_.y);
    if (count_ > 1) {
      const Vec2d step{at.x - last_.x, at.y - last_.y};
      steps_ += step.x * step.x + step.y * step.y;
    }
    last_ = at;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double rms_s2s() const { return std::sqrt(steps_ / static_cast<double>(count_ - 1)); }
  [[nodiscard]] double sd() const { return std::sqrt(squares_ / static_cast<double>(count_ - 1)); }

 private:
  std::size_t count_ = 0;
  Vec2d mean_, last_;
  double squares_ = 0, steps_ = 0;
};

// How long the eye is lost before it is seen for the first time, and after it is seen for the last time.
void measure_ends(const GazeLog& log, GazeLoss& loss) {
  const auto usable = [](const GazeSample& sample) { return is_usable(sample.validity); };
  const auto first = std::find_if(log.samples.begin(), log.samples.end(), usable);
  if (first == log.samples.end()) {
    loss.leading_ns = log.samples.back().t_ns - log.samples.front().t_ns;
    return;
  }
  const auto last = std::find_if(log.samples.rbegin(), log.samples.rend(), usable);
  loss.leading_ns = first->t_ns - log.samples.front().t_ns;
  loss.trailing_ns = log.samples.back().t_ns - last->t_ns;
  loss.first_usable_row = first->row;
  loss.last_usable_row = last->row;
}

}  // namespace

GazePlane::GazePlane(const GazeLog& log, const std::optional<DisplayGeometry>& given) : kind_(log.kind) {
  if (kind_ == GazeKind::direction) {
    return;
  }
  DisplayGeometry g = log.kind == GazeKind::screen ? given.value_or(DisplayGeometry{}) : DisplayGeometry{};
  if (const auto& stated = log.recording_geometry; stated && log.kind == GazeKind::screen) {
    g.width_px = g.width_px > 0 ? g.width_px : stated->width_px;
    g.height_px = g.height_px > 0 ? g.height_px : stated->height_px;
    if (!(g.width_cm > 0 && g.height_cm > 0)) {
      g.width_cm = stated->width_cm;
      g.height_cm = stated->height_cm;
    }
    g.distance_cm = g.distance_cm > 0 ? g.distance_cm : stated->distance_cm;
    if (g.eye_x_cm == 0 && g.eye_y_cm == 0) {  // what was given about the eye is already in the log
      g.eye_x_cm = stated->eye_x_cm;
      g.eye_y_cm = stated->eye_y_cm;
    }
  }
  screen_ = ScreenAngles(g, log.pixels_per_degree);
  if (screen_.known_by_size()) {
    return;
  }
  if (log.pixels_per_degree && g.width_px > 0 && g.height_px > 0) {
    x_scale_ = g.width_px / log.pixels_per_degree->x;
    y_scale_ = g.height_px / log.pixels_per_degree->y;
  } else if (g.width_px > 0 && g.height_px > 0) {
    unit_ = "px";
    x_scale_ = g.width_px;
    y_scale_ = g.height_px;
    units_per_degree_ = g.width_px / kAssumedWidthDeg;
  } else {
    unit_ = "of the picture";
    units_per_degree_ = 1 / kAssumedWidthDeg;
  }
}

Vec2d GazePlane::at(const Vec3d& place) const {
  if (kind_ == GazeKind::direction) {
    return {std::atan2(place.x, -place.z) * kDegPerRad,
            std::atan2(place.y, std::sqrt(place.x * place.x + place.z * place.z)) * kDegPerRad};
  }
  if (screen_.known_by_size()) {
    const Vec2d angles = screen_.angles(place.x, place.y);
    return {angles.x * kDegPerRad, angles.y * kDegPerRad};
  }
  return {place.x * x_scale_, -place.y * y_scale_};
}

GazeLoss measure_loss(const GazeLog& log, double median_step_ns) {
  GazeLoss loss;
  loss.samples = log.samples.size();
  std::vector<double> blinks_ms;
  const auto count = [&](double lost_ns) {
    const double lost_ms = lost_ns * 1e-6;
    if (lost_ms >= kBlinkLeastMs && lost_ms <= kBlinkMostMs) {
      blinks_ms.push_back(lost_ms);
    }
    loss.longer += lost_ms > kBlinkMostMs ? 1 : 0;
    loss.longest_ns = std::max(loss.longest_ns, static_cast<std::int64_t>(std::min(lost_ns, 9e18)));
  };
  std::vector<std::size_t> bounds = section_starts(log);
  bounds.push_back(log.samples.size());
  for (std::size_t section = 0; section + 1 < bounds.size(); ++section) {
    const GazeSample& first = log.samples[bounds[section]];
    const GazeSample& last = log.samples[bounds[section + 1] - 1];
    const GazeSample* before = nullptr;
    for (std::size_t i = bounds[section]; i < bounds[section + 1]; ++i) {
      const GazeSample& sample = log.samples[i];
      ++loss.by_validity[static_cast<std::size_t>(sample.validity)];
      if (!is_usable(sample.validity)) {
        continue;
      }
      ++loss.usable;
      if (before != nullptr) {
        count(static_cast<double>(sample.t_ns - before->t_ns) - median_step_ns);
      } else if (sample.t_ns > first.t_ns) {
        count(static_cast<double>(sample.t_ns - first.t_ns));
      }
      before = &sample;
    }
    if (before == nullptr || last.t_ns > before->t_ns) {
      count(static_cast<double>(last.t_ns - (before == nullptr ? first : *before).t_ns));
    }
  }
  measure_ends(log, loss);
  loss.blink_like = blinks_ms.size();
  loss.blink_like_median_ms = blinks_ms.empty() ? 0 : lower_quantile(blinks_ms, 0.5);
  if (!log.eyes.empty()) {
    std::array<std::size_t, 2> usable{};
    for (const BothEyes& eyes : log.eyes) {
      usable[0] += is_usable(eyes.left.validity) ? 1 : 0;
      usable[1] += is_usable(eyes.right.validity) ? 1 : 0;
    }
    const auto n = static_cast<double>(log.eyes.size());
    loss.left_share = static_cast<double>(usable[0]) / n;
    loss.right_share = static_cast<double>(usable[1]) / n;
  }
  return loss;
}

GazeFrozen measure_frozen(const GazeLog& log) {
  GazeFrozen frozen;
  std::size_t usable = 0;
  std::size_t repeated = 0;
  const auto end_run = [&](std::size_t begin, std::size_t end) {  // [begin, end)
    const std::int64_t length_ns = log.samples[end - 1].t_ns - log.samples[begin].t_ns;
    if (end - begin < kFrozenSamples || length_ns < kFrozenNs) {
      return;
    }
    ++frozen.runs;
    frozen.samples += end - begin;
    if (length_ns > frozen.longest_ns) {
      frozen.longest_ns = length_ns;
      frozen.longest_row = log.samples[begin].row;
    }
  };
  std::size_t begin = 0;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    const bool good = is_usable(sample.validity);
    usable += good ? 1 : 0;
    const bool repeats = i > 0 && good && is_usable(log.samples[i - 1].validity) &&
                         place_of(sample, log.kind) == place_of(log.samples[i - 1], log.kind);
    repeated += repeats ? 1 : 0;
    if (!repeats) {
      if (i > begin) {
        end_run(begin, i);
      }
      begin = i;
    }
  }
  end_run(begin, log.samples.size());
  frozen.repeated_share = usable > 0 ? static_cast<double>(repeated) / static_cast<double>(usable) : 0;
  return frozen;
}

std::optional<GazePrecision> measure_precision(const GazeLog& log, const GazePlane& plane, double median_step_ns) {
  const auto window = static_cast<std::size_t>(
      std::max(1.0, std::round(static_cast<double>(kVelocityWindowNs) / std::max(median_step_ns, 1e3))));
  const double threshold = kFixationDegPerS * plane.units_per_degree();
  std::vector<Vec2d> recent(window + 1);  // a ring of the last places
  std::size_t in_run = 0;                 // usable samples in a row, without gaps
  std::vector<double> rms;
  std::vector<double> sd;
  Stretch stretch;
  std::int64_t begin_ns = 0;
  std::int64_t last_ns = 0;
  const auto end_stretch = [&] {
    if (stretch.count() >= 3 && last_ns - begin_ns >= kFixationNs) {
      rms.push_back(stretch.rms_s2s());
      sd.push_back(stretch.sd());
    }
    stretch = {};
  };
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    const bool follows =
        i > 0 && static_cast<double>(sample.t_ns - log.samples[i - 1].t_ns) <= kGapInSteps * median_step_ns;
    if (!is_usable(sample.validity) || !follows) {
      end_stretch();
      in_run = 0;
    }
    if (!is_usable(sample.validity)) {
      continue;
    }
    const Vec2d at = plane.of(sample);
    recent[i % (window + 1)] = at;
    ++in_run;
    if (in_run <= window) {
      continue;
    }
    const Vec2d& from = recent[(i - window) % (window + 1)];
    const double seconds = static_cast<double>(sample.t_ns - log.samples[i - window].t_ns) * 1e-9;
    const Vec2d way{at.x - from.x, at.y - from.y};
    if (!(std::sqrt(way.x * way.x + way.y * way.y) < threshold * seconds)) {
      end_stretch();
      continue;
    }
    begin_ns = stretch.count() == 0 ? sample.t_ns : begin_ns;
    stretch.add(at);
    last_ns = sample.t_ns;
  }
  end_stretch();
  if (rms.empty()) {
    return std::nullopt;
  }
  return GazePrecision{rms.size(), lower_quantile(rms, 0.5), lower_quantile(sd, 0.5)};
}

std::optional<GazeDisparity> measure_disparity(const GazeLog& log, const GazePlane& plane) {
  constexpr std::size_t kMostPairs = 200'000;
  std::vector<double> left_x;
  std::vector<double> left_y;
  std::vector<double> right_x;
  std::vector<double> right_y;
  const std::size_t stride = std::max<std::size_t>(1, log.eyes.size() / kMostPairs);
  for (std::size_t i = 0; i < log.eyes.size(); i += stride) {
    const BothEyes& eyes = log.eyes[i];
    if (is_usable(eyes.left.validity) && is_usable(eyes.right.validity)) {
      const Vec2d left = plane.at(eyes.left.at);
      const Vec2d right = plane.at(eyes.right.at);
      left_x.push_back(left.x);
      left_y.push_back(left.y);
      right_x.push_back(right.x);
      right_y.push_back(right.y);
    }
  }
  if (left_x.size() < 3) {
    return std::nullopt;
  }
  GazeDisparity disparity;
  disparity.pairs = left_x.size();
  disparity.horizontal_correlation = correlation(left_x, right_x);
  disparity.vertical_correlation = correlation(left_y, right_y);
  for (std::size_t i = 0; i < left_x.size(); ++i) {
    left_x[i] -= right_x[i];
    left_y[i] -= right_y[i];
  }
  const auto spread = [](std::vector<double>& values) {
    const double q1 = lower_quantile(values, 0.25);
    return (lower_quantile(values, 0.75) - q1) / 1.349;
  };
  disparity.horizontal = lower_quantile(left_x, 0.5);
  disparity.vertical = lower_quantile(left_y, 0.5);
  disparity.horizontal_spread = spread(left_x);
  disparity.vertical_spread = spread(left_y);
  return disparity;
}

}  // namespace gazetrace
