// SPDX-License-Identifier: Apache-2.0
// Means over scenes, gazes within them and seeds within those, with intervals from resampling at each of the levels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace gazetrace::gain {

// Each leaf, a seed, holds `width` values. Branches without leaves are left out.
struct Observations {
  struct Seeds {
    std::size_t first = 0, count = 0;  // leaves
  };
  std::size_t width = 1;
  std::vector<std::vector<Seeds>> scenes;  // of gazes
  std::vector<double> values;

  void add_scene() { scenes.emplace_back(); }
  void add_gaze() { scenes.back().push_back({values.size() / width, 0}); }
  void add_leaf(const std::vector<double>& leaf) {
    values.insert(values.end(), leaf.begin(), leaf.end());
    ++scenes.back().back().count;
  }
  void prune() {
    for (auto& gazes : scenes) {
      std::erase_if(gazes, [](const Seeds& seeds) { return seeds.count == 0; });
    }
    std::erase_if(scenes, [](const auto& gazes) { return gazes.empty(); });
  }
  [[nodiscard]] bool empty() const { return values.empty(); }
  [[nodiscard]] std::size_t leaves() const { return values.size() / width; }
  [[nodiscard]] std::size_t gazes() const {
    return std::accumulate(scenes.begin(), scenes.end(), std::size_t{0},
                           [](std::size_t sum, const auto& gazes) { return sum + gazes.size(); });
  }
};

// Every scene counts alike, and in it every gaze, and in it every seed. `pick(i, n)`: which of n stands at place i.
template <class Pick>
std::vector<double> mean_of(const Observations& all, const Pick& pick) {
  std::vector<double> mean(all.width, 0.0);
  for (std::size_t s = 0; s < all.scenes.size(); ++s) {
    const auto& gazes = all.scenes[pick(s, all.scenes.size())];
    for (std::size_t g = 0; g < gazes.size(); ++g) {
      const Observations::Seeds& seeds = gazes[pick(g, gazes.size())];
      const double weight = 1.0 / static_cast<double>(all.scenes.size() * gazes.size() * seeds.count);
      for (std::size_t k = 0; k < seeds.count; ++k) {
        const double* leaf = &all.values[(seeds.first + pick(k, seeds.count)) * all.width];
        for (std::size_t w = 0; w < all.width; ++w) {
          mean[w] += weight * leaf[w];
        }
      }
    }
  }
  return mean;
}

struct Interval {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
};

// The tail of resamplings that leaves out 2.5 %. A resampling of n spreads less than a new draw of n would, and by an n
// that is small itself uncertainly: Hesterberg 2015, "What teachers should know about the bootstrap", section 5.3,
// expands the quantiles to those of Student's distribution (here by its expansion in 1 / freedom, Abramowitz and Stegun
// 26.7.5).
inline double expanded_tail(std::size_t n) {
  constexpr double z = 1.959963984540054;
  const double freedom = static_cast<double>(std::max<std::size_t>(n, 2) - 1);
  const double t = z + (std::pow(z, 3) + z) / (4 * freedom) +
                   (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * freedom * freedom);
  return 0.5 * std::erfc(std::sqrt((freedom + 1) / freedom) * t / std::sqrt(2.0));
}

// Of a function of the means, with a 95 % interval from 2000 resamplings, expanded for the number of gazes. Scenes are
// few: what varies between them is in the interval, but no more surely than they are many.
template <class Statistic>
Interval bootstrap(const Observations& all, const Statistic& statistic) {
  constexpr std::size_t kDraws = 2000;
  if (all.empty()) {
    return {};
  }
  Interval interval;
  interval.value = statistic(mean_of(all, [](std::size_t i, std::size_t) { return i; }));
  std::mt19937_64 random(1);
  std::vector<double> draws(kDraws);
  for (double& draw : draws) {
    draw = statistic(mean_of(all, [&](std::size_t, std::size_t n) { return n == 1 ? 0 : random() % n; }));
  }
  std::sort(draws.begin(), draws.end());
  const auto quantile = [&](double q) {
    const double at = q * (kDraws - 1);
    const auto below = static_cast<std::size_t>(at);
    return std::lerp(draws[below], draws[std::min(below + 1, kDraws - 1)], at - static_cast<double>(below));
  };
  interval.low = quantile(expanded_tail(all.gazes()));
  interval.high = quantile(1 - expanded_tail(all.gazes()));
  return interval;
}

}  // namespace gazetrace::gain
