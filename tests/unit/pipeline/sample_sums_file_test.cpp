// SPDX-License-Identifier: Apache-2.0
// Sums of samples in files: what is written comes back, and sums that contradict themselves are refused.
#include <gtest/gtest.h>

#include <cstddef>

#include "gazetrace/error.hpp"
#include "gazetrace/sample_parts.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

SampleSums sums_of(std::size_t sites, std::size_t guides) {
  SampleSums sums;
  sums.sites.resize(sites);
  sums.guides.resize(guides);
  for (std::size_t i = 0; i < sites; ++i) {
    sums.sites[i].count = i + 1;
  }
  for (std::size_t i = 0; i < guides; ++i) {
    sums.guides[i].hits = 10 * i;
  }
  return sums;
}

TEST(SampleSumsFile, SumsComeBackWithAndWithoutGuides) {
  const TemporaryFolder folder;
  for (const std::size_t guides : {0, 3}) {
    save_samples(folder / "part.samples", sums_of(3, guides), "digest");
    const SampleSums read = load_samples(folder / "part.samples", "digest");
    ASSERT_EQ(read.sites.size(), 3U);
    ASSERT_EQ(read.guides.size(), guides);
    EXPECT_EQ(read.sites[2].count, 3U);
    if (guides > 0) {
      EXPECT_EQ(read.guides[2].hits, 20U);
    }
  }
}

// A file can be whole, with the right seal, and hold guides of another number of sites.
TEST(SampleSumsFile, GuidesOfOtherSitesAreRefused) {
  const TemporaryFolder folder;
  for (const std::size_t guides : {2, 4}) {
    save_samples(folder / "part.samples", sums_of(3, guides), "digest");
    try {
      (void)load_samples(folder / "part.samples", "digest");
      ADD_FAILURE() << "3 sites with guides of " << guides << " were read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

}  // namespace
}  // namespace gazetrace
