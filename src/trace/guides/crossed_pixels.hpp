// SPDX-License-Identifier: Apache-2.0
// Finds the pixels that an edge may cross, from guides with one ray per pixel: those that differ from one of their four
// neighbours, or are off the plane of two opposite ones (Guides::edge_rays).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/guides.hpp"
#include "trace/guides/guide_rays.hpp"

namespace gazetrace {

inline constexpr float kEdgeNormal = 0.906F;  // cosine of 25 degrees

// Goes through the rows from `first_row` on. Guides and normals have the same size and must outlive it.
class CrossedPixels {
 public:
  CrossedPixels(const Guides& guides, const Image<RoughNormal>& smooth, int first_row);

  // For each pixel of the next row, not 0 where an edge may cross it. Valid until the next call.
  const std::vector<std::uint8_t>& next_row();

 private:
  void compare_with_next(std::size_t y, std::vector<std::uint8_t>& parted) const;
  void find_linear_of(std::size_t y);

  const Guides& guides_;
  const RoughNormal* smooth_;
  std::size_t width_, height_;
  std::size_t row_;                          // the next row
  std::vector<std::uint8_t> above_, below_;  // where the row sees something else than the rows above and below it
  std::vector<std::uint8_t> beside_;         // where a pixel sees something else than the next one; the last stays 0
  std::vector<std::uint8_t> crossed_;
  std::array<std::vector<float>, 3> linear_;  // results of find_linear for three rows, each at its number modulo 3
};

}  // namespace gazetrace
