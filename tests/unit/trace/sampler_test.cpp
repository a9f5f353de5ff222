// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/sampler.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "support/chi2.hpp"

namespace gazetrace::sampler_test {
namespace {

using sampler_detail::reverse_bits;
using sampler_detail::scramble_reversed;
using sampler_detail::sobol_second_reversed;

// The second Sobol dimension from its direction numbers: v(1) = 1/2, v(j + 1) = v(j) ^ v(j) / 2 (polynomial x + 1).
std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t result = 0;
  std::uint32_t direction = 0x80000000U;
  for (; index != 0; index >>= 1U) {
    result ^= (index & 1U) != 0 ? direction : 0;
    direction ^= direction >> 1U;
  }
  return result;
}

TEST(Sobol, ButterflyEqualsDirectionNumbers) {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const std::uint32_t index = i < 50000 ? i : hash32(i);
    ASSERT_EQ(reverse_bits(sobol_second_reversed(index)), sobol_second(index)) << index;
  }
}

// Every elementary interval of area 2^-m holds one of 2^m points.
template <class Point>
void expect_net(unsigned m, const Point& point) {
  const std::uint32_t count = 1U << m;
  for (unsigned a = 0; a <= m; ++a) {
    std::vector<int> hits(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec2f p = point(i);
      const auto x = static_cast<std::uint32_t>(p.x * static_cast<float>(1U << a));
      const auto y = static_cast<std::uint32_t>(p.y * static_cast<float>(1U << (m - a)));
      ++hits[(y << a) | x];
    }
    for (const int h : hits) {
      ASSERT_EQ(h, 1) << "2^" << a << " columns of 2^" << m << " cells";
    }
  }
}

TEST(Sobol, UnscrambledPointsAreNets) {
  expect_net(8, [](std::uint32_t i) {
    return Vec2f{sampler_detail::to_unit_float(reverse_bits(i)), sampler_detail::to_unit_float(sobol_second(i))};
  });
}

TEST(Sampler, EveryAlignedBlockIsANet) {
  for (std::uint64_t place = 0; place < 20; ++place) {
    const SampleKey key = make_sample_key(3, 1, place);
    for (const std::uint32_t dimension : {0U, dimension_of(0, BounceDimension::bsdf_uv), 1000U}) {
      for (const unsigned m : {2U, 5U, 8U}) {
        for (const std::uint32_t block : {0U, 1U, 7U, 12345U}) {
          expect_net(m, [&](std::uint32_t i) { return sample_2d(key, (block << m) + i, dimension); });
        }
      }
    }
  }
}

// Nested: bits change only by what stands above them, so that equal prefixes stay equal and different ones different.
TEST(Sampler, ScrambleIsNestedAndInvertible) {
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const std::uint32_t seed = hash32(i);
    const std::uint32_t a = hash32(i + 77777);
    const unsigned shared = i % 32;
    const std::uint32_t low = shared == 31 ? 0 : hash32(i + 5) & ((1U << (31 - shared)) - 1);
    const std::uint32_t b = a ^ (1U << (31 - shared)) ^ low;  // agree in exactly `shared` upper bits
    const auto scramble = [seed](std::uint32_t x) { return reverse_bits(scramble_reversed(reverse_bits(x), seed)); };
    ASSERT_EQ(static_cast<unsigned>(__builtin_clz(scramble(a) ^ scramble(b))), shared);
  }
}

TEST(Sampler, StaysBelowOne) {
  EXPECT_LT(sampler_detail::to_unit_float(0xffffffffU), 1.0F);
  EXPECT_EQ(sampler_detail::to_unit_float(0), 0.0F);
}

TEST(Sampler, OneDimensionIsTheFirstOfTwo) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const SampleKey key = make_sample_key(i, 2, 3);
    EXPECT_EQ(sample_1d(key, i, 5), sample_2d(key, i, 5).x);
  }
}

TEST(Sampler, DependsOnEachCoordinate) {
  std::set<float> seen;
  for (std::uint64_t seed : {1U, 2U}) {
    for (std::int32_t frame : {0, 1}) {
      for (std::uint64_t place : {0U, 1U}) {
        for (std::uint32_t sample : {0U, 1U}) {
          for (std::uint32_t dimension : {0U, 1U}) {
            seen.insert(sample_1d(make_sample_key(seed, frame, place), sample, dimension));
          }
        }
      }
    }
  }
  EXPECT_EQ(seen.size(), 32U);
}

