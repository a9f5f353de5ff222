// SPDX-License-Identifier: Apache-2.0
// Medians, quantiles, means and spreads of lists of numbers. Every quantile here is one of the values themselves;
// nothing is interpolated between two of them. Several definitions of a quantile are in use, because results that were
// printed with one of them must keep their digits. Each has a name of its own, and for an even count they differ:
//
//   the value at a share of one half    lower rank    upper rank    covering rank
//   of 1, 2, 3, 4                       2             3             2
//   of 1, 2, 3, 4, 5                    3             3             3
//
// (Hyndman and Fan, "Sample quantiles in statistical packages", The American Statistician 50 (4), 1996, call the
// covering rank definition 1.)
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// Ranks start at 0, for the smallest of `count` values; `count` must not be 0, and `share` lies from 0 to 1.

// The whole part of share * (count - 1): ranks are spread evenly from the smallest value to the largest.
inline std::size_t lower_rank(double share, std::size_t count) {
  return static_cast<std::size_t>(share * static_cast<double>(count - 1));
}
// The whole part of share * count: that many values lie before it. At one half this is the upper median.
inline std::size_t upper_rank(double share, std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(share * static_cast<double>(count)));
}
// The smallest rank at which this share of the values is covered: the share up to and including it is at least `share`.
inline std::size_t covering_rank(double share, std::size_t count) {
  const double covered = std::ceil(share * static_cast<double>(count));
  return covered < 1 ? 0 : static_cast<std::size_t>(covered) - 1;
}

// The value that would stand at this rank if the values were sorted. The values change their order and are otherwise
// kept; there must be more of them than `rank`, and none may be NaN.
template <typename T>
T value_at_rank(std::vector<T>& values, std::size_t rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The two below also change the order of the values. Of no values they are NaN, and 0 for whole numbers.

// The middle value; of an even count the larger of the middle two. (Mean of the middle two: nowhere in use.)
template <typename T>
T upper_median(std::vector<T>& values) {
  return values.empty() ? std::numeric_limits<T>::quiet_NaN() : value_at_rank(values, values.size() / 2);
}
template <typename T>
T lower_quantile(std::vector<T>& values, double share) {
  return values.empty() ? std::numeric_limits<T>::quiet_NaN() : value_at_rank(values, lower_rank(share, values.size()));
}

// Summed in the order of the values, then divided by their number; NaN of no values.
inline double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

// The same of a picture's pixels, row after row, in double.
inline double mean_of(const ImageGray& image) {
  double sum = 0;
  for (const float value : image.pixels) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.pixels.size());
}

// The standard error of a mean of at least two independent values: the root of the unbiased estimate of their variance
// (divided by one less than their number) over their number. `mean` is that of the values.
inline double standard_error(const std::vector<double>& values, double mean) {
  double squares = 0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1) / n);
}

// Mean and standard deviation of values that come one by one and are not kept, without the loss of digits that a sum of
// squares suffers where the mean is large (Welford, "Note on a method for calculating corrected sums of squares and
// products", Technometrics 4 (3), 1962).
class RunningSpread {
 public:
  void add(double value) {
    ++count_;
    const double before = value - mean_;
    mean_ += before / static_cast<double>(count_);
    squares_ += before * (value - mean_);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double mean() const { return mean_; }  // 0 of no values
  // The sample's standard deviation, from the sum of squares over one less than their number; 0 of fewer than two.
  [[nodiscard]] double deviation() const {
    return count_ > 1 ? std::sqrt(squares_ / static_cast<double>(count_ - 1)) : 0;
  }

 private:
  std::size_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

// Pearson's coefficient of correlation of pairs; 0 where one of the two does not vary. Both lists have one length.
inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double mean_a = 0;
  double mean_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  double aa = 0;
  double bb = 0;
  double ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace gazetrace
