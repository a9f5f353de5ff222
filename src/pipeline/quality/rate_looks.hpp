// SPDX-License-Identifier: Apache-2.0
// What looks at a sequence, each at some rate, say of other rates: Q (fovvideovdp_jod()) is taken to be a power of the
// rate, and what single looks say differs by chance.
#pragma once

#include <vector>

namespace gazetrace {

// The natural logarithms of a rate, in samples a pixel, and of the Q that was seen at it.
struct RateLook {
  double rate = 0, seen = 0;
};

class RateLooks {
 public:
  void add(const RateLook& look) { looks_.push_back(look); }
  // How many looks are so near to a rate that they tell of it, within a factor of 1.6.
  [[nodiscard]] int near(double rate) const;
  // The Q at a rate, by all looks near the last one, each carried to the rate along the slope.
  [[nodiscard]] double seen_at(double rate) const;
  // The rate at which so much is seen.
  [[nodiscard]] double rate_of(double seen) const;
  // Of what one look near the last one says; 0 where there are no others.
  [[nodiscard]] double standard_deviation() const;
  // Of seen_at(); infinite for a single look.
  [[nodiscard]] double standard_error() const;

 private:
  [[nodiscard]] const RateLook& last() const { return looks_.back(); }
  // Of Q over the rate: least squares, where the looks lie apart.
  [[nodiscard]] double slope() const;

  std::vector<RateLook> looks_;
};

}  // namespace gazetrace
