// SPDX-License-Identifier: Apache-2.0
// The scores of one metric over the frames of one gaze class.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/eccentricity_bands.hpp"
#include "gazetrace/compare.hpp"

namespace gazetrace {

// Functions that turn a mean into the printed number: `whole` for means over frames, `local` for means over a part of
// the picture.
struct PrintedNumbers {
  double (*whole)(const std::string& metric, double mean);
  double (*local)(const std::string& metric, double mean);
};

Scores scores_of(const std::string& metric, const PrintedNumbers& printed, double mean, const BandSums& sums);

struct ScoreSeries {
  double sum = 0;
  BandSums bands;
  std::vector<double> values;
  std::vector<std::int32_t> frames;
};

// Appends the metric's scores to the vectors of `summary`.
void summarise(const MetricInfo& info, const PrintedNumbers& printed, const ScoreSeries& series,
               SequenceScores& summary);

}  // namespace gazetrace
