// SPDX-License-Identifier: Apache-2.0
#include "visible/pyramid_rows.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace gazetrace {
namespace {

constexpr std::array<float, 5> kKernel{0.05F, 0.25F, 0.4F, 0.25F, 0.05F};

// Which values of a level make one of the next, and with which weights.
using Terms = std::vector<std::pair<int, float>>;

Terms halving_terms(int size, int i, bool odd_rule) {
  Terms terms;
  const auto mirrored = [size](int at) {
    const int inside = at < 0 ? -1 - at : (at >= size ? 2 * size - 1 - at : at);
    return std::clamp(inside, 0, size - 1);
  };
  const int last = (size + 1) / 2 - 1;
  const bool rule_fits = odd_rule == (size % 2 == 1);
  for (int k = 0; k < 5; ++k) {
    const int at = 2 * i - 2 + k;
    const float weight = kKernel[static_cast<std::size_t>(k)];
    if (i < last || last == 0 || rule_fits) {
      terms.emplace_back(mirrored(at), weight);
    } else if (at >= 0 && at < size) {
      terms.emplace_back(at, weight);
    }
  }
  // The rule of the other parity: see metrics/pyramid.cpp.
  if (i == last && last > 0 && !rule_fits) {
    if (odd_rule) {
      terms.emplace_back(mirrored(size - 1), kKernel[3]);
      terms.emplace_back(mirrored(size - 2), kKernel[4]);
    } else {
      terms.emplace_back(mirrored(size - 1), kKernel[4]);
    }
  }
  return terms;
}

Terms doubling_terms(int small_size, int i) {
  const auto clamped = [small_size](int at) { return std::clamp(at, 0, small_size - 1); };
  if (i % 2 == 0) {
    return {{clamped(i / 2 - 1), 2 * kKernel[0]}, {i / 2, 2 * kKernel[2]}, {clamped(i / 2 + 1), 2 * kKernel[4]}};
  }
  return {{i / 2, 2 * kKernel[1]}, {clamped(i / 2 + 1), 2 * kKernel[3]}};
}

PixelWeights sum_of(const std::vector<PixelWeights>& rows, const Terms& terms) {
  PixelWeights sum;
  sum.first = rows[static_cast<std::size_t>(terms.front().first)].first;
  int end = sum.first;
  for (const auto& [row, weight] : terms) {
    const PixelWeights& from = rows[static_cast<std::size_t>(row)];
    sum.first = std::min(sum.first, from.first);
    end = std::max(end, from.first + static_cast<int>(from.weight.size()));
  }
  sum.weight.resize(static_cast<std::size_t>(end - sum.first));
  for (const auto& [row, weight] : terms) {
    const PixelWeights& from = rows[static_cast<std::size_t>(row)];
    for (std::size_t x = 0; x < from.weight.size(); ++x) {
      sum.weight[static_cast<std::size_t>(from.first - sum.first) + x] += weight * from.weight[x];
    }
  }
  return sum;
}

// The weights of the pixels of each block added up: what one value for the whole block is multiplied by.
PixelWeights in_blocks(const PixelWeights& row, int block_px) {
  PixelWeights blocks;
  blocks.first = row.first / block_px;
  const int last = (row.first + static_cast<int>(row.weight.size()) - 1) / block_px;
  blocks.weight.resize(static_cast<std::size_t>(last - blocks.first + 1));
  for (std::size_t x = 0; x < row.weight.size(); ++x) {
    const int block = (row.first + static_cast<int>(x)) / block_px;
    blocks.weight[static_cast<std::size_t>(block - blocks.first)] += row.weight[x];
  }
  return blocks;
}

float product(const PixelWeights& a, const PixelWeights& b) {
  const int from = std::max(a.first, b.first);
  const int to = std::min(a.first + static_cast<int>(a.weight.size()), b.first + static_cast<int>(b.weight.size()));
  double sum = 0;
  for (int x = from; x < to; ++x) {
    sum += static_cast<double>(a.weight[static_cast<std::size_t>(x - a.first)]) *
           static_cast<double>(b.weight[static_cast<std::size_t>(x - b.first)]);
  }
  return static_cast<float>(sum);
}

}  // namespace

std::vector<LevelRows> pyramid_rows(int size, std::size_t levels, const std::vector<bool>& odd_rule) {
  std::vector<PixelWeights> level;
  for (int x = 0; x < size; ++x) {
    level.push_back({x, {1.0F}});
  }
  std::vector<LevelRows> all;
  for (std::size_t b = 0; b < levels; ++b) {
    const int n = static_cast<int>(level.size());
    const bool odd = b < odd_rule.size() ? odd_rule[b] : n % 2 == 1;
    std::vector<PixelWeights> next;
    for (int i = 0; i < (n + 1) / 2; ++i) {
      next.push_back(sum_of(level, halving_terms(n, i, odd)));
    }
    LevelRows rows;
    for (int i = 0; i < n; ++i) {
      rows.interpolated.push_back(sum_of(next, doubling_terms(static_cast<int>(next.size()), i)));
    }
    rows.level = std::move(level);
    all.push_back(std::move(rows));
    level = std::move(next);
  }
  return all;
}

NoiseSums noise_sums(const LevelRows& rows, int block_px) {
  NoiseSums sums;
  for (std::size_t i = 0; i < rows.level.size(); ++i) {
    const PixelWeights level = in_blocks(rows.level[i], block_px);
    const PixelWeights interpolated = in_blocks(rows.interpolated[i], block_px);
    sums.kk.push_back(product(level, level));
    sums.ke.push_back(product(level, interpolated));
    sums.ee.push_back(product(interpolated, interpolated));
  }
  return sums;
}

}  // namespace gazetrace
