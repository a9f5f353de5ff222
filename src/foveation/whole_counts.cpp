// SPDX-License-Identifier: Apache-2.0
#include "foveation/whole_counts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/hash.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kOne = std::uint64_t{1} << 40U;
constexpr std::uint64_t kStartTag = 0x53595354454d4154ULL;
constexpr std::size_t kGroup = 4;

constexpr std::array<std::array<std::uint8_t, kGroup>, 24> all_orders() {
  std::array<std::array<std::uint8_t, kGroup>, 24> orders{};
  std::size_t i = 0;
  for (std::uint8_t a = 0; a < 4; ++a) {
    for (std::uint8_t b = 0; b < 4; ++b) {
      for (std::uint8_t c = 0; c < 4; ++c) {
        if (a != b && a != c && b != c) {
          orders[i++] = {a, b, c, static_cast<std::uint8_t>(6 - a - b - c)};
        }
      }
    }
  }
  return orders;
}
constexpr auto kOrders = all_orders();

double expectation(double weight, double rate, double most_spp, const Site& site) {
  return std::min(rate * weight, most_spp * site.pixels);
}

double total(const SamplingMap& map, const std::vector<double>& weights, double rate, double most_spp) {
  double sum = 0;
  double lost = 0;  // Kahan summation, since a frame may have up to 10^9 sites
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double term = expectation(weights[i], rate, most_spp, map.sites[i]) - lost;
    const double next = sum + term;
    lost = (next - sum) - term;
    sum = next;
  }
  return sum;
}

}  // namespace

double rate_of_budget(const SamplingMap& map, const std::vector<double>& weights, double samples, double most_spp) {
  const double pixels = static_cast<double>(map.width_px) * map.height_px;
  if (samples > most_spp * pixels) {
    throw Error(ErrorKind::usage, "sample budget",
                std::to_string(samples) + " samples are more than a frame of " + std::to_string(map.width_px) + " x " +
                    std::to_string(map.height_px) + " pixels can have",
                "give at most " + std::to_string(most_spp) + " a pixel");
  }
  // Without limits the sum is proportional to the rate. With limits it is less, and grows until every site is limited.
  double low = samples / total(map, weights, 1, most_spp * pixels);
  if (total(map, weights, low, most_spp) >= samples * (1 - 1e-12)) {
    return low;
  }
  double high = 2 * low;
  while (total(map, weights, high, most_spp) < samples && std::isfinite(high)) {
    high *= 2;
  }
  for (int step = 0; step < 64 && low < high; ++step) {
    const double middle = low + 0.5 * (high - low);
    (total(map, weights, middle, most_spp) < samples ? low : high) = middle;
  }
  return high;
}

void set_whole_counts(SamplingMap& map, const std::vector<double>& weights, double rate, double most_spp,
                      std::uint64_t seed, std::int32_t frame) {
  const std::uint64_t key = hash_combine(hash_combine(seed ^ kStartTag, static_cast<std::uint32_t>(frame)), kStartTag);
  std::uint64_t sum = key & (kOne - 1);
  bool uncertain = false;
  std::vector<float> expected(map.sites.size());
  for (std::size_t first = 0; first < map.sites.size(); first += kGroup) {
    const auto& order = kOrders[hash_combine(key, first) % kOrders.size()];
    for (const std::uint8_t place : order) {
      const std::size_t i = first + place;
      if (i >= map.sites.size()) {
        continue;
      }
      Site& site = map.sites[i];
      const double mean = expectation(weights[i], rate, most_spp, site);
      const double whole = std::floor(mean);
      const auto fraction = static_cast<std::uint64_t>(std::llround((mean - whole) * static_cast<double>(kOne)));
      sum += fraction;
      site.samples = static_cast<std::uint32_t>(whole) + (sum >= kOne ? 1U : 0U);
      sum &= kOne - 1;
      uncertain = uncertain || fraction != 0;
      expected[i] = static_cast<float>(mean);
    }
  }
  for (MapRegion& region : map.regions) {
    region.samples = 0;
    region.nominal_samples = 0;
  }
  for (MapTile& tile : map.tiles) {
    tile.samples = 0;
    for (std::size_t i = tile.first_site; i < std::size_t{tile.first_site} + tile.site_count; ++i) {
      const Site& site = map.sites[i];
      tile.samples += site.samples;
      map.regions[site.region].samples += site.samples;
      map.regions[site.region].nominal_samples += expectation(weights[i], rate, most_spp, site);
    }
  }
  if (uncertain) {
    map.expected_samples = std::move(expected);
  }
}

}  // namespace gazetrace
