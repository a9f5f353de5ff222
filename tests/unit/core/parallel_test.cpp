// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace gazetrace::parallel_test {
namespace {

TEST(Parallel, EveryIndexOnceForAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 7}) {
    std::vector<int> seen(1000, 0);
    parallel_for(seen.size(), threads, [&](std::size_t i) { ++seen[i]; });
    EXPECT_EQ(seen, std::vector<int>(1000, 1)) << threads;
  }
}

TEST(Parallel, AnErrorInABodyComesOut) {
  EXPECT_THROW(parallel_for(100, 2,
                            [](std::size_t i) {
                              if (i == 57) {
                                throw std::runtime_error("57");
                              }
                            }),
               std::runtime_error);
}

TEST(Parallel, LoopsInsideLoopsEnd) {
  std::vector<int> sums(64, 0);
  parallel_for(sums.size(), 2, [&](std::size_t i) {
    std::vector<int> own(50, 0);
    parallel_for(own.size(), 2, [&](std::size_t j) { own[j] = static_cast<int>(j); });
    for (const int value : own) {
      sums[i] += value;
    }
  });
  EXPECT_EQ(sums, std::vector<int>(64, 49 * 25));
}

}  // namespace
}  // namespace gazetrace::parallel_test
