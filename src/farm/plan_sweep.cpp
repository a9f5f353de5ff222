// SPDX-License-Identifier: Apache-2.0
// Farms whose tasks measure rows of a sweep, and whose end are the tables.
#include <fmt/format.h>

#include <filesystem>

#include "farm/plan.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/sweep_plan.hpp"

namespace gazetrace {

FarmPlan plan_sweep_farm(const FarmSettings& settings) {
  SweepPlan sweep = load_sweep_plan(settings.job_file, std::nullopt, std::nullopt, job_schema(), settings.confine).plan;
  sweep.directory =
      settings.output.empty() ? std::filesystem::path(settings.job_file).stem().string() + ".sweep" : settings.output;
  FarmPlan plan = farm_plan_of(settings, sweep.directory);
  plan.kind = FarmKind::sweep;
  for (const SweepShare& share : divide_sweep(sweep, settings.chunks)) {
    plan.chunks.push_back(fmt::format("{}", fmt::join(share.rows, " ")));
    plan.samples.push_back(share.samples);
  }
  return plan;
}

}  // namespace gazetrace
