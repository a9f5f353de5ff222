// SPDX-License-Identifier: Apache-2.0
// What can be told against a reference that has noise of its own, before any row is measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

// By how much the noise of a reference moves a score of `level_jod`, where its halves score `floor_jod` against each
// other.
double moved_jod(double floor_jod, double level_jod);
// About as many samples a pixel as a reference needs where it has `spp` and its halves score `floor`: until its noise
// moves a JOD of `level` by less than 0.1, and until its halves score `level` by other metrics.
double samples_needed(const std::string& metric, double floor, double level, double spp);

// The highest level in JOD at which a sweep compares times; empty: none.
std::optional<double> highest_jod(const SweepMeasure& measure);
// The lowest of the floors in JOD; empty where no gaze is scored so.
std::optional<double> lowest_jod(const std::vector<ResultFloor>& floors);

// The samples a pixel of the next attempt at a reference that is to be known well enough; empty where it is, or has
// `most_spp`.
std::optional<double> next_samples(const SweepMeasure& measure, const std::vector<ResultFloor>& floors, double spp,
                                   double most_spp);

// "fovvideovdp 9.61, flip 0.021 (gaze left)": how well the reference is known, by the metrics that have levels.
std::string known_to(const SweepMeasure& measure, const std::vector<ResultFloor>& floors);
// Error(input) where a metric can tell none of the levels that are asked of it, with the samples that would do.
void check_levels(const SweepPlan& plan, const SweepReference& reference, const std::vector<ResultFloor>& floors,
                  double spp);

}  // namespace gazetrace
