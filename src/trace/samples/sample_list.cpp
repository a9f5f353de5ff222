// SPDX-License-Identifier: Apache-2.0
#include "trace/samples/sample_list.hpp"

#include <algorithm>

#include "core/instruction_sets.hpp"

namespace gazetrace {

SiteSequence SampleList::sequence_of_site(const Site& site, int first_x, int first_y) const {
  // Every pixel belongs to one site only, so a site's first pixel identifies it.
  return {make_sample_key(seed_, frame_,
                          (static_cast<std::uint64_t>(map_->y_px + first_y) << 32U) |
                              static_cast<std::uint64_t>(map_->x_px + first_x)),
          halves_, independent_halves_, static_cast<std::uint8_t>((site.block_x ^ site.block_y) & 1)};
}

GAZETRACE_CLONES int SampleList::next(const PixelFilterSampler& filter, SampleBatch& out) {
  const float half_width = 0.5F * static_cast<float>(map_->width_px);
  const float half_height = 0.5F * static_cast<float>(map_->height_px);
  int filled = 0;
  while (filled < kBatchSize && site_ < end_) {
    const Site& site = map_->sites[site_];
    if (sample_ >= site.samples) {
      ++site_;
      sample_ = 0;
      continue;
    }
    const int block = map_->regions[site.region].block_px;
    const bool whole = site.pixels == block * block;
    int first_x = site.block_x * block;
    int first_y = site.block_y * block;
    if (!whole) {
      pixels_of_site(*map_, site, pixels_);
      first_x = pixels_[0].x;
      first_y = pixels_[0].y;
    }
    const SiteSequence sequence = sequence_of_site(site, first_x, first_y);
    const auto left = static_cast<int>(std::min<std::uint32_t>(site.samples - sample_, kBatchSize));
    const int count = std::min(left, kBatchSize - filled);
    const auto size = static_cast<float>(block);
    const auto pixel_count = static_cast<float>(site.pixels);
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(filled + k);
      const std::uint32_t sample = sample_ + static_cast<std::uint32_t>(k);
      const SamplePoint point = sample_point(sequence, sample);
      const Vec2f u = sample_2d(point.key, point.index, dimension_of(PathDimension::pixel));
      int px = first_x;
      int py = first_y;
      Vec2f inside = u;
      if (!whole) {
        // One number chooses the pixel, and its fraction the position inside.
        const float at = u.x * pixel_count;
        const auto chosen = std::min(static_cast<std::size_t>(at), pixels_.size() - 1);
        inside.x = std::min(at - static_cast<float>(chosen), 0x1.fffffep-1F);
        px = pixels_[chosen].x;
        py = pixels_[chosen].y;
      } else if (block > 1) {
        const float x = u.x * size;
        const float y = u.y * size;
        const int dx = std::min(static_cast<int>(x), block - 1);
        const int dy = std::min(static_cast<int>(y), block - 1);
        inside = {x - static_cast<float>(dx), y - static_cast<float>(dy)};
        px += dx;
        py += dy;
      }
      const Vec2f offset = filter.offset(inside.x, inside.y);
      out.site[i] = site_;
      out.sample[i] = sample;
      out.index[i] = point.index;
      out.half[i] = point.half;
      out.key[i] = point.key;
      out.x[i] = (static_cast<float>(px) - half_width) + (0.5F + offset.x);
      out.y[i] = (static_cast<float>(py) - half_height) + (0.5F + offset.y);
      out.pixel_x[i] = static_cast<std::uint16_t>(px);
      out.pixel_y[i] = static_cast<std::uint16_t>(py);
    }
    filled += count;
    sample_ += static_cast<std::uint32_t>(count);
  }
  return filled;
}

}  // namespace gazetrace
