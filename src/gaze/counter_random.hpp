// SPDX-License-Identifier: Apache-2.0
// Random numbers as functions of (seed, stream, index, dimension), which depend on no order and keep no state.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hash.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

class CounterRandom {
 public:
  // Streams keep apart what is drawn for different purposes.
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(hash_combine(seed, stream)) {}

  // In (0, 1): never 0, so that its logarithm is finite.
  [[nodiscard]] double uniform(std::uint64_t index, std::uint64_t dimension) const {
    const std::uint64_t bits = hash_combine(hash_combine(key_, index), dimension) >> 11U;
    return (static_cast<double>(bits) + 0.5) * 0x1p-53;
  }
  // Two independent normal numbers of mean 0 and variance 1 (Box & Muller 1958).
  [[nodiscard]] Vec2d normals(std::uint64_t index, std::uint64_t dimension) const {
    const double radius = std::sqrt(-2.0 * std::log(uniform(index, 2 * dimension)));
    const double angle = 2.0 * kPi * uniform(index, 2 * dimension + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  std::uint64_t key_;
};

}  // namespace gazetrace
