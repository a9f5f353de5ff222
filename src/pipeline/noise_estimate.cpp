// SPDX-License-Identifier: Apache-2.0
#include "pipeline/noise_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr int kRadius = 2;
constexpr std::size_t kMost = (2 * kRadius + 1) * (2 * kRadius + 1);

double pooled_at(const ImageGray& values, int x, int y) {
  std::array<double, kMost> lit{};  // values above 0
  std::size_t count = 0;
  std::size_t all = 0;
  for (int ny = std::max(y - kRadius, 0); ny <= std::min(y + kRadius, values.height_px - 1); ++ny) {
    for (int nx = std::max(x - kRadius, 0); nx <= std::min(x + kRadius, values.width_px - 1); ++nx) {
      const auto value = static_cast<double>(values(nx, ny));
      ++all;
      if (value > 0 && std::isfinite(value)) {
        lit[count++] = value;
      }
    }
  }
  if (count == 0) {
    return 0;
  }
  const auto middle = lit.begin() + static_cast<std::ptrdiff_t>(count / 2);
  const auto end = lit.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(lit.begin(), end);  // sums in one order
  const double most = kMostOfMedian * *middle;
  double sum = 0;
  for (auto value = lit.begin(); value != end; ++value) {
    sum += std::min(*value, most);
  }
  return sum / static_cast<double>(all);
}

}  // namespace

ImageGray pooled(const ImageGray& values, int threads) {
  ImageGray result(values.width_px, values.height_px);
  parallel_for(static_cast<std::size_t>(values.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < values.width_px; ++x) {
      result(x, y) = static_cast<float>(pooled_at(values, x, y));
    }
  });
  return result;
}

}  // namespace gazetrace
