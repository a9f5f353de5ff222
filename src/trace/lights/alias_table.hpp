// SPDX-License-Identifier: Apache-2.0
// Chooses one of n entries in proportion to given weights, in constant time (Walker 1977; construction by Vose 1991).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gazetrace {

class AliasTable {
 public:
  AliasTable() = default;
  // Weights must be finite and not negative. Where all are zero, the table is empty.
  explicit AliasTable(const std::vector<double>& weights) {
    double sum = 0;
    for (const double w : weights) {
      sum += w;
    }
    if (!(sum > 0)) {
      return;
    }
    const std::size_t n = weights.size();
    std::vector<double> scaled(n);
    std::vector<std::uint32_t> small;
    std::vector<std::uint32_t> large;
    entries_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      scaled[i] = weights[i] / sum * static_cast<double>(n);
      (scaled[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
    }
    while (!small.empty() && !large.empty()) {
      const std::uint32_t s = small.back();
      const std::uint32_t l = large.back();
      small.pop_back();
      entries_[s] = {static_cast<float>(scaled[s]), l};
      scaled[l] -= 1 - scaled[s];
      if (scaled[l] < 1) {
        large.pop_back();
        small.push_back(l);
      }
    }
    // The remaining entries differ from 1 by rounding errors only.
    for (const auto* rest : {&small, &large}) {
      for (const std::uint32_t i : *rest) {
        entries_[i] = {1.0F, i};
      }
    }
  }

  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }

  // `u` is in [0, 1), and a double since a float times the table's size has no digits left for the second decision. The
  // table must not be empty.
  [[nodiscard]] std::uint32_t choose(double u) const noexcept {
    const double at = u * static_cast<double>(entries_.size());
    const std::size_t i = std::min(static_cast<std::size_t>(at), entries_.size() - 1);
    const Entry& entry = entries_[i];
    return at - static_cast<double>(i) < static_cast<double>(entry.keep) ? static_cast<std::uint32_t>(i) : entry.alias;
  }

  // For tests: the probabilities with which choose() returns each entry, recovered from the table.
  [[nodiscard]] std::vector<double> probabilities() const {
    std::vector<double> p(entries_.size());
    const double share = 1.0 / static_cast<double>(entries_.size());
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      p[i] += static_cast<double>(entries_[i].keep) * share;
      p[entries_[i].alias] += (1 - static_cast<double>(entries_[i].keep)) * share;
    }
    return p;
  }

 private:
  struct Entry {
    float keep = 1;
    std::uint32_t alias = 0;
  };
  std::vector<Entry> entries_;
};

}  // namespace gazetrace
