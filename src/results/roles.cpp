// SPDX-License-Identifier: Apache-2.0
// What roles of rows are called in files and tables.
#include <algorithm>
#include <array>

#include "gazetrace/results.hpp"

namespace gazetrace {
namespace {

constexpr std::array<std::pair<RowRole, const char*>, 7> kRoles{{
    {RowRole::test, "test"},
    {RowRole::uniform_reference_rate, "uniform-reference-rate"},
    {RowRole::equal_samples, "equal-samples"},
    {RowRole::equal_time, "equal-time"},
    {RowRole::low_resolution, "low-resolution"},
    {RowRole::uniform_rate, "uniform-rate"},
    {RowRole::wrong_gaze, "wrong-gaze"},
}};

}  // namespace

std::string to_string(RowRole role) {
  const auto* const found =
      std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& one) { return one.first == role; });
  return found == kRoles.end() ? std::string() : found->second;
}

std::optional<RowRole> row_role(const std::string& name) {
  const auto* const found =
      std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& one) { return one.second == name; });
  return found == kRoles.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace gazetrace
