// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "gazetrace/trace.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNoneIsEnough = std::numeric_limits<std::uint32_t>::max();
constexpr double kLeastInFovea = 8;
constexpr std::uint32_t kAlwaysEnough = 16;

std::uint32_t enough(const SamplingMap& map, const std::optional<std::uint64_t>& samples) {
  if (samples) {
    return *samples == 0 ? kNoneIsEnough : static_cast<std::uint32_t>(std::min<std::uint64_t>(*samples, kNoneIsEnough));
  }
  if (map.full_rate_spp == 0) {
    return kNoneIsEnough;
  }
  return map.full_rate_spp >= kLeastInFovea && map.full_rate_spp < kAlwaysEnough
             ? static_cast<std::uint32_t>(map.full_rate_spp)
             : kAlwaysEnough;
}

}  // namespace

PassThrough::PassThrough(const SamplingMap& map, const std::optional<std::uint64_t>& samples)
    : map_(&map), enough_samples_(enough(map, samples)) {}

}  // namespace gazetrace
