// SPDX-License-Identifier: Apache-2.0
// Standard errors from independent repeats: Sobol samples inside one render are not independent, seeds are.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace gazetrace::test {

struct Repeats {
  std::vector<double> means;
  [[nodiscard]] double mean() const {
    double sum = 0;
    for (const double m : means) {
      sum += m;
    }
    return sum / static_cast<double>(means.size());
  }
  [[nodiscard]] double variance_of_mean() const {
    const double center = mean();
    double sum = 0;
    for (const double m : means) {
      sum += (m - center) * (m - center);
    }
    const auto n = static_cast<double>(means.size());
    return sum / (n - 1) / n;
  }
};

// Two-sided critical value of Student's t for 31 or more degrees of freedom (Welch's count with 32 repeats a side is
// never lower) at a family-wise level of 1e-3 over at most 20 comparisons: level 5e-5 each, t = 4.7.
inline constexpr double kCriticalT = 4.7;

inline double welch_t(const Repeats& a, const Repeats& b) {
  const double spread = std::sqrt(a.variance_of_mean() + b.variance_of_mean());
  // Float sums are all that is left where two estimators are both exact.
  return (a.mean() - b.mean()) / std::max(spread, 1e-6 * std::fabs(a.mean()));
}

}  // namespace gazetrace::test
