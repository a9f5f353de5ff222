// SPDX-License-Identifier: Apache-2.0
// Pixels that an edge may cross, as guides of one ray a pixel tell: those that differ from one of their four
// neighbours, or leave the plane of two of them (Guides::edge_rays).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/guides.hpp"
#include "trace/guides/guide_rays.hpp"

namespace gazetrace {

inline constexpr float kEdgeNormal = 0.906F;  // cosine of 25 degrees

// Row after row from `first_row` on, to the last one at most. Guides and normals, of the same size, must outlive it.
class CrossedPixels {
 public:
  CrossedPixels(const Guides& guides, const Image<RoughNormal>& smooth, int first_row);

  // Of each pixel of the row: not 0 where an edge may cross it. Valid until the next call.
  const std::vector<std::uint8_t>& next_row();

 private:
  void compare_with_next(std::size_t y, std::vector<std::uint8_t>& parted) const;
  void find_linear_of(std::size_t y);

  const Guides& guides_;
  const RoughNormal* smooth_;
  std::size_t width_, height_;
  std::size_t row_;                          // the next one
  std::vector<std::uint8_t> above_, below_;  // where it sees other things than the row above, the row below
  std::vector<std::uint8_t> beside_;         // and than the pixel to the right; the last one stays 0
  std::vector<std::uint8_t> crossed_;
  std::array<std::vector<float>, 3> linear_;  // of the rows about it, each at its number modulo 3: find_linear
};

}  // namespace gazetrace
