// SPDX-License-Identifier: Apache-2.0
// Pictures with a few floats per block of a region's grid, and how they are smoothed in rows, which become vectors.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/parallel.hpp"

namespace gazetrace {

// Several floats per block, beside each other: all of a row are smoothed in one loop, which becomes vectors.
template <int kChannels>
struct Channels {
  using Value = std::array<float, kChannels>;
  int width, height;
  std::vector<float> values;

  Channels(int width_blocks, int height_blocks)
      : width(width_blocks),
        height(height_blocks),
        values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kChannels) {}
  [[nodiscard]] float* row(int y) { return values.data() + offset(0, y); }
  [[nodiscard]] const float* row(int y) const { return values.data() + offset(0, y); }
  [[nodiscard]] Value at(int x, int y) const {
    Value value;
    std::copy_n(values.data() + offset(x, y), kChannels, value.data());
    return value;
  }
  void put(int x, int y, const Value& value) { std::copy_n(value.data(), kChannels, values.data() + offset(x, y)); }

 private:
  [[nodiscard]] std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * kChannels;
  }
};

// visit(y) for every row.
template <class Visit>
void for_each_row(int height, int threads, const Visit& visit) {
  constexpr std::size_t kRowsPerTask = 8;
  const auto rows = static_cast<std::size_t>(height);
  parallel_for((rows + kRowsPerTask - 1) / kRowsPerTask, threads, [&](std::size_t task) {
    for (std::size_t y = task * kRowsPerTask; y < std::min(rows, (task + 1) * kRowsPerTask); ++y) {
      visit(static_cast<int>(y));
    }
  });
}

// Of `count` floats: a quarter of each of two, and half of the one between.
inline void binomial(const float* before, const float* own, const float* after, std::ptrdiff_t count, float* out) {
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    out[k] = 0.25F * (before[k] + after[k]) + 0.5F * own[k];
  }
}

// From `image` to `out`: binomial weights 1 2 1 in both directions, `step` blocks apart. Beyond the window's edge the
// last block is repeated.
template <int kChannels>
void smooth(int step, int threads, const Channels<kChannels>& image, Channels<kChannels>& scratch,
            Channels<kChannels>& out) {
  const int width = image.width;
  const int height = image.height;
  for_each_row(height, threads, [&](int y) {
    const float* in = image.row(y);
    float* smoothed = scratch.row(y);
    const auto blocks = [&](int x, int before, int after, int count) {
      binomial(in + std::ptrdiff_t{before} * kChannels, in + std::ptrdiff_t{x} * kChannels,
               in + std::ptrdiff_t{after} * kChannels, std::ptrdiff_t{count} * kChannels,
               smoothed + std::ptrdiff_t{x} * kChannels);
    };
    const int inside = std::min(step, width);
    const int inside_end = std::max(width - step, inside);
    for (int x = 0; x < inside; ++x) {
      blocks(x, std::max(x - step, 0), std::min(x + step, width - 1), 1);
    }
    if (inside < inside_end) {
      blocks(inside, inside - step, inside + step, inside_end - inside);
    }
    for (int x = inside_end; x < width; ++x) {
      blocks(x, std::max(x - step, 0), std::min(x + step, width - 1), 1);
    }
  });
  for_each_row(height, threads, [&](int y) {
    binomial(scratch.row(std::max(y - step, 0)), scratch.row(y), scratch.row(std::min(y + step, height - 1)),
             std::ptrdiff_t{width} * kChannels, out.row(y));
  });
}

}  // namespace gazetrace
