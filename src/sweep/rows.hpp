// SPDX-License-Identifier: Apache-2.0
// The rows of a sweep: the tests that the plan asks for, and the baselines beside them.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"
#include "sweep/frames.hpp"
#include "sweep/runs.hpp"

namespace gazetrace {

// A row with everything that is needed to render it. Rows with the same `digest` and reference show the same pixels:
// they are rendered once, and scored with the gaze of each.
struct PlannedRow {
  MeasuredRow row;
  PipelineSettings pipeline;
  FramePlan plan;        // at the size that is rendered
  RasterSize size;       // the size that is compared
  std::string digest;    // of everything that its pixels depend on except the seed
  std::size_t test = 0;  // index into SweepPlan::tests of the test that it was made from
  std::string uniform;   // SweepTest::uniform_digest
};

PlannedRow test_row(const SweepPlan& plan, std::size_t test);
// Whether samples go where gaze or a picture says; only such tests have baselines.
bool is_foveated(const SweepTest& test);

// The rows that are known before anything is measured: the full rate, the ladder of rates, and wrong gazes. A note is
// added to `notes` for each wrong gaze that is left out.
std::vector<PlannedRow> baselines_known_before(const SweepPlan& plan, const PlannedRow& test,
                                               std::vector<std::string>& notes);
// The rows that follow from how many samples the test takes: as many spread evenly, and as many at the full rate on
// fewer pixels. `spp` is the mean of the test over all frames.
std::vector<PlannedRow> baselines_of_samples(const SweepPlan& plan, const PlannedRow& test, double spp);
PlannedRow uniform_row(const SweepPlan& plan, const PlannedRow& test, RowRole role, double spp);

// A row with the test's regions at one rate everywhere, whose times tell what a sample costs in each region. Only tests
// with regions have one.
std::optional<PlannedRow> cost_row(const SweepPlan& plan, const PlannedRow& test);

// Samples a pixel that a test takes, by its maps.
double planned_spp(const PlannedRow& row);

}  // namespace gazetrace
