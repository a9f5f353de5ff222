// SPDX-License-Identifier: Apache-2.0
#include "compare/score_series.hpp"

#include <algorithm>

#include "core/nan.hpp"
#include "core/statistics.hpp"

namespace gazetrace {
namespace {

bool is_worse(const MetricInfo& info, double a, double b) {
  return info.better == MetricDirection::lower ? a > b : a < b;
}

}  // namespace

Scores scores_of(const std::string& metric, const PrintedNumbers& printed, double mean, const BandSums& sums) {
  Scores scores;
  scores.metric = metric;
  scores.value = printed.whole(metric, mean);
  if (sums.weight > 0) {
    scores.weighted = printed.local(metric, sums.weighted_sum / sums.weight);
  }
  const auto fill = [&](const auto& parts, auto& out) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].pixels > 0) {
        out[i] = printed.local(metric, parts[i].sum / parts[i].pixels);
      }
    }
  };
  fill(sums.bands, scores.bands);
  fill(sums.regions, scores.regions);
  return scores;
}

void summarise(const MetricInfo& info, const PrintedNumbers& printed, const ScoreSeries& series,
               SequenceScores& summary) {
  summary.scored_frames.push_back(series.values.size());
  if (series.values.empty()) {
    summary.scores.emplace_back().metric = info.name;
    summary.quantiles.push_back({kNan, kNan, kNan});
    summary.worst_frame.emplace_back();
    return;
  }
  const auto count = static_cast<double>(series.values.size());
  summary.scores.push_back(scores_of(info.name, printed, series.sum / count, series.bands));
  std::vector<double> sorted = series.values;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) { return sorted[upper_rank(share, sorted.size())]; };
  summary.quantiles.push_back({at(0.05), at(0.5), at(0.95)});
  std::size_t worst = 0;
  for (std::size_t i = 1; i < series.values.size(); ++i) {
    worst = is_worse(info, series.values[i], series.values[worst]) ? i : worst;
  }
  summary.worst_frame.emplace_back(series.frames[worst]);
}

}  // namespace gazetrace
