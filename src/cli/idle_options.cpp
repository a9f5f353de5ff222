// SPDX-License-Identifier: Apache-2.0
#include "cli/idle_options.hpp"

#include <fmt/format.h>

#include <set>
#include <string>
#include <vector>

namespace gazetrace {
namespace {

struct IdleGroup {
  bool idle = false;
  std::string why;
  std::vector<std::string> options;
};

std::vector<IdleGroup> idle_groups(const JobSettings& job) {
  const bool has_log = !job.gaze.path.empty();
  const bool has_gaze = has_log || job.gaze_at.has_value();
  const FoveationSettings& fov = job.foveation;
  const bool regions = fov.falloff == "regions";
  const bool uniform = fov.falloff == "uniform";
  const bool hard_regions = regions && fov.border_blend_deg == 0;
  const bool reproject = job.accumulate.mode == AccumulateMode::reproject;
  return {
      {!has_gaze && !uniform, "without gaze", {"falloff"}},
      {!has_gaze,
       "without gaze",
       {"region-samples", "region-blocks", "region-angles", "angle-reading", "sample-unit", "region-shape",
        "border-blend-deg", "block-samples", "max-block", "density-floor", "contrast-strength", "gaze-uncertainty",
        "gaze-accuracy", "gaze-precision"}},
      {!reproject,
       "without --accumulate reproject",
       {"accumulate-order", "accumulate-frames", "accumulate-blend", "accumulate-clip", "accumulate-reset-saccades",
        "accumulate-reset-blinks"}},
      {reproject && !has_log, "without a gaze log", {"accumulate-reset-saccades", "accumulate-reset-blinks"}},
      {hard_regions || uniform,
       hard_regions ? "with --falloff regions and hard borders (--border-blend-deg 0)" : "with --falloff uniform",
       {"block-samples", "max-block", "density-floor"}},
      {!regions,
       fmt::format("with --falloff {}", fov.falloff),
       {"border-blend-deg", "region-samples", "region-blocks", "sample-unit", "region-shape"}},
      {!has_log,
       "without a gaze log",
       {"gaze-mode", "gaze-missing", "gaze-max-age", "gaze-max-gap", "gaze-offset", "gaze-scale", "gaze-start",
        "gaze-latency", "gaze-anchor", "gaze-process", "retinal-velocity", "saccade-density"}},
      {has_gaze && uniform, "with --falloff uniform", {"gaze-uncertainty"}},
  };
}

}  // namespace

Warnings idle_option_warnings(const OptionTable& table, const JobSettings& job) {
  Warnings warnings;
  std::set<std::string> said;
  for (const IdleGroup& group : idle_groups(job)) {
    for (const std::string& name : group.options) {
      const OptionEntry* entry = group.idle ? table.find(name) : nullptr;
      if (entry != nullptr && *entry->given && entry->values() != entry->defaults && said.insert(name).second) {
        warnings.push_back(fmt::format("--{} does nothing {}", name, group.why));
      }
    }
  }
  return warnings;
}

}  // namespace gazetrace
