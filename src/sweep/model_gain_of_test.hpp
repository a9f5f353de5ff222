// SPDX-License-Identifier: Apache-2.0
// What sampling by eccentricity alone can save in a test of a sweep, beside which its measured gain stands.
#pragma once

#include <optional>

#include "gazetrace/model_gain.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

// By model_gain(), with the gaze of the test's first frame. Of a fraction of the power below this frequency:
// cut_error().
struct NoiseCut {
  double below_cpd = 0;  // 0: white noise
  double factor = 1;
};
// Empty without gaze, and for qualities that model_gain() does not know: it is for 5 JOD and more.
std::optional<double> model_gain_of_test(const SweepTest& test, double target_jod, const NoiseCut& cut = {});

// Fills ResultFixedQuality::model_gain of levels in JOD.
void add_model_gains(const SweepPlan& plan, std::vector<ResultFixedQuality>& speed_ups);

}  // namespace gazetrace
