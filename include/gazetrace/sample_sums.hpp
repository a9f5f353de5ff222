// SPDX-License-Identifier: Apache-2.0
// Exact sums of samples, so that parts can be traced apart and joined: the sums of samples 0..99 and 100..255 of a
// site, added in any order, equal the sum of samples 0..255 bit for bit.
#pragma once

#include <cstdint>
#include <vector>

namespace gazetrace {

// The samples of each site whose number is in [begin, end).
struct SampleRange {
  std::uint32_t begin = 0, end = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// The sum of floats as two doubles: `high` is the double nearest to the sum, and `low` the rest (Knuth, TAOCP 2, 4.2.2,
// theorem B: the error of an addition is a double, and six additions find it). As long as the sum of the magnitudes is
// below 2^80 (1e24) times the smallest magnitude that is not zero, nothing is rounded and the order does not matter:
// every term is a multiple of 2^-24 of that smallest one, and the pair holds 2^104 such steps.
struct ExactSum {
  double high = 0, low = 0;

  void add(double term) {
    const double sum = high + term;
    const double back = sum - high;
    low += (high - (sum - back)) + (term - back);
    high = sum + low;
    low -= high - sum;
  }
  void add(const ExactSum& other) {
    add(other.high);
    add(other.low);
  }
  [[nodiscard]] float value() const { return static_cast<float>(high); }
  friend bool operator==(const ExactSum&, const ExactSum&) = default;
};

// The sums of one site; members as in SparseFrame and GuideSums.
struct SiteSums {
  ExactSum red, green, blue, square_luminance;
  std::uint64_t count = 0;
};
struct SiteGuideSums {
  ExactSum albedo_red, albedo_green, albedo_blue, normal_x, normal_y, normal_z, depth_m;
  std::uint64_t hits = 0;
};

// One entry per site of the map; `guides` is as long, or empty.
struct SampleSums {
  std::vector<SiteSums> sites;
  std::vector<SiteGuideSums> guides;
};

}  // namespace gazetrace
