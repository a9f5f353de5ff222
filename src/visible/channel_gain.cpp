// SPDX-License-Identifier: Apache-2.0
#include "visible/channel_gain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "gazetrace/error.hpp"
#include "metrics/temporal_channels.hpp"

namespace gazetrace {
namespace {

double variance_gain(std::vector<double> weights, double correlation, std::optional<int> frames_before) {
  // The first frame stands for all before it.
  if (frames_before) {
    const std::size_t first = static_cast<std::size_t>(std::max(*frames_before, 0));
    while (weights.size() > first + 1) {
      const double oldest = weights.back();
      weights.pop_back();
      weights.back() += oldest;
    }
  }
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (std::size_t j = 0; j < weights.size(); ++j) {
      const auto apart = static_cast<double>(i > j ? i - j : j - i);
      sum += weights[i] * weights[j] * std::pow(correlation, apart);
    }
  }
  return std::max(sum, 0.0);
}

}  // namespace

ChannelGains channel_gains(double frames_per_second, double correlation, std::optional<int> frames_before) {
  if (!(correlation >= 0 && correlation <= 1)) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("a correlation of {} from frame to frame is not in 0..1", correlation));
  }
  if (frames_per_second == 0) {
    return {};
  }
  const TemporalFilters filters = temporal_filters(frames_per_second);
  const auto standing = [](const std::vector<double>& weights) {
    return std::fabs(std::accumulate(weights.begin(), weights.end(), 0.0));
  };
  return {{variance_gain(filters.sustained, correlation, frames_before),
           variance_gain(filters.transient, correlation, frames_before)},
          {standing(filters.sustained), standing(filters.transient)}};
}

}  // namespace gazetrace
