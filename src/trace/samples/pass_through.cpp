// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "gazetrace/trace.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNoneIsEnough = std::numeric_limits<std::uint32_t>::max();

std::uint32_t enough(const std::optional<std::uint64_t>& samples) {
  return samples.value_or(0) == 0 ? kNoneIsEnough
                                  : static_cast<std::uint32_t>(std::min<std::uint64_t>(*samples, kNoneIsEnough));
}

}  // namespace

PassThrough::PassThrough(const SamplingMap& map, const std::optional<std::uint64_t>& samples)
    : map_(&map), enough_samples_(enough(samples)) {}

}  // namespace gazetrace
