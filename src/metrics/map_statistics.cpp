// SPDX-License-Identifier: Apache-2.0
// Exact quantiles without sorting: floats are counted by the upper half of their bits and then, within the bin that
// holds the quantile, by the lower half.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/statistics.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/metrics.hpp"

namespace gazetrace {
namespace {

// An integer that orders as the float does, also for negative values.
std::uint32_t key_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}
float value_of(std::uint32_t key) {
  return std::bit_cast<float>((key & 0x80000000U) != 0 ? key & 0x7fffffffU : ~key);
}

struct Bin {
  std::uint64_t count = 0;
  double sum = 0;
};
constexpr std::size_t kBins = 65536;
using Bins = std::vector<Bin>;

std::vector<float> scored_pixels(const ImageGray& map, int margin_px) {
  std::vector<float> values;
  for (int y = margin_px; y < map.height_px - margin_px; ++y) {
    const auto row = map.pixels.begin() + static_cast<std::ptrdiff_t>(map.index(0, y));
    values.insert(values.end(), row + margin_px, row + map.width_px - margin_px);
  }
  return values;
}

class Quantiles {
 public:
  explicit Quantiles(const std::vector<float>& values) : values_(values), upper_(kBins) {
    for (const float value : values) {
      Bin& bin = upper_[key_of(value) >> 16U];
      ++bin.count;
      bin.sum += static_cast<double>(value);
    }
    for (const Bin& bin : upper_) {
      total_ += bin.sum;
    }
  }

  [[nodiscard]] double total() const { return total_; }

  // Element `rank` of the sorted values.
  [[nodiscard]] double at_rank(std::uint64_t rank) const {
    std::uint64_t below = 0;
    return find([&](const Bin& bin) {
      const bool inside = below + bin.count > rank;
      below += inside ? 0 : bin.count;
      return inside;
    });
  }

  // The first of the sorted values at which the running sum exceeds `sum`.
  [[nodiscard]] double at_sum(double sum) const {
    double below = 0;
    return find([&](const Bin& bin) {
      const bool inside = below + bin.sum > sum;
      below += inside ? 0 : bin.sum;
      return inside;
    });
  }

 private:
  // Finds the first bin of upper halves for which `inside` holds, and within it the first bin of lower halves.
  template <class Inside>
  [[nodiscard]] double find(const Inside& inside) const {
    const auto holds = [&](const Bin& bin) { return bin.count > 0 && inside(bin); };
    const auto upper = std::find_if(upper_.begin(), upper_.end(), holds);
    if (upper == upper_.end()) {
      return 0;
    }
    const auto high = static_cast<std::uint32_t>(upper - upper_.begin());
    Bins lower(kBins);
    for (const float value : values_) {
      const std::uint32_t key = key_of(value);
      if (key >> 16U == high) {
        Bin& bin = lower[key & 0xffffU];
        ++bin.count;
        bin.sum += static_cast<double>(value);
      }
    }
    auto found = std::find_if(lower.begin(), lower.end(), holds);
    // The sum of a bin and the sums of its parts may differ in the last digit; then the last part is taken.
    while (found == lower.end() || found->count == 0) {
      --found;
    }
    return value_of(high << 16U | static_cast<std::uint32_t>(found - lower.begin()));
  }

  const std::vector<float>& values_;
  Bins upper_;
  double total_ = 0;
};

}  // namespace

MapStatistics map_statistics(const ImageGray& map, int margin_px) {
  const std::vector<float> values = scored_pixels(map, margin_px);
  if (values.empty()) {
    throw Error(ErrorKind::usage, "map", "has no scored pixels");
  }
  constexpr std::array<double, 5> kShares{0.05, 0.25, 0.5, 0.75, 0.95};
  constexpr std::array<double, 3> kWeightedShares{0.25, 0.5, 0.75};
  const Quantiles quantiles(values);
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  MapStatistics statistics;
  statistics.pixels = values.size();
  statistics.mean = quantiles.total() / static_cast<double>(values.size());
  statistics.min = static_cast<double>(*least);
  statistics.max = static_cast<double>(*most);
  for (std::size_t i = 0; i < kShares.size(); ++i) {
    statistics.quantiles[i] = quantiles.at_rank(upper_rank(kShares[i], values.size()));
  }
  for (std::size_t i = 0; i < kWeightedShares.size(); ++i) {
    statistics.weighted_quartiles[i] = quantiles.at_sum(kWeightedShares[i] * quantiles.total());
  }
  return statistics;
}

}  // namespace gazetrace
