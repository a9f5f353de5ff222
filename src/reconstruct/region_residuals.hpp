// SPDX-License-Identifier: Apache-2.0
// The residuals of the blocks of one region in bands, what of each is given back, and what that is between blocks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reconstruct/block_bands.hpp"
#include "reconstruct/block_window.hpp"
#include "reconstruct/keep_residuals.hpp"
#include "reconstruct/residual_power.hpp"

namespace gazetrace {

// What is given back of a block's residual, and what becomes of the picture's estimates there.
struct KeptResidual {
  Vec3f radiance;
  float rest = 1;  // the share of the finest band that is not given back
  float variance = 0, error = 0;
  float replica = 0;  // of the error of what is given back
  float shown = 0;    // mean luminance of the picture
};

// The residuals of the blocks of one region, and what is kept of them.
class RegionResiduals {
 public:
  // `of_site`: of each site of the map. `picture`: what the residuals are to be given back to.
  RegionResiduals(const FilterInput& input, const SmoothingSettings& settings, const BlockWindow& window,
                  const std::vector<SiteResidual>& of_site, const Image<std::uint32_t>& site_of_pixel,
                  const SurfacePicture& picture);

  [[nodiscard]] int first_column() const { return window_.x; }
  [[nodiscard]] int columns() const { return window_.width; }
  [[nodiscard]] bool has_row(int block_y) const { return block_y >= window_.y && block_y < window_.y + window_.height; }
  // has_row(block_y) must be true.
  [[nodiscard]] const KeptResidual* row(int block_y) const { return &kept_[index(0, block_y - window_.y)]; }
  // Beyond the window the last block is repeated.
  [[nodiscard]] const KeptResidual& at(int block_x, int block_y) const {
    return kept_[index(std::clamp(block_x - window_.x, 0, window_.width - 1),
                       std::clamp(block_y - window_.y, 0, window_.height - 1))];
  }

 private:
  using Residuals = Channels<4>;  // red, green, blue, and a replica of the error of their luminance
  using Plane = Channels<1>;

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] Plane relative_scale() const;
  void keep_bands();
  [[nodiscard]] Residuals::Value detail(const Residuals* coarser, int x, int y) const;
  void keep_band(int band, const Plane& scales, const Residuals* coarser);

  BlockWindow window_;
  float most_deviations_;
  int threads_;
  Residuals finer_;
  Plane light_;               // mean luminance of the picture
  std::vector<float> doubt_;  // of each block's residual
  std::vector<float> noise_;  // mean square near the block, in all bands
  std::vector<KeptResidual> kept_;
};

// What is kept of the residuals of a region in the pixels of one row; nothing where the region has none there.
class RowOfResiduals {
 public:
  RowOfResiduals(const RegionResiduals& residuals, int block_px, int y);
  RowOfResiduals(RowOfResiduals&&) = default;  // a copy would point into what it was copied from

  // The pixels of a block share its residual in proportion to what they show (`light`): what is wrong with light is
  // wrong by a factor.
  [[nodiscard]] KeptResidual at(int x, float light) const;

 private:
  int block_px_, first_;
  std::vector<KeptResidual> interpolated_;
  const KeptResidual* of_blocks_ = nullptr;  // from block `first_` on
};

}  // namespace gazetrace
