// SPDX-License-Identifier: Apache-2.0
// Sums of floats against whole numbers of 128 bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "gazetrace/sample_sums.hpp"

namespace gazetrace {
namespace {

__extension__ typedef __int128 Whole;

constexpr int kUnit = -60;  // terms are multiples of 2^kUnit

// Of either sign, 2^-37 to 2^20 in magnitude: 81 bits with 24 each.
std::vector<float> terms(std::uint32_t seed, std::size_t count) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> exponent(-37, 20);
  std::uniform_int_distribution<int> mantissa(1 << 23, (1 << 24) - 1);
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) {
    const float sign = random() % 4 == 0 ? -1.0F : 1.0F;
    values.push_back(sign * std::ldexp(static_cast<float>(mantissa(random)), exponent(random) - 23));
  }
  return values;
}

Whole whole(double value) {
  return static_cast<Whole>(std::ldexp(value, -kUnit));
}

TEST(ExactSum, IsTheSumOfWholeNumbers) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    ExactSum sum;
    Whole expected = 0;
    for (const float term : terms(seed, 1000)) {
      sum.add(static_cast<double>(term));
      expected += whole(static_cast<double>(term));
    }
    EXPECT_TRUE(whole(sum.high) + whole(sum.low) == expected) << seed;
    // The high part is the nearest double of the whole: no smaller step brings it closer.
    EXPECT_LE(std::fabs(sum.low), 0.5 * (std::nextafter(std::fabs(sum.high), INFINITY) - std::fabs(sum.high))) << seed;
  }
}

TEST(ExactSum, NoOrderAndNoSplitMatters) {
  std::mt19937 random(7);
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    std::vector<float> values = terms(seed, 300);
    ExactSum whole_sum;
    for (const float value : values) {
      whole_sum.add(static_cast<double>(value));
    }
    std::shuffle(values.begin(), values.end(), random);
    ExactSum parts[3];
    for (std::size_t i = 0; i < values.size(); ++i) {
      parts[i % 3].add(static_cast<double>(values[i]));
    }
    ExactSum joined = parts[2];
    joined.add(parts[0]);
    joined.add(parts[1]);
    EXPECT_EQ(joined, whole_sum) << seed;
  }
}

TEST(ExactSum, WhatCancelsLeavesTheRest) {
  ExactSum sum;
  sum.add(0x1p70);
  sum.add(0x1p-9);
  sum.add(-0x1p70);
  EXPECT_EQ(sum, (ExactSum{0x1p-9, 0}));
}

}  // namespace
}  // namespace gazetrace
