// SPDX-License-Identifier: Apache-2.0
// A viewing transform as a table, for 8-bit pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "color/ocio.hpp"

namespace gazetrace {

// Samples the exact transform on a grid and interpolates it tetrahedrally. The transform is sampled on the grid of
// twice the resolution too, and every cell in which the interpolation is off there by more than kTolerance code values
// is left to the exact transform, as is everything above the grid. So the error is bounded by measurement, not by hope.
class BakedView {
 public:
  static constexpr double kTolerance = 0.45;  // of an 8-bit code value

  BakedView(const OcioView& exact, int threads);

  // `count` RGB pixels, all values in 0..1e6. Returns how many of them took the exact way. Pure, and the same for any
  // split of the pixels into calls.
  std::size_t apply_8(const float* rgb, std::size_t count, std::uint8_t* out) const;

  [[nodiscard]] double exact_cell_share() const { return exact_cell_share_; }

 private:
  // Display code values 0..255 of R, G, B, and 1 where the cell with this lowest corner is left to the exact transform.
  using Entry = float __attribute__((vector_size(16)));
  const OcioView& exact_;
  std::vector<Entry> table_;
  double exact_cell_share_ = 0;
};

}  // namespace gazetrace
