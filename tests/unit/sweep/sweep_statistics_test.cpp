// SPDX-License-Identifier: Apache-2.0
// Intervals against the printed table of Student's t, fronts and crossings against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/sweep.hpp"
#include "sweep/measure.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace::sweep_statistics_test {
namespace {

constexpr auto kLower = MetricDirection::lower;
constexpr auto kHigher = MetricDirection::higher;

// NIST/SEMATECH e-Handbook of Statistical Methods, table 1.3.6.7.2.
TEST(SweepStatistics, QuantilesOfStudentsTAreThoseOfTheTable) {
  const std::vector<std::pair<int, double>> at_0975{{1, 12.706}, {2, 4.303},  {3, 3.182},  {4, 2.776},  {5, 2.571},
                                                    {9, 2.262},  {10, 2.228}, {30, 2.042}, {60, 2.000}, {100, 1.984}};
  for (const auto& [degrees, t] : at_0975) {
    EXPECT_NEAR(student_t_quantile(0.975, degrees), t, 5e-4) << degrees;
  }
  EXPECT_NEAR(student_t_quantile(0.95, 5), 2.015, 5e-4);
  EXPECT_NEAR(student_t_quantile(0.999, 4), 7.173, 5e-4);
  EXPECT_THROW(student_t_quantile(0.5, 3), Error);
  EXPECT_THROW(student_t_quantile(0.9, 0), Error);
}

TEST(SweepStatistics, AnIntervalByHand) {
  // Mean 2, standard deviation 1, t of two degrees of freedom 4.302653.
  const Interval interval = mean_interval({1, 2, 3});
  EXPECT_DOUBLE_EQ(interval.mean, 2);
  EXPECT_NEAR(*interval.low, 2 - 4.302653 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(*interval.high, 2 + 4.302653 / std::sqrt(3.0), 1e-6);
  const Interval one = mean_interval({5});
  EXPECT_EQ(one.mean, 5);
  EXPECT_FALSE(one.low.has_value());
  EXPECT_TRUE(std::isnan(mean_interval({}).mean));
}

// log2 of 1, 2 and 4 has the mean 1 and the standard deviation 1: t(0.975, 2) = 4.30265 over the root of 3.
TEST(SweepStatistics, IntervalsOfTimesStayAboveZero) {
  const Interval interval = geometric_interval({1, 2, 4});
  EXPECT_NEAR(interval.mean, 2, 1e-12);
  EXPECT_NEAR(*interval.low, 2 / std::exp2(4.302652730 / std::sqrt(3.0)), 1e-6);
  EXPECT_NEAR(*interval.high, 2 * std::exp2(4.302652730 / std::sqrt(3.0)), 1e-6);
  const Interval two = geometric_interval({1, 1.5});
  EXPECT_GT(*two.low, 0);
  EXPECT_LT(*mean_interval({1, 1.5}).low, 0);
}

// Mean 2 and standard error 1: the logarithm of the mean has the standard error 1 / 2.
TEST(SweepStatistics, IntervalsOfErrorsStayAboveZero) {
  const Interval interval = error_interval({1, 3});
  EXPECT_DOUBLE_EQ(interval.mean, 2);
  EXPECT_NEAR(std::log(*interval.high / 2), 12.7062047 / 2, 1e-6);
  EXPECT_NEAR(*interval.low * *interval.high, 4, 1e-9);
  EXPECT_LT(*mean_interval({1, 3}).low, 0);
  EXPECT_FALSE(error_interval({-1, 0.5}).low.has_value());
  EXPECT_FALSE(error_interval({5}).low.has_value());
}

TEST(SweepStatistics, ARatioIsTakenPairByPair) {
  // Machine speed drifts by a factor of four, the ratio does not.
  const Interval interval = ratio_interval({8, 16, 32}, {2, 4, 8});
  EXPECT_NEAR(interval.mean, 4, 1e-12);
  EXPECT_NEAR(*interval.low, 4, 1e-12);
  EXPECT_NEAR(*interval.high, 4, 1e-12);
  EXPECT_NEAR(ratio_interval({1, 4}, {1, 1}).mean, 2, 1e-12);
}

TEST(SweepCurves, TheFrontHoldsWhatNothingBeats) {
  const std::vector<QualityAtTime> points{{4, 0.2}, {1, 0.9}, {2, 0.5}, {3, 0.6}, {2, 0.4}, {5, 0.2}, {1, 0.9}};
  EXPECT_EQ(pareto_front(points, kLower), (std::vector<std::size_t>{1, 4, 0}));
  EXPECT_EQ(pareto_front({{1, 9}, {2, 8}, {3, 9.5}}, kHigher), (std::vector<std::size_t>{0, 2}));
  const double nan = std::nan("");
  EXPECT_EQ(pareto_front({{1, nan}, {2, 0.1}, {nan, 0}}, kLower), (std::vector<std::size_t>{1}));
  EXPECT_TRUE(pareto_front({}, kLower).empty());
}

TEST(SweepCurves, FixedQualityOfExponentialCurves) {
  // quality = a - log2(t): at every level times differ by 2^(a_u - a_f), and log t is linear in quality.
  std::vector<QualityAtTime> uniform;
  std::vector<QualityAtTime> foveated;
  for (const double t : {1.0, 4.0, 16.0, 64.0}) {
    uniform.push_back({t, 10 - std::log2(t)});
    foveated.push_back({t, 7 - std::log2(t)});
  }
  for (const double level : {4.0, 5.3, 6.9}) {
    const FixedQuality result = speed_up_at_quality(uniform, foveated, kLower, level);
    ASSERT_TRUE(result.speed_up.has_value()) << level;
    EXPECT_NEAR(*result.speed_up, 8, 1e-9) << level;
    EXPECT_EQ(result.bound, "");
  }
}

TEST(SweepCurves, NothingIsExtrapolated) {
  const std::vector<QualityAtTime> uniform{{1, 7}, {8, 8.5}};
  const std::vector<QualityAtTime> foveated{{1, 8}, {4, 9.5}};
  // Uniform never gets to 9: it would take more than 8 s. Foveated: 1 s * 4^(2/3).
  const FixedQuality more = speed_up_at_quality(uniform, foveated, kHigher, 9);
  EXPECT_EQ(more.bound, ">");
  EXPECT_NEAR(*more.speed_up, 8 / std::pow(4.0, 2.0 / 3), 1e-9);
  const FixedQuality less = speed_up_at_quality(foveated, uniform, kHigher, 9);
  EXPECT_EQ(less.bound, "<");
  // Foveated is better than 7.5 from its first point on.
  EXPECT_EQ(speed_up_at_quality(uniform, foveated, kHigher, 7.5).bound, ">");
  const FixedQuality neither = speed_up_at_quality(uniform, foveated, kHigher, 9.9);
  EXPECT_FALSE(neither.speed_up.has_value());
  EXPECT_NE(neither.why.find("does not reach"), std::string::npos);
  EXPECT_FALSE(speed_up_at_quality({}, foveated, kHigher, 9).speed_up.has_value());
}

TEST(SweepMeasure, TheRateOfEqualTimeIsFoundByMeasuring) {
  // A fixed cost and a cost per sample; the first guess from two known rates is then exact.
  int tries = 0;
  const auto linear = [&](double spp) {
    ++tries;
    return 0.5 + 0.25 * spp;
  };
  const RateSearch exact = find_rate(1.5, {{1, 0.75}, {32, 8.5}}, 1.0 / 64, 128, linear);
  EXPECT_NEAR(exact.spp, 4, 1e-9);
  EXPECT_EQ(tries, 1);
  // Without anything known, and not a straight line.
  const RateSearch found = find_rate(3, {}, 1.0 / 64, 128, [](double spp) { return std::pow(spp, 0.8); });
  EXPECT_NEAR(std::pow(found.spp, 0.8) / 3, 1, kRateTolerance);
  // Faster than the least rate: the bound, once.
  const RateSearch bound = find_rate(0.01, {}, 0.25, 128, linear);
  EXPECT_EQ(bound.spp, 0.25);
  EXPECT_EQ(bound.tried.size(), 2U);
}

TEST(SweepMeasure, TheReferencesVarianceIsAQuarterOfTheHalvesDifference) {
  EXPECT_DOUBLE_EQ(without_reference_variance("mse", 5, 8), 3);
  EXPECT_DOUBLE_EQ(without_reference_variance("rmse", 5, 8), 3);  // 25 - 64 / 4
  EXPECT_DOUBLE_EQ(without_reference_variance("relmse", 1, 8), 0);
  EXPECT_DOUBLE_EQ(without_reference_variance("flip", 5, 8), 5);
}

}  // namespace
}  // namespace gazetrace::sweep_statistics_test
