// SPDX-License-Identifier: Apache-2.0
// How much there is to do, before anything is rendered.
#include <memory>
#include <optional>
#include <set>

#include "sweep/reference.hpp"
#include "sweep/rows.hpp"

namespace gazetrace {
namespace {

// The frames of each reference that are rendered. References of one scene follow each other, so that each scene is
// loaded once and only one is in memory.
std::vector<FramePlan> pictures_of_references(const SweepPlan& plan) {
  std::vector<FramePlan> pictures;
  std::shared_ptr<const Scene> scene;
  std::size_t loaded = plan.scenes.size();
  for (const SweepReference& reference : plan.references) {
    if (!scene_decides_pictures(reference)) {
      pictures.push_back(reference.plan);
      continue;
    }
    if (loaded != reference.scene) {
      scene.reset();
      scene = plan.scenes[reference.scene].load();
      loaded = reference.scene;
    }
    pictures.push_back(only_frames(reference.plan, reference_pictures(reference, *scene)));
  }
  return pictures;
}

}  // namespace

SweepEstimate estimate_sweep(const SweepPlan& plan) {
  SweepEstimate estimate;
  const auto add = [&](const PlannedRow& row, double spp, int repeats) {
    double pixels = 0;
    for (const FrameRequest& request : row.plan.frames) {
      pixels += static_cast<double>(request.width_px) * request.height_px;
    }
    estimate.rows.push_back({row.row.id, row.row.scene + "/" + row.row.gaze + " " + row.row.label,
                             to_string(row.row.role), spp * pixels, repeats});
    estimate.samples += spp * pixels * repeats;
  };
  const std::vector<FramePlan> pictures = pictures_of_references(plan);
  for (std::size_t r = 0; r < pictures.size(); ++r) {
    const SweepReference& reference = plan.references[r];
    PlannedRow row;
    row.row.id = "reference";
    row.row.label = reference.key;
    row.row.scene = plan.scenes[reference.scene].name;
    row.plan = pictures[r];
    const auto scramblings = static_cast<double>(reference.seeds.size());
    const double spp =
        reference.most_spp ? *reference.most_spp / scramblings : reference.pipeline.foveation.spp.value_or(kUsualSpp);
    row.row.label += reference.most_spp ? ", at most" : "";
    add(row, spp, static_cast<int>(reference.seeds.size()));
    estimate.rows.back().role = "reference";
  }
  std::set<std::string> known;
  for (std::size_t t = 0; t < plan.tests.size(); ++t) {
    const PlannedRow test = test_row(plan, t);
    const double spp = planned_spp(test);
    add(test, spp, plan.measure.repeats);
    if (const std::optional<PlannedRow> cost = cost_row(plan, test)) {
      add(*cost, planned_spp(*cost), 1);
      estimate.rows.back().role = "cost-by-region";
    }
    std::vector<std::string> notes;
    std::vector<PlannedRow> rows = baselines_known_before(plan, test, notes);
    std::vector<PlannedRow> more = baselines_of_samples(plan, test, spp);
    if (plan.measure.baselines.equal_time && is_foveated(plan.tests[t])) {
      more.push_back(uniform_row(plan, test, RowRole::equal_time, spp));
      more.back().row.label = "uniform, equal time: about so many samples";
    }
    rows.insert(rows.end(), more.begin(), more.end());
    for (const PlannedRow& row : rows) {
      if (row.row.role == RowRole::equal_time || known.insert(row.digest + row.row.reference).second) {
        add(row, planned_spp(row), plan.measure.repeats);
      }
    }
  }
  return estimate;
}

}  // namespace gazetrace
