// SPDX-License-Identifier: Apache-2.0
// What a run says of a rate that was chosen for a stated quality.
#include "pipeline/quality/clip_rate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gazetrace::clip_rate_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ClipRate rate_of_windows() {
  ClipRate rate;
  rate.spp = 40;
  rate.looks = 4;
  rate.predicted_jod = 9;
  rate.reference_spp = 16384;
  rate.reference_share = kMostOfReference;
  return rate;
}

TEST(ClipRate, ARateThatSettledBesideAQuietReferenceLeavesNoDoubt) {
  EXPECT_THAT(rate_of_windows().doubts(), IsEmpty());
}

TEST(ClipRate, ANoisyReferenceLeavesADoubt) {
  ClipRate rate = rate_of_windows();
  rate.reference_share = 1.01 * kMostOfReference;
  EXPECT_THAT(rate.doubts(), ElementsAre(AllOf(HasSubstr("`target-jod`"), HasSubstr("16384"), HasSubstr("noisy"))));
}

TEST(ClipRate, ARateThatDidNotSettleLeavesADoubt) {
  ClipRate rate = rate_of_windows();
  rate.settled = false;
  EXPECT_THAT(rate.doubts(), ElementsAre(AllOf(HasSubstr("4 probe renders"), HasSubstr("40 samples"))));
}

TEST(ClipRate, SmallFramesWhoseLooksDifferLeaveADoubtAndWindowsOfLargeOnesDoNot) {
  ClipRate rate = rate_of_windows();
  rate.scatter_jod = 1.5 * kMostScatterJod;
  EXPECT_THAT(rate.doubts(), IsEmpty());
  EXPECT_THAT(rate.text(), HasSubstr("probe renders differ by 0.120 JOD"));
  rate.looked_at_whole = true;
  EXPECT_THAT(rate.doubts(), ElementsAre(AllOf(HasSubstr("`target-jod`"), HasSubstr("0.12 JOD"))));
  rate.scatter_jod = kMostScatterJod;
  EXPECT_THAT(rate.doubts(), IsEmpty());
}

}  // namespace
}  // namespace gazetrace::clip_rate_test
