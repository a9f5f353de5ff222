// SPDX-License-Identifier: Apache-2.0
// What looks at several rates say of others.
#include "pipeline/quality/rate_looks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

namespace gazetrace::rate_looks_test {
namespace {

RateLooks of(std::initializer_list<RateLook> list) {
  RateLooks looks;
  for (const RateLook& look : list) {
    looks.add(look);
  }
  return looks;
}

TEST(RateLooks, LooksThatLieApartTellTheSlope) {
  // seen = 2 - rate / 2, on the line.
  const RateLooks looks = of({{0, 2}, {2, 1}, {4, 0}});
  EXPECT_NEAR(looks.seen_at(3), 0.5, 1e-12);
  EXPECT_NEAR(looks.rate_of(1.5), 1, 1e-12);
}

TEST(RateLooks, OneLookIsCarriedAlongTheTypicalSlope) {
  const RateLooks looks = of({{1, 2}});
  EXPECT_NEAR(looks.seen_at(2), 1.4, 1e-12);
  EXPECT_NEAR(looks.rate_of(1.4), 2, 1e-12);
}

TEST(RateLooks, ChanceMakesNoSlopeThatErrorsCannotHave) {
  EXPECT_NEAR(of({{0, 2}, {2, 2.5}}).seen_at(3), 2.5 - 0.2, 1e-12);  // more samples, more error
  EXPECT_NEAR(of({{0, 2}, {2, -8}}).seen_at(3), -8 - 1.2, 1e-12);
}

TEST(RateLooks, LooksNearTheLastOneAreAveragedAndOthersAreNot) {
  // Three at one rate, and one far away that would tell otherwise. The slope through all is -2 / 4.
  const RateLooks looks = of({{4, 0.2}, {0, 2}, {0, 2.3}, {0, 2.3}});
  EXPECT_NEAR(looks.seen_at(0), 2.2, 1e-12);
  EXPECT_EQ(looks.near(0), 3);
  EXPECT_EQ(looks.near(4), 1);
  EXPECT_EQ(looks.near(std::log(1.5)), 3);
  EXPECT_EQ(looks.near(std::log(1.7)), 0);
}

TEST(RateLooks, HowLooksDifferTellsHowWellTheirMeanIsKnown) {
  // The mean is 2, and the sum of squares 0.02, over 3 - 1.
  const RateLooks looks = of({{0, 1.9}, {0, 2}, {0, 2.1}});
  EXPECT_NEAR(looks.standard_deviation(), 0.1, 1e-12);
  EXPECT_NEAR(looks.standard_error(), 0.1 / std::sqrt(3), 1e-12);
  // At other rates it is what is left beside the slope.
  const double near = std::log(1.2);
  EXPECT_NEAR(of({{0, 2}, {near, 2 - 0.6 * near}}).standard_deviation(), 0, 1e-12);
}

TEST(RateLooks, ASingleLookDoesNotTellHowLooksDiffer) {
  EXPECT_EQ(of({{0, 2}, {3, 1}}).standard_deviation(), 0);
  EXPECT_EQ(of({{0, 2}, {3, 1}}).standard_error(), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace gazetrace::rate_looks_test
