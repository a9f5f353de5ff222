// SPDX-License-Identifier: Apache-2.0
// How much of the past is kept where it was off twice running, down to frames that do not know their own noise.
#include "temporal/residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace gazetrace {
namespace {

constexpr int kSize = 5;

struct Off {
  SurfaceMotion motion;
  ImageGray now, before, noise;

  // The past is off by as much everywhere, in both frames.
  Off(float by, float variance) : now(kSize, kSize, by), before(kSize, kSize, by), noise(kSize, kSize, variance) {
    motion.object = Image<std::uint32_t>(kSize, kSize, 1);
  }
  [[nodiscard]] double share_kept(double count, double past_count) const {
    return Residuals{now, before, noise}.share_kept(motion, count, past_count, 2, 2);
  }
};

TEST(Residuals, ALastingErrorTakesFromThePast) {
  const Off off(1, 0.01F);
  const double kept = off.share_kept(4, 40);
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, 0.1);
  EXPECT_LT(off.share_kept(4, 80), kept);  // the more of it there is, the smaller a share
}

// Noise is of the size that the variance states, and does not come back with the same sign.
TEST(Residuals, NoiseTakesNothing) {
  Off off(0.1F, 0.01F);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      off.before(x, y) *= (x + y) % 2 == 0 ? 1.0F : -1.0F;
    }
  }
  EXPECT_EQ(off.share_kept(4, 40), 1);
}

// A variance comes from two samples on; frames of fewer have none, whatever their pixels say.
TEST(Residuals, OneSampleAccusesNobody) {
  for (const float variance : {0.0F, 0.01F}) {
    const Off off(1, variance);
    for (const double count : {1.0, 0.5, 0.0}) {
      EXPECT_EQ(off.share_kept(count, 40), 1) << count << ' ' << variance;
    }
    EXPECT_LT(off.share_kept(2, 40), 1) << variance;
    EXPECT_EQ(off.share_kept(2, 0), 1) << variance;
  }
}

TEST(Residuals, OtherObjectsHaveNoSay) {
  Off off(1, 0.01F);
  off.motion.object(2, 2) = 2;
  EXPECT_EQ(off.share_kept(4, 40), 1);
}

}  // namespace
}  // namespace gazetrace
