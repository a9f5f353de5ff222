// SPDX-License-Identifier: Apache-2.0
// Ranks, quantiles, means and spreads against what can be counted by hand.
#include "core/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace gazetrace::statistics_test {
namespace {

TEST(Statistics, TheThreeRanksDifferForAnEvenCountAndAgreeForAnOddOne) {
  EXPECT_EQ(lower_rank(0.5, 4), 1U);
  EXPECT_EQ(upper_rank(0.5, 4), 2U);
  EXPECT_EQ(covering_rank(0.5, 4), 1U);
  EXPECT_EQ(lower_rank(0.5, 5), 2U);
  EXPECT_EQ(upper_rank(0.5, 5), 2U);
  EXPECT_EQ(covering_rank(0.5, 5), 2U);
  // Of 20 values 0.25 * 19 = 4.75 and 0.25 * 20 = 5; five values make up a quarter.
  EXPECT_EQ(lower_rank(0.25, 20), 4U);
  EXPECT_EQ(upper_rank(0.25, 20), 5U);
  EXPECT_EQ(covering_rank(0.25, 20), 4U);
}

TEST(Statistics, RanksStayWithinTheValues) {
  for (const std::size_t count : {1U, 2U, 3U, 10U}) {
    EXPECT_EQ(lower_rank(0, count), 0U);
    EXPECT_EQ(upper_rank(0, count), 0U);
    EXPECT_EQ(covering_rank(0, count), 0U);
    EXPECT_EQ(lower_rank(1, count), count - 1);
    EXPECT_EQ(upper_rank(1, count), count - 1);
    EXPECT_EQ(covering_rank(1, count), count - 1);
  }
}

TEST(Statistics, MediansAndQuantilesOfWhatIsNotSorted) {
  std::vector<double> even{40, 10, 30, 20};
  EXPECT_EQ(upper_median(even), 30);
  EXPECT_EQ(lower_quantile(even, 0.5), 20);
  EXPECT_EQ(lower_quantile(even, 1), 40);
  std::vector<float> odd{3, 1, 2};
  EXPECT_EQ(upper_median(odd), 2.0F);
  // The square of every number from 0 to 100: the value at rank k is k squared.
  std::vector<std::int64_t> squares;
  for (std::int64_t k = 100; k >= 0; --k) {
    squares.push_back(k * k);
  }
  EXPECT_EQ(upper_median(squares), 2500);
  EXPECT_EQ(lower_quantile(squares, 0.25), 625);
  EXPECT_EQ(value_at_rank(squares, 95), 95 * 95);
}

TEST(Statistics, OfNoValuesThereIsNoMedian) {
  std::vector<double> none;
  EXPECT_TRUE(std::isnan(upper_median(none)));
  EXPECT_TRUE(std::isnan(lower_quantile(none, 0.5)));
  EXPECT_TRUE(std::isnan(mean_of(none)));
  std::vector<std::int64_t> no_steps;
  EXPECT_EQ(upper_median(no_steps), 0);
}

TEST(Statistics, MeansAndSpreadsOfAnArithmeticSeries) {
  // 1, 2, ... n: the mean is (n + 1) / 2, the unbiased variance n (n + 1) / 12.
  constexpr int kCount = 25;
  std::vector<double> values;
  RunningSpread spread;
  for (int k = 1; k <= kCount; ++k) {
    values.push_back(k);
    spread.add(k);
  }
  const double variance = kCount * (kCount + 1.0) / 12;
  EXPECT_DOUBLE_EQ(mean_of(values), 13);
  EXPECT_DOUBLE_EQ(standard_error(values, 13), std::sqrt(variance / kCount));
  EXPECT_EQ(spread.count(), values.size());
  EXPECT_NEAR(spread.mean(), 13, 1e-14);
  EXPECT_NEAR(spread.deviation(), std::sqrt(variance), 1e-13);
}

TEST(Statistics, ARunningSpreadKeepsItsDigitsFarFromZero) {
  RunningSpread spread;
  for (const double value : {4.0, 7.0, 13.0, 16.0}) {
    spread.add(1e9 + value);
  }
  EXPECT_DOUBLE_EQ(spread.mean(), 1e9 + 10);
  EXPECT_DOUBLE_EQ(spread.deviation(), std::sqrt(30.0));  // 36 + 9 + 9 + 36 over 3
  EXPECT_EQ(RunningSpread().deviation(), 0);
  RunningSpread one;
  one.add(5);
  EXPECT_EQ(one.mean(), 5);
  EXPECT_EQ(one.deviation(), 0);
}

TEST(Statistics, Correlations) {
  const std::vector<double> up{1, 2, 3, 4};
  EXPECT_DOUBLE_EQ(correlation(up, {10, 20, 30, 40}), 1);
  EXPECT_DOUBLE_EQ(correlation(up, {4, 3, 2, 1}), -1);
  EXPECT_DOUBLE_EQ(correlation(up, {1, -1, -1, 1}), 0);
  EXPECT_EQ(correlation(up, {5, 5, 5, 5}), 0);
  EXPECT_DOUBLE_EQ(correlation({0, 0, 1}, {0, 1, 1}), 0.5);
}

TEST(Statistics, TheMeanOfAPictureIsThatOfItsPixels) {
  ImageGray image(3, 2);
  image.pixels = {1, 2, 3, 4, 5, 16777216};  // in float the sum would lose the one
  EXPECT_EQ(mean_of(image), (15.0 + 16777216.0) / 6);
  EXPECT_TRUE(std::isnan(mean_of(ImageGray())));
}

}  // namespace
}  // namespace gazetrace::statistics_test
