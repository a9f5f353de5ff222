// SPDX-License-Identifier: Apache-2.0
// A viewing transform baked into a table, for 8-bit pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "color/ocio.hpp"

namespace gazetrace {

// Samples the exact transform on a grid and interpolates it tetrahedrally. The transform is also sampled on a grid of
// twice the resolution. Every cell in which the interpolation is off there by more than kTolerance code values is left
// to the exact transform, as is everything above the grid, so the error at these points is bounded by measurement.
class BakedView {
 public:
  static constexpr double kTolerance = 0.45;  // of an 8-bit code value

  BakedView(const OcioView& exact, int threads);

  // Converts `count` RGB pixels with values in 0..1e6 and returns how many of them took the exact transform. The result
  // does not depend on how the pixels are divided into calls.
  std::size_t apply_8(const float* rgb, std::size_t count, std::uint8_t* out) const;

  [[nodiscard]] double exact_cell_share() const { return exact_cell_share_; }

 private:
  // Display code values 0..255 of R, G and B, and 1 where the cell that has this point as its lowest corner is left to
  // the exact transform.
  using Entry = float __attribute__((vector_size(16)));
  const OcioView& exact_;
  std::vector<Entry> table_;
  double exact_cell_share_ = 0;
};

}  // namespace gazetrace
