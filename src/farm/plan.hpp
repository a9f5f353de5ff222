// SPDX-License-Identifier: Apache-2.0
// How farms of each kind are planned.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/farm.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {

// What every farm has; memory only where it was given.
FarmPlan farm_plan_of(const FarmSettings& settings, const std::string& run_folder);
std::string absolute_path(const std::string& path);
// What the files of the run begin with, folder included.
std::string run_name_of(const FarmPlan& plan);

FarmPlan plan_sweep_farm(const FarmSettings& settings);

}  // namespace gazetrace
