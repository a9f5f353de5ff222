// SPDX-License-Identifier: Apache-2.0
// The scores of one row's frames against the reference, with the row's gaze.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// `settings` with the view and rate of a plan; without gaze there are no bands and no FovVideoVDP.
ComparisonSettings comparison_of(const ComparisonSettings& settings, const FramePlan& plan,
                                 const std::vector<ResultFrame>& frames, const FrameRate& fps);

// What each frame rate of the tests that are scored for flicker lets it tell, and what not: "flicker at 24 frames a
// second: from 1 to 12 Hz, ...".
std::vector<std::string> flicker_ranges(const SweepPlan& plan);

class Scorer {
 public:
  // `frames` are those that will be added, in their order.
  Scorer(const ComparisonSettings& settings, const std::vector<ResultFrame>& frames, int width_px, int height_px);
  // Light and code values of both pictures. Returns the frame's own scores.
  ScoreTable add(const MetricPicture& reference, const MetricPicture& test);
  // Of the frame added last; nullptr unless the settings want maps and the metric has one.
  [[nodiscard]] const ImageGray* map_of(const std::string& metric) const;
  [[nodiscard]] ScoreTable over_scored_frames() const;

 private:
  const std::vector<ResultFrame>& frames_;
  std::vector<bool> scored_;
  bool scores_gaze_ = false;  // the scored frames have gaze
  std::size_t next_ = 0;
  FrameScores last_;
  std::unique_ptr<Comparison> comparison_;
};

// Of any metric that can be scored; unknown ones: lower.
MetricDirection direction_of(const std::string& metric);
bool is_better(const std::string& metric, double a, double b);  // a than b
// A metric that squares the error, so that a noisy reference adds its variance.
bool is_squared_error(const std::string& metric);
// A squared error's mean with the reference's variance, a quarter of the halves' `floor`, taken off; never below 0.
// Other metrics: as they are.
double without_reference_variance(const std::string& metric, double value, double floor);

}  // namespace gazetrace
