// SPDX-License-Identifier: Apache-2.0
#include "sweep/scorer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/flicker.hpp"
#include "sweep/frames.hpp"

namespace gazetrace {
namespace {

constexpr double kVarianceOfHalves = 4;  // the variance of their difference over that of their mean

ScoreParts parts_of(const Scores& scores) {
  ScoreParts parts;
  if (scores.value) {
    parts["whole"] = *scores.value;
  }
  if (scores.weighted) {
    parts["weighted"] = *scores.weighted;
  }
  for (std::size_t b = 0; b < scores.bands.size(); ++b) {
    if (scores.bands[b]) {
      parts[eccentricity_band_name(b)] = *scores.bands[b];
    }
  }
  for (std::size_t r = 0; r < scores.regions.size(); ++r) {
    if (scores.regions[r]) {
      parts[kRetinalRegionNames.at(r)] = *scores.regions[r];
    }
  }
  return parts;
}

// Comparison tells frames apart by what the eye did. Here the class only tells scored frames from the others.
GazeClass class_of(const ResultFrame& frame, bool is_scored) {
  if (is_scored) {
    return frame.gaze_px ? GazeClass::fixation : GazeClass::no_gaze;
  }
  return frame.event == "blink" ? GazeClass::blink : GazeClass::in_flight;
}

}  // namespace

ComparisonSettings comparison_of(const ComparisonSettings& settings, const FramePlan& plan,
                                 const std::vector<ResultFrame>& frames, const FrameRate& fps) {
  ComparisonSettings result = settings;
  result.frames_per_second =
      frames.size() > 1 ? static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator) : 0;
  const bool has_gaze = std::any_of(frames.begin(), frames.end(), [](const auto& f) { return f.gaze_px.has_value(); });
  if (has_gaze) {
    result.view = plan.frames.front().view;
    result.metric.pixels_per_degree = 1 / (result.view->step_x * kDegPerRad);
  } else {
    result.view.reset();
    std::erase_if(result.metrics, [](const std::string& name) {
      const std::vector<MetricInfo> known = comparison_metrics();
      return std::any_of(known.begin(), known.end(),
                         [&](const MetricInfo& info) { return info.name == name && info.needs_gaze; });
    });
  }
  return result;
}

std::vector<std::string> flicker_ranges(const SweepPlan& plan) {
  std::vector<std::string> ranges;
  for (const SweepTest& test : plan.tests) {
    const std::vector<ResultFrame> frames = sweep_frames(test.plan, test.pipeline.foveation, plan.measure.leave_out_s);
    const ComparisonSettings settings = comparison_of(plan.measure.comparison, test.plan, frames, test.pipeline.fps);
    if (std::find(settings.metrics.begin(), settings.metrics.end(), "flicker") == settings.metrics.end()) {
      continue;  // it has no gaze
    }
    const FlickerRange range = flicker_range(settings.frames_per_second, settings.photometry.peak_cd_m2 / 2);
    const std::string text =
        fmt::format("flicker at {:g} frames a second: {}", settings.frames_per_second, flicker_range_text(range));
    if (std::find(ranges.begin(), ranges.end(), text) == ranges.end()) {
      ranges.push_back(text);
    }
  }
  return ranges;
}

Scorer::Scorer(const ComparisonSettings& settings, const std::vector<ResultFrame>& frames, int width_px, int height_px)
    : frames_(frames),
      scored_(scored_frames(frames)),
      comparison_(std::make_unique<Comparison>(settings, width_px, height_px)) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    scores_gaze_ = scores_gaze_ || (scored_[i] && frames[i].gaze_px);
  }
}

ScoreTable Scorer::add(const MetricPicture& reference, const MetricPicture& test) {
  const ResultFrame& frame = frames_[next_];
  FramePair pair;
  pair.frame = frame.index;
  pair.reference = reference;
  pair.test = test;
  pair.gaze_px = frame.gaze_px;
  pair.gaze_class = class_of(frame, scored_[next_]);
  ++next_;
  ScoreTable table;
  last_ = comparison_->add(pair);
  for (const Scores& scores : last_.scores) {
    if (scores.value) {
      table[scores.metric]["whole"] = *scores.value;
    }
  }
  return table;
}

const ImageGray* Scorer::map_of(const std::string& metric) const {
  for (std::size_t m = 0; m < last_.maps.size(); ++m) {
    if (last_.scores[m].metric == metric && !last_.maps[m].empty()) {
      return &last_.maps[m];
    }
  }
  return nullptr;
}

ScoreTable Scorer::over_scored_frames() const {
  ScoreTable table;
  const std::string_view wanted = to_string(scores_gaze_ ? GazeClass::fixation : GazeClass::no_gaze);
  for (const SequenceScores& part : comparison_->summary()) {
    if (part.gaze_class == wanted) {
      for (const Scores& scores : part.scores) {
        table[scores.metric] = parts_of(scores);
      }
    }
  }
  return table;
}

MetricDirection direction_of(const std::string& metric) {
  for (const MetricInfo& info : comparison_metrics()) {
    if (info.name == metric) {
      return info.better;
    }
  }
  return MetricDirection::lower;
}

bool is_better(const std::string& metric, double a, double b) {
  return direction_of(metric) == MetricDirection::lower ? a < b : a > b;
}

bool is_squared_error(const std::string& metric) {
  return metric == "mse" || metric == "rmse" || metric == "relmse";
}

double without_reference_variance(const std::string& metric, double value, double floor) {
  if (metric == "rmse") {
    return std::sqrt(std::max(0.0, value * value - floor * floor / kVarianceOfHalves));
  }
  return is_squared_error(metric) ? std::max(0.0, value - floor / kVarianceOfHalves) : value;
}

}  // namespace gazetrace
