// SPDX-License-Identifier: Apache-2.0
// What the results state about a sweep before anything is measured.
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/version.hpp"
#include "sweep/conclude.hpp"
#include "sweep/model_gain_of_test.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

ResultViewing viewing_of(const SweepPlan& plan) {
  const FrameRequest& request = plan.tests.front().plan.frames.front();
  const DisplayPhotometry& photometry = plan.measure.comparison.photometry;
  ResultViewing viewing;
  viewing.size_px = {request.width_px, request.height_px};
  viewing.pixels_per_degree = 1 / (request.view.step_x * kDegPerRad);
  viewing.width_deg = std::atan(request.view.step_x * request.width_px / 2) * 2 * kDegPerRad;
  viewing.peak_cd_m2 = photometry.peak_cd_m2;
  viewing.contrast = photometry.contrast;
  viewing.ambient_lux = photometry.ambient_lux;
  constexpr double kLevelJod = 9.5;
  constexpr NoiseCut kCut{4, 0.1};
  viewing.model_gain = model_gain_of_test(plan.tests.front(), kLevelJod);
  viewing.model_gain_cut_4_cpd = model_gain_of_test(plan.tests.front(), kLevelJod, kCut);
  return viewing;
}

// In the order of the plan, which is that of all tables.
std::vector<ResultMetric> metrics_of(const SweepPlan& plan) {
  const std::vector<MetricInfo> known = comparison_metrics();
  std::vector<ResultMetric> metrics;
  for (const std::string& name : plan.measure.comparison.metrics) {
    const auto info = std::find_if(known.begin(), known.end(), [&](const MetricInfo& one) { return one.name == name; });
    if (info != known.end()) {
      metrics.push_back({name, metric_unit(name), info->description, info->better == MetricDirection::lower});
    }
  }
  return metrics;
}

}  // namespace

Results facts_of_plan(const SweepPlan& plan) {
  Results results;
  results.title = plan.title;
  results.plan_file = plan.plan_file;
  results.build = {kVersion, build_digest(), build_description(), instruction_set()};
  results.machine = {machine_description(), resolve_threads(plan.tests.front().pipeline.threads)};
  results.viewing = viewing_of(plan);
  results.view = ColorPipeline(plan.references.front().color).description();
  results.common_settings = plan.common_settings;
  results.varied = plan.varied;
  results.repeats = plan.measure.repeats;
  results.bands_deg.assign(kEccentricityBandsDeg.begin(), kEccentricityBandsDeg.end());
  const auto& regions_deg = plan.measure.comparison.regions.end_deg;
  results.regions_deg.assign(regions_deg.begin(), regions_deg.end());
  results.metrics = metrics_of(plan);
  return results;
}

}  // namespace gazetrace
