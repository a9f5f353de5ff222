// SPDX-License-Identifier: Apache-2.0
// Sums of samples that can be taken apart: samples 0..99 of a site and samples 100..255, added in any order, are to the
// bit the sum of samples 0..255.
#pragma once

#include <cstdint>
#include <vector>

namespace gazetrace {

// Samples of each site by their number: begin up to, not including, end.
struct SampleRange {
  std::uint32_t begin = 0, end = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

// The sum of floats as two doubles, high the sum's nearest double and low the rest (Knuth, TAOCP 2, 4.2.2, theorem B:
// the error of an addition is a double, and six additions find it). Nothing is rounded, so no order matters, while the
// sum of the magnitudes is under 2^80 (1e24) times the smallest of them that is not zero: every term is a multiple of
// 2^-24 of that smallest one, and the pair holds 2^104 such steps.
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

// Of one site; members as in SparseFrame and GuideSums.
struct SiteSums {
  ExactSum red, green, blue, square_luminance;
  std::uint64_t count = 0;
};
struct SiteGuideSums {
  ExactSum albedo_red, albedo_green, albedo_blue, normal_x, normal_y, normal_z, depth_m;
  std::uint64_t hits = 0;
};

// One entry per site of the map; `guides` as long or empty.
struct SampleSums {
  std::vector<SiteSums> sites;
  std::vector<SiteGuideSums> guides;
};

}  // namespace gazetrace
