// SPDX-License-Identifier: Apache-2.0
// The rates of AdaptiveSampling: where a pilot of the frame says that samples are needed, as many as the budget
// or the target asks for.
//
// With e^2(x) the squared error of a pixel for each unit of 1/n, n(x) samples a pixel leave the error e^2 / n. The sum
// of relative squared errors, sum of e^2 / (n (L^2 + epsilon)), is least for a given sum of n where
//   n ~ e / sqrt(L^2 + epsilon)
// (Neyman's allocation). e^2 comes from a pilot's own estimate of its error after the filter, times the rate that the
// pilot had there, so that light that the filter smooths well gets less. With gaze, the eye's sensitivity weighs it
// (VisibleNoise::wanted_by_eye()), but not with QualityTarget::relmse, whose measure knows no eye.
#pragma once

#include <optional>

#include "pipeline/quality/pilot.hpp"

namespace gazetrace {

struct AdaptiveRates {
  ImageGray rates;  // samples a pixel of the frame, at the pilot's size
  double spp = 0;   // their mean
  Prediction prediction;
  TraceStats pilot;  // of all rounds
  int rounds = 0;
};

// Rates in proportion to `wanted` with a mean of `spp`, where none is below `least` or above `most` (but for a mean
// that lies outside of them, which is kept).
ImageGray rates_between(const ImageGray& wanted, double spp, double least, double most);

// Error(usage) for a budget that the first pilot would use up. Traces nothing.
void check_pilot_budget(const FoveationSettings& settings, const FrameRequest& request);

// What the first pilot takes of the smallest budgets, in samples a pixel of the frame (but for rounding at its edges).
double least_pilot_spp(const FrameRequest& request);

// A function of request and settings alone. Error(usage) as check_pilot_budget().
AdaptiveRates adaptive_rates(const PosedScene& scene, const FrameRequest& request, const FrameSettings& settings);

}  // namespace gazetrace
