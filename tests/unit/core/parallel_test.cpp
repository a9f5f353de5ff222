// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <vector>

namespace gazetrace {
namespace {

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double all = 0;
  double resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

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

// A sequence of a thousand frames makes some hundred thousand loops.
TEST(Parallel, ManyLoopsKeepNoMemory) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer keeps what is freed";
#endif
  const auto loops = [](int count) {
    for (int k = 0; k < count; ++k) {
      parallel_for(16, 0, [](std::size_t) {});
    }
  };
  loops(500);
  const double before = resident_mib();
  loops(4000);
  EXPECT_LT(resident_mib() - before, 4);
}

}  // namespace
}  // namespace gazetrace
