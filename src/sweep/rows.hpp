// SPDX-License-Identifier: Apache-2.0
// The rows of a sweep: what the plan asks for, and the baselines beside it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/frames.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// A row with all that it takes to render it. Rows of equal `digest` and reference show the same pixels: they are
// rendered once, and scored with the gaze of each.
struct PlannedRow {
  MeasuredRow row;
  PipelineSettings pipeline;
  FramePlan plan;        // of the size that is rendered
  RasterSize size;       // that is compared
  std::string digest;    // of its pixels, seed aside
  std::size_t test = 0;  // in SweepPlan::tests, that it was made from
  std::string uniform;   // SweepTest::uniform_digest
};

PlannedRow test_row(const SweepPlan& plan, std::size_t test);
bool is_foveated(const SweepTest& test);  // baselines stand beside those only

// Rows that are known before anything is measured: the full rate, the ladder of rates, wrong gazes. `notes` is told of
// wrong gazes that are left out.
std::vector<PlannedRow> baselines_known_before(const SweepPlan& plan, const PlannedRow& test,
                                               std::vector<std::string>& notes);
// Rows that follow from the samples of the test: the same number everywhere, and at the full rate on fewer pixels.
// `spp` is the test's mean over all frames.
std::vector<PlannedRow> baselines_of_samples(const SweepPlan& plan, const PlannedRow& test, double spp);
PlannedRow uniform_row(const SweepPlan& plan, const PlannedRow& test, RowRole role, double spp);

// Regions of one rate everywhere, whose times tell what a sample costs in each; only of tests with regions.
std::optional<PlannedRow> cost_row(const SweepPlan& plan, const PlannedRow& test);

// Samples a pixel that a test takes, by its maps; a first look at the contrast is not counted.
double planned_spp(const PlannedRow& row);

}  // namespace gazetrace
