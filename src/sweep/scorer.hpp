// SPDX-License-Identifier: Apache-2.0
// Scores of the frames of one row against the reference, with the gaze of the row.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// `settings` with the view and the frame rate of a plan. Without gaze there are no bands and no metrics that need it.
ComparisonSettings comparison_of(const ComparisonSettings& settings, const FramePlan& plan,
                                 const std::vector<ResultFrame>& frames, const FrameRate& fps);

// For each frame rate of the tests that are scored for flicker, which frequencies the metric can tell at that rate:
// "flicker at 24 frames a second: from 1 to 12 Hz, ...".
std::vector<std::string> flicker_ranges(const SweepPlan& plan);

class Scorer {
 public:
  // `frames` are those that will be added, in this order; they must outlive the scorer.
  Scorer(const ComparisonSettings& settings, const std::vector<ResultFrame>& frames, int width_px, int height_px);
  // Takes the light and the code values of the next frame. Returns the scores of that frame alone.
  ScoreTable add(const MetricPicture& reference, const MetricPicture& test);
  // The map of the frame that was added last; nullptr unless the settings ask for maps and the metric has one.
  [[nodiscard]] const ImageGray* map_of(const std::string& metric) const;
  [[nodiscard]] ScoreTable over_scored_frames() const;

 private:
  const std::vector<ResultFrame>& frames_;
  std::vector<bool> scored_;
  bool scores_gaze_ = false;  // whether the scored frames have gaze
  std::size_t next_ = 0;
  FrameScores last_;
  std::unique_ptr<Comparison> comparison_;
};

// Which direction is better; lower for names that no metric has.
MetricDirection direction_of(const std::string& metric);
bool is_better(const std::string& metric, double a, double b);  // whether a is better than b
// Whether the metric squares the error, so that the variance of a noisy reference is added to it.
bool is_squared_error(const std::string& metric);
// Takes the variance of the reference, a quarter of the halves' `floor`, off the mean of a squared error; the result is
// never below 0. Other metrics keep their value.
double without_reference_variance(const std::string& metric, double value, double floor);

}  // namespace gazetrace
