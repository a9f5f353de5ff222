// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/statistics.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {
namespace {

constexpr double kConfidence = 0.95;

// P(|T| < t) for a whole number of degrees of freedom: Abramowitz and Stegun, Handbook of Mathematical Functions,
// 26.7.3 (odd) and 26.7.4 (even).
double central_probability(double t, int degrees) {
  const double theta = std::atan(t / std::sqrt(static_cast<double>(degrees)));
  const double cosine = std::cos(theta);
  const bool is_odd = degrees % 2 == 1;
  double term = is_odd ? cosine : 1.0;
  double sum = degrees == 1 ? 0.0 : term;
  for (int k = is_odd ? 3 : 2; k <= degrees - 2; k += 2) {
    term *= cosine * cosine * (k - 1) / k;
    sum += term;
  }
  return is_odd ? 2 / kPi * (theta + std::sin(theta) * sum) : std::sin(theta) * sum;
}

}  // namespace

double student_t_quantile(double probability, int degrees_of_freedom) {
  if (!(probability > 0.5 && probability < 1) || degrees_of_freedom < 1) {
    throw Error(ErrorKind::usage, "student_t_quantile",
                "needs a probability between 0.5 and 1, and a degree of freedom");
  }
  const double central = 2 * probability - 1;
  double low = 0;
  double high = 1;
  while (central_probability(high, degrees_of_freedom) < central) {
    high *= 2;
  }
  for (int step = 0; step < 200 && high - low > 1e-13 * high; ++step) {
    const double middle = (low + high) / 2;
    (central_probability(middle, degrees_of_freedom) < central ? low : high) = middle;
  }
  return (low + high) / 2;
}

Interval mean_interval(const std::vector<double>& values) {
  Interval interval;
  if (values.empty()) {
    interval.mean = std::numeric_limits<double>::quiet_NaN();
    return interval;
  }
  interval.mean = mean_of(values);
  if (values.size() > 1) {
    const double half = student_t_quantile((1 + kConfidence) / 2, static_cast<int>(values.size()) - 1) *
                        standard_error(values, interval.mean);
    interval.low = interval.mean - half;
    interval.high = interval.mean + half;
  }
  return interval;
}

Interval error_interval(const std::vector<double>& values) {
  Interval interval = mean_interval(values);
  if (!interval.low) {
    return interval;
  }
  if (!(interval.mean > 0)) {
    return {interval.mean, std::nullopt, std::nullopt};
  }
  const double factor = std::exp((*interval.high - interval.mean) / interval.mean);
  interval.low = interval.mean / factor;
  interval.high = interval.mean * factor;
  return interval;
}

Interval geometric_interval(const std::vector<double>& values) {
  std::vector<double> logarithms;
  logarithms.reserve(values.size());
  for (const double value : values) {
    logarithms.push_back(std::log(value));
  }
  Interval interval = mean_interval(logarithms);
  interval.mean = std::exp(interval.mean);
  if (interval.low) {
    interval.low = std::exp(*interval.low);
    interval.high = std::exp(*interval.high);
  }
  return interval;
}

Interval ratio_interval(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(numerator.size(), denominator.size()); ++i) {
    ratios.push_back(numerator[i] / denominator[i]);
  }
  return geometric_interval(ratios);
}

}  // namespace gazetrace
