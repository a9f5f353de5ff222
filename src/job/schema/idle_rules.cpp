// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gazetrace {

bool has_gaze_log(const JobSettings& job) {
  return !job.gaze.path.empty();
}

bool has_gaze(const JobSettings& job) {
  return has_gaze_log(job) || job.gaze_at.has_value();
}

JobIdleRule without_gaze() {
  return {"without gaze", [](const JobSettings& job) { return !has_gaze(job); }};
}

JobIdleRule without_density() {
  return {"without gaze (unless `sampling` follows a picture)",
          [](const JobSettings& job) { return !has_gaze(job) && !follows_picture(job.foveation.sampling); },
          [](const JobSettings&) { return std::string("without gaze"); }};
}

JobIdleRule without_gaze_log() {
  return {"without a gaze log", [](const JobSettings& job) { return !has_gaze_log(job); }};
}

JobIdleRule with_uniform() {
  return {"with `sampling` uniform", [](const JobSettings& job) { return is_uniform(job.foveation.sampling); }};
}

JobIdleRule with_regions() {
  return {"with `sampling` regions",
          [](const JobSettings& job) { return regions_of(job.foveation.sampling) != nullptr; }};
}

JobIdleRule without_regions() {
  return with_other_sampling("regions");
}

JobIdleRule without_window() {
  return {"without `accumulate` window",
          [](const JobSettings& job) { return job.accumulate.mode == AccumulateMode::off; }};
}

JobIdleRule without_aov(const std::string& name) {
  return {fmt::format("without `aov` {}{}", name, name.ends_with('_') ? "object, _material or _asset" : ""),
          [name](const JobSettings& job) {
            return std::none_of(job.exr.aovs.begin(), job.exr.aovs.end(),
                                [&](const std::string& aov) { return aov.starts_with(name); });
          }};
}

JobIdleRule without_coverage() {
  const JobIdleRule mattes = without_aov("crypto_");
  return {"without `alpha`, and " + mattes.words,
          [holds = mattes.holds](const JobSettings& job) { return !job.exr.alpha && holds(job); }};
}

JobIdleRule without_automatic_exposure() {
  return {"without `exposure` auto",
          [](const JobSettings& job) { return job.exposure.mode != ExposureMode::log_average; }};
}

JobIdleRule with_lights_sampled_alone() {
  return {"with `light-sampling` light",
          [](const JobSettings& job) { return job.trace.light_sampling == LightSampling::light_only; }};
}

JobIdleRule with_other_sampling(const std::string& name) {
  return {fmt::format("with another `sampling` than {}", name),
          [name](const JobSettings& job) { return traits_of(job.foveation.sampling).name != name; },
          [](const JobSettings& job) { return fmt::format("with `sampling` {}", to_string(job.foveation.sampling)); }};
}

}  // namespace gazetrace