// One sample of many places is uniform, jointly over any two coordinates; so are pairs made of two dimensions, two
// samples, two neighbouring places, two frames.
TEST(Sampler, IsUniformAndIndependentAcrossKeys) {
  constexpr std::uint32_t kPlaces = 100000;
  constexpr int kSide = 20;
  struct Pair {
    const char* name;
    std::array<float, 2> (*draw)(std::uint32_t);
  };
  const std::vector<Pair> pairs{
      {"x and y",
       [](std::uint32_t i) {
         const Vec2f p = sample_2d(make_sample_key(1, 0, i), 3, 0);
         return std::array{p.x, p.y};
       }},
      {"two dimensions",
       [](std::uint32_t i) {
         const SampleKey key = make_sample_key(1, 0, i);
         return std::array{sample_1d(key, 0, 8), sample_1d(key, 0, 9)};
       }},
      {"two dimensions' second coordinates",
       [](std::uint32_t i) {
         const SampleKey key = make_sample_key(1, 0, i);
         return std::array{sample_2d(key, 5, 9).y, sample_2d(key, 5, 17).y};
       }},
      {"two places",
       [](std::uint32_t i) {
         return std::array{sample_1d(make_sample_key(1, 0, i), 0, 0), sample_1d(make_sample_key(1, 0, i + 1), 0, 0)};
       }},
      {"two frames",
       [](std::uint32_t i) {
         return std::array{sample_1d(make_sample_key(1, 4, i), 0, 0), sample_1d(make_sample_key(1, 5, i), 0, 0)};
       }},
      {"two seeds",
       [](std::uint32_t i) {
         return std::array{sample_1d(make_sample_key(8, 4, i), 9, 0), sample_1d(make_sample_key(9, 4, i), 9, 0)};
       }},
      {"samples of one place, two dimensions",
       [](std::uint32_t i) {
         const SampleKey key = make_sample_key(2, 0, i / 16);
         return std::array{sample_1d(key, i % 16, 10), sample_2d(key, i % 16, 11).y};
       }},
  };
  for (const Pair& pair : pairs) {
    std::vector<double> observed(kSide * kSide);
    for (std::uint32_t i = 0; i < kPlaces; ++i) {
      const auto [x, y] = pair.draw(i);
      ASSERT_TRUE(x >= 0 && x < 1 && y >= 0 && y < 1);
      observed[static_cast<std::size_t>(static_cast<int>(y * kSide) * kSide + static_cast<int>(x * kSide))] += 1;
    }
    const std::vector<double> expected(observed.size(), kPlaces / static_cast<double>(observed.size()));
    EXPECT_GT(test::chi2_test(observed, expected).p_value, test::sidak(pairs.size())) << pair.name;
  }
}

// What the stratification is for: 64 samples of a smooth integrand, over many places, against plain random numbers.
TEST(Sampler, IntegratesSmoothFunctionsFarBetterThanRandomNumbers) {
  constexpr std::uint32_t kSamples = 64;
  const double exact = (std::exp(1.0) - 1) * (1 - std::cos(1.0));
  double squares = 0;
  constexpr int kPlaces = 500;
  for (std::uint32_t place = 0; place < kPlaces; ++place) {
    double sum = 0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const Vec2f p = sample_2d(make_sample_key(5, 0, place), i, 3);
      sum += std::exp(static_cast<double>(p.x)) * std::sin(static_cast<double>(p.y));
    }
    squares += std::pow(sum / kSamples - exact, 2);
  }
  const double second = 0.5 * (std::exp(2.0) - 1) * (0.5 - 0.25 * std::sin(2.0));
  const double random_variance = (second - exact * exact) / kSamples;
  EXPECT_LT(squares / kPlaces, random_variance / 100);
}

// Two dimensions of one place's samples must not share their order. The mean of a product of both has nearly the
// variance of independent numbers: shuffling by Owen's scramble keeps samples 2k and 2k + 1 in opposite halves of each
// dimension, which costs at most a factor of two. Without the shuffles it is tens of times larger.
TEST(Sampler, PairsOfDimensionsAreShuffledApart) {
  constexpr std::uint32_t kSamples = 64;
  constexpr int kPlaces = 2000;
  for (const std::uint32_t other : {1U, 8U, 9U, 24U}) {
    double squares = 0;
    for (std::uint32_t place = 0; place < kPlaces; ++place) {
      const SampleKey key = make_sample_key(6, 0, place);
      double first = 0;
      double second = 0;
      for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Vec2f p = sample_2d(key, i, 0);
        const Vec2f q = sample_2d(key, i, other);
        first += (static_cast<double>(p.x) - 0.5) * (static_cast<double>(q.x) - 0.5);
        second += (static_cast<double>(p.y) - 0.5) * (static_cast<double>(q.y) - 0.5);
      }
      squares += 0.5 * (std::pow(first / kSamples, 2) + std::pow(second / kSamples, 2));
    }
    EXPECT_LT(squares / kPlaces, 2.0 / 144 / kSamples) << other;
  }
}

}  // namespace
}  // namespace gazetrace::sampler_test
