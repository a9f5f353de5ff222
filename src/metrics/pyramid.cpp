// SPDX-License-Identifier: Apache-2.0
#include "metrics/pyramid.hpp"

#include <algorithm>
#include <array>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr std::array<float, 5> kKernel{0.05F, 0.25F, 0.4F, 0.25F, 0.05F};

// Mirrors about the pixels' edges: -1 becomes 0, n becomes n - 1. The result is clamped for very small rasters.
int mirrored(int i, int n) {
  const int j = i < 0 ? -1 - i : (i >= n ? 2 * n - 1 - i : i);
  return std::max(std::min(j, n - 1), 0);
}

void filter_across(const std::vector<float>& in, bool odd_rule, float* out) {
  const int n = static_cast<int>(in.size());
  const int count = (n + 1) / 2;
  const auto at = [&](int i) { return in[static_cast<std::size_t>(mirrored(i, n))]; };
  const auto mirrored_sum = [&](int i) {
    return kKernel[0] * at(2 * i - 2) + kKernel[1] * at(2 * i - 1) + kKernel[2] * at(2 * i) +
           kKernel[3] * at(2 * i + 1) + kKernel[4] * at(2 * i + 2);
  };
  for (int i = 1; i < count - 1; ++i) {
    const float* x = &in[static_cast<std::size_t>(2 * i - 2)];
    out[i] = kKernel[0] * x[0] + kKernel[1] * x[1] + kKernel[2] * x[2] + kKernel[3] * x[3] + kKernel[4] * x[4];
  }
  out[0] = mirrored_sum(0);
  if (count < 2) {
    return;
  }
  if (odd_rule == (n % 2 == 1)) {
    out[count - 1] = mirrored_sum(count - 1);
    return;
  }
  // The rule of the other parity: samples outside count as 0, and the terms are added that a raster of the other parity
  // would have.
  const int centre = 2 * (count - 1);
  float sum = 0;
  for (int k = 0; k < 5; ++k) {
    const int i = centre - 2 + k;
    sum += i >= 0 && i < n ? kKernel[static_cast<std::size_t>(k)] * in[static_cast<std::size_t>(i)] : 0.0F;
  }
  out[count - 1] = sum + (odd_rule ? kKernel[3] * at(n - 1) + kKernel[4] * at(n - 2) : kKernel[4] * at(n - 1));
}

}  // namespace

ImageGray halved(const ImageGray& image, bool original_border, int threads) {
  ImageGray half((image.width_px + 1) / 2, (image.height_px + 1) / 2);
  const bool odd_rule = (original_border ? image.height_px : image.width_px) % 2 == 1;
  const auto width = static_cast<std::size_t>(image.width_px);
  parallel_for(static_cast<std::size_t>(half.height_px), threads, [&](std::size_t row) {
    const int y = 2 * static_cast<int>(row);
    std::array<const float*, 5> rows{};
    for (int k = 0; k < 5; ++k) {
      rows[static_cast<std::size_t>(k)] = &image.pixels[image.index(0, mirrored(y - 2 + k, image.height_px))];
    }
    std::vector<float> column(width);
    for (std::size_t x = 0; x < width; ++x) {
      column[x] = kKernel[0] * rows[0][x] + kKernel[1] * rows[1][x] + kKernel[2] * rows[2][x] +
                  kKernel[3] * rows[3][x] + kKernel[4] * rows[4][x];
    }
    filter_across(column, odd_rule, &half.pixels[row * static_cast<std::size_t>(half.width_px)]);
  });
  return half;
}

void doubled_row(const ImageGray& image, int y, int width_px, std::vector<float>& buffer, float* out) {
  // First along the columns: even rows depend on three rows of the small picture, odd ones on two.
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto row_at = [&](int i) { return &image.pixels[image.index(0, std::clamp(i, 0, image.height_px - 1))]; };
  buffer.resize(width + 2);
  float* small = buffer.data() + 1;
  if (y % 2 == 0) {
    const float* above = row_at(y / 2 - 1);
    const float* here = row_at(y / 2);
    const float* below = row_at(y / 2 + 1);
    for (std::size_t x = 0; x < width; ++x) {
      small[x] = 2 * kKernel[0] * above[x] + 2 * kKernel[2] * here[x] + 2 * kKernel[4] * below[x];
    }
  } else {
    const float* above = row_at(y / 2);
    const float* below = row_at(y / 2 + 1);
    for (std::size_t x = 0; x < width; ++x) {
      small[x] = 2 * kKernel[1] * above[x] + 2 * kKernel[3] * below[x];
    }
  }
  buffer.front() = small[0];
  buffer[width + 1] = small[width - 1];
  const int pairs = width_px / 2;
  for (int i = 0; i < pairs; ++i) {
    out[2 * i] = 2 * kKernel[0] * small[i - 1] + 2 * kKernel[2] * small[i] + 2 * kKernel[4] * small[i + 1];
    out[2 * i + 1] = 2 * kKernel[1] * small[i] + 2 * kKernel[3] * small[i + 1];
  }
  if (width_px % 2 == 1) {
    out[2 * pairs] =
        2 * kKernel[0] * small[pairs - 1] + 2 * kKernel[2] * small[pairs] + 2 * kKernel[4] * small[pairs + 1];
  }
}

ImageGray doubled(const ImageGray& image, int width_px, int height_px, int threads) {
  ImageGray result(width_px, height_px);
  parallel_for(static_cast<std::size_t>(height_px), threads, [&](std::size_t row) {
    std::vector<float> buffer;
    const int y = static_cast<int>(row);
    doubled_row(image, y, width_px, buffer, &result(0, y));
  });
  return result;
}

}  // namespace gazetrace
