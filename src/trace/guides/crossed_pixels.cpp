// SPDX-License-Identifier: Apache-2.0
#include "trace/guides/crossed_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "core/instruction_sets.hpp"

namespace gazetrace {
namespace {

constexpr float kEdgeDepth = 0.02F;

// For the pixels `a` and `b` and the pairs to the right of them, `count` in all: whether the two see different things.
GAZETRACE_CLONES void find_parted(const Guides& guides, const RoughNormal* smooth, std::size_t a, std::size_t b,
                                  std::size_t count, std::uint8_t* parted) {
  const std::uint32_t* const object = guides.object.pixels.data();
  const std::uint32_t* const material = guides.material.pixels.data();
  const SurfaceKind* const kind = guides.kind.pixels.data();
  for (std::size_t k = 0; k < count; ++k) {
    const bool other =
        (static_cast<int>(object[a + k] != object[b + k]) | static_cast<int>(material[a + k] != material[b + k]) |
         static_cast<int>(kind[a + k] != kind[b + k])) != 0;
    const bool turned = (static_cast<int>(kind[a + k] != SurfaceKind::miss) &
                         static_cast<int>(facing(smooth[a + k], smooth[b + k]) < kEdgeNormal)) != 0;
    parted[k] = static_cast<std::uint8_t>(static_cast<int>(other) | static_cast<int>(turned));
  }
}

// The quantity that is linear over a plane: depth (orthographic) or its inverse (perspective).
GAZETRACE_CLONES void find_linear(const float* depth_m, bool perspective, std::size_t count, float* linear) {
  for (std::size_t k = 0; k < count; ++k) {
    linear[k] = perspective ? 1.0F / depth_m[k] : depth_m[k];
  }
}

// Marks in `crossed` the pixels whose value is off the line through its two neighbours.
GAZETRACE_CLONES void find_bent(const float* before, const float* at, const float* after, std::size_t count,
                                std::uint8_t* crossed) {
  for (std::size_t k = 0; k < count; ++k) {
    const bool bent = std::fabs(before[k] + after[k] - 2 * at[k]) > kEdgeDepth * std::fabs(at[k]);
    crossed[k] = static_cast<std::uint8_t>(static_cast<int>(crossed[k]) | static_cast<int>(bent));
  }
}

}  // namespace

CrossedPixels::CrossedPixels(const Guides& guides, const Image<RoughNormal>& smooth, int first_row)
    : guides_(guides),
      smooth_(smooth.pixels.data()),
      width_(static_cast<std::size_t>(guides.kind.width_px)),
      height_(static_cast<std::size_t>(guides.kind.height_px)),
      row_(static_cast<std::size_t>(first_row)),
      above_(width_, 0),
      below_(width_, 0),
      beside_(width_, 0),
      crossed_(width_, 0) {
  linear_.fill(std::vector<float>(width_));
  if (row_ > 0) {
    compare_with_next(row_ - 1, below_);
    find_linear_of(row_ - 1);
  }
  find_linear_of(row_);
}

const std::vector<std::uint8_t>& CrossedPixels::next_row() {
  above_.swap(below_);
  std::fill(below_.begin(), below_.end(), std::uint8_t{0});
  const bool has_next = row_ + 1 < height_;
  if (has_next) {
    compare_with_next(row_, below_);
    find_linear_of(row_ + 1);
  }
  const std::size_t first = row_ * width_;
  find_parted(guides_, smooth_, first, first + 1, width_ - 1, beside_.data());
  std::fill(crossed_.begin(), crossed_.end(), std::uint8_t{0});
  const float* const at = linear_[row_ % 3].data();
  if (width_ > 2) {
    find_bent(at, at + 1, at + 2, width_ - 2, crossed_.data() + 1);
  }
  if (row_ > 0 && has_next) {
    find_bent(linear_[(row_ - 1) % 3].data(), at, linear_[(row_ + 1) % 3].data(), width_, crossed_.data());
  }
  for (std::size_t x = 0; x < width_; ++x) {
    const int bent = crossed_[x] & static_cast<int>(guides_.kind.pixels[first + x] != SurfaceKind::miss);
    crossed_[x] = static_cast<std::uint8_t>(above_[x] | below_[x] | beside_[x] | (x > 0 ? beside_[x - 1] : 0) | bent);
  }
  ++row_;
  return crossed_;
}

// Marks in `parted` where row `y` and the next one see different things.
void CrossedPixels::compare_with_next(std::size_t y, std::vector<std::uint8_t>& parted) const {
  find_parted(guides_, smooth_, y * width_, (y + 1) * width_, width_, parted.data());
}

void CrossedPixels::find_linear_of(std::size_t y) {
  find_linear(&guides_.depth_m.pixels[y * width_], guides_.camera.perspective, width_, linear_[y % 3].data());
}

}  // namespace gazetrace
