// SPDX-License-Identifier: Apache-2.0
#include "visible/variance_pyramid.hpp"

#include <algorithm>
#include <array>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

// 0.05, 0.25, 0.4, 0.25, 0.05 squared, over the sum of the squares.
constexpr float kSumOfSquares = 2 * (0.05F * 0.05F + 0.25F * 0.25F) + 0.4F * 0.4F;
constexpr std::array<float, 5> kKernel{0.05F * 0.05F / kSumOfSquares, 0.25F * 0.25F / kSumOfSquares,
                                       0.4F * 0.4F / kSumOfSquares, 0.25F * 0.25F / kSumOfSquares,
                                       0.05F * 0.05F / kSumOfSquares};

int mirrored(int i, int n) {
  const int j = i < 0 ? -1 - i : (i >= n ? 2 * n - 1 - i : i);
  return std::clamp(j, 0, n - 1);
}

}  // namespace

ImageGray halved_variance(const ImageGray& variance, int threads) {
  ImageGray half((variance.width_px + 1) / 2, (variance.height_px + 1) / 2);
  parallel_for(static_cast<std::size_t>(half.height_px), threads, [&](std::size_t row) {
    const int y = 2 * static_cast<int>(row);
    const auto width = static_cast<std::size_t>(variance.width_px);
    std::vector<float> column(width);
    for (int k = 0; k < 5; ++k) {
      const float* in = &variance.pixels[variance.index(0, mirrored(y - 2 + k, variance.height_px))];
      for (std::size_t x = 0; x < width; ++x) {
        column[x] += kKernel[static_cast<std::size_t>(k)] * in[x];
      }
    }
    for (int x = 0; x < half.width_px; ++x) {
      float sum = 0;
      for (int k = 0; k < 5; ++k) {
        sum += kKernel[static_cast<std::size_t>(k)] *
               column[static_cast<std::size_t>(mirrored(2 * x - 2 + k, variance.width_px))];
      }
      half(x, static_cast<int>(row)) = sum;
    }
  });
  return half;
}

}  // namespace gazetrace
