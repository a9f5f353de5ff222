// SPDX-License-Identifier: Apache-2.0
// The plan of a farm for people.
#include <fmt/format.h>

#include <algorithm>

#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

std::size_t count_in(const FarmPlan& plan, std::size_t chunk) {
  if (plan.kind != FarmKind::sweep) {
    return parse_frame_list(plan.chunks[chunk]).size();
  }
  const std::string& rows = plan.chunks[chunk];
  return rows.empty() ? 0 : static_cast<std::size_t>(std::count(rows.begin(), rows.end(), ' ')) + 1;
}

}  // namespace

std::string farm_plan_text(const FarmPlan& plan) {
  std::string text = fmt::format("{:>6}{:>8}{:>16}  {}\n", "chunk", plan.kind == FarmKind::sweep ? "rows" : "frames",
                                 "samples", "which");
  for (std::size_t i = 0; i < plan.chunks.size(); ++i) {
    text += fmt::format("{:>6}{:>8}{:>16}  {}\n", i + 1, count_in(plan, i),
                        plan.samples[i] > 0 ? fmt::format("{:.0f}", plan.samples[i]) : "not known",
                        bounded(plan.chunks[i], 80));
  }
  text += fmt::format("each task: {}{}{}\n", plan.threads > 0 ? fmt::format("{} threads, ", plan.threads) : "",
                      plan.memory_mib > 0 ? fmt::format("{} MiB", plan.memory_mib) : "memory not stated",
                      plan.time_s > 0 ? fmt::format(", at most {} min", (plan.time_s + 59) / 60) : "");
  return text + "then: merge" + (plan.then.empty() ? "" : fmt::format("; {}", fmt::join(plan.then, "; "))) + "\n";
}

}  // namespace gazetrace
