// SPDX-License-Identifier: Apache-2.0
// Statistics for tests: chi-square and Student-t tests whose significance level is shared by a family of comparisons.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace gazetrace::test {

inline constexpr double kFamilyLevel = 1e-3;

// The significance level of each of n comparisons with which all n together have the family's level (Sidak 1967).
inline double sidak(std::size_t n, double family = kFamilyLevel) {
  return -std::expm1(std::log1p(-family) / static_cast<double>(n));
}

// Regularised upper incomplete gamma function Q(a, x) (series below a + 1, Lentz's continued fraction above).
inline double gamma_q(double a, double x) {
  if (x <= 0) {
    return 1;
  }
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a;
    double sum = term;
    for (double k = a + 1; term > sum * 1e-16; ++k) {
      term *= x / k;
      sum += term;
    }
    return 1 - scale * sum;
  }
  double b = x + 1 - a;
  double c = 1e300;
  double d = 1 / b;
  double h = d;
  for (int i = 1; i < 100000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::fabs(d * c - 1) < 1e-15) {
      break;
    }
  }
  return scale * h;
}

struct Chi2 {
  double statistic = 0;
  int degrees = 0;
  double p_value = 1;
};

// Cells in which fewer than five events are expected are pooled, smallest first (Cochran 1954). Events in cells where
// none are possible are counted in the first pool.
inline Chi2 chi2_test(const std::vector<double>& observed, const std::vector<double>& expected) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
  Chi2 result;
  int cells = 0;
  double pooled_observed = 0;
  double pooled_expected = 0;
  const auto close = [&] {
    const double difference = pooled_observed - pooled_expected;
    result.statistic += difference * difference / pooled_expected;
    ++cells;
    pooled_observed = pooled_expected = 0;
  };
  for (const std::size_t i : order) {
    pooled_observed += observed[i];
    pooled_expected += expected[i];
    if (pooled_expected >= 5) {
      close();
    }
  }
  if (pooled_expected > 1e-9) {
    close();
  }
  result.degrees = std::max(cells - 1, 1);
  result.p_value = gamma_q(0.5 * result.degrees, 0.5 * result.statistic);
  return result;
}

// Regularised incomplete beta function by its continued fraction (DLMF 8.17.22).
inline double incomplete_beta(double a, double b, double x) {
  if (x <= 0 || x >= 1) {
    return x <= 0 ? 0 : 1;
  }
  if (x > (a + 1) / (a + b + 2)) {
    return 1 - incomplete_beta(b, a, 1 - x);
  }
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) / a;
  double c = 1;
  double d = 1 / (1 - (a + b) * x / (a + 1));
  double h = d;
  for (int m = 1; m < 10000; ++m) {
    double an = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / (1 + an * d);
    c = 1 + an / c;
    h *= d * c;
    an = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / (1 + an * d);
    c = 1 + an / c;
    h *= d * c;
    if (std::fabs(d * c - 1) < 1e-15) {
      break;
    }
  }
  return front * h;
}

struct MeanTest {
  double mean = 0;
  double standard_error = 0;
  double p_value = 1;  // probability of |mean - expected| being this large or larger
};

// Two-sided one-sample t-test on independent repeats. `allowance` is a known bound of a systematic error, besides
// noise.
inline MeanTest t_test(const std::vector<double>& repeats, double expected, double allowance = 0) {
  const auto n = static_cast<double>(repeats.size());
  MeanTest result;
  result.mean = std::accumulate(repeats.begin(), repeats.end(), 0.0) / n;
  double squares = 0;
  for (const double x : repeats) {
    squares += (x - result.mean) * (x - result.mean);
  }
  result.standard_error = std::sqrt(squares / (n - 1) / n);
  const double off = std::max(std::fabs(result.mean - expected) - allowance, 0.0);
  if (off == 0) {
    return result;
  }
  if (!(result.standard_error > 0)) {
    result.p_value = 0;
    return result;
  }
  const double t = off / result.standard_error;
  result.p_value = incomplete_beta(0.5 * (n - 1), 0.5, (n - 1) / (n - 1 + t * t));
  return result;
}

}  // namespace gazetrace::test
