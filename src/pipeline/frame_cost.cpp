// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_cost.hpp"

#include <algorithm>

#include "pipeline/adaptive_rates.hpp"
#include "pipeline/first_look.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSpp = 1.0 / 16;

// Samples of a pilot are traced in pilot_ms, those of a first look in trace_ms.
double traced_samples(const TimingRow& row) {
  return std::max(1.0, static_cast<double>(row.samples - (row.pilot_ms > 0 ? row.pilot_samples : 0)));
}

// Of all but tracing and learning; of a pilot, what its samples do not take.
double fixed_ms_of(const TimingRow& row, double sample_ms) {
  return row.plan_ms + row.guides_ms + row.reconstruct_ms + row.temporal_ms + row.exposure_ms + row.layers_ms +
         row.color_ms + row.write_ms + std::max(0.0, row.pilot_ms - sample_ms * static_cast<double>(row.pilot_samples));
}

}  // namespace

FrameCost cost_of(const TimingRow& row) {
  FrameCost cost;
  cost.samples = traced_samples(row);
  cost.sample_ms = row.trace_ms / cost.samples;
  cost.fixed_ms = fixed_ms_of(row, cost.sample_ms);
  return cost;
}

FrameCost cost_of(const TimingRow& row, const FrameCost& known, double telling_ms) {
  FrameCost cost = cost_of(row);
  cost.filter_share = known.filter_share;
  const double expected_ms = known.base_ms + known.sample_ms * traced_samples(row);
  if (std::max(row.trace_ms, expected_ms) < telling_ms) {
    cost.base_ms = known.base_ms;
    cost.sample_ms = known.sample_ms;
    cost.fixed_ms = fixed_ms_of(row, known.sample_ms);
    return cost;
  }
  if (expected_ms > 0) {
    cost.base_ms = known.base_ms * row.trace_ms / expected_ms;
    cost.sample_ms = known.sample_ms * row.trace_ms / expected_ms;
  }
  return cost;
}

FrameCost mean_cost(const FrameCost& known, const FrameCost& next) {
  const auto mean = [](double before, double now) {
    return now < before ? 2 * before * now / (before + now) : 0.5 * (before + now);
  };
  return {mean(known.fixed_ms, next.fixed_ms), mean(known.base_ms, next.base_ms), mean(known.sample_ms, next.sample_ms),
          0.5 * (known.samples + next.samples), 0.5 * (known.filter_share + next.filter_share)};
}

FrameCost with_slope(FrameCost cost, const TracedSamples& more, const TracedSamples& fewer) {
  const double slope = (more.trace_ms - fewer.trace_ms) / std::max(1.0, more.samples - fewer.samples);
  // Chance may make it anything; the cost of a sample falls with the rate, and not without end.
  constexpr double kLeastOfMean = 0.4;
  const double mean = more.trace_ms / std::max(1.0, more.samples);
  cost.sample_ms = std::clamp(slope, kLeastOfMean * mean, mean);
  cost.base_ms = (mean - cost.sample_ms) * more.samples;
  return cost;
}

double affordable_spp(double budget_ms, const FrameCost& cost, double pixels, double least, double most) {
  // What the filter takes for samples, up to one a pixel.
  const double filter_ms = cost.filter_share * cost.sample_ms;
  const double without_ms = std::max(0.0, cost.fixed_ms - filter_ms * std::min(cost.samples, pixels));
  const double left_ms = std::max(0.0, budget_ms - without_ms - cost.base_ms);
  double samples = left_ms / std::max(cost.sample_ms + filter_ms, 1e-12);
  if (samples > pixels) {
    samples = (left_ms - filter_ms * pixels) / std::max(cost.sample_ms, 1e-12);
  }
  return std::clamp(samples / pixels, std::min(least, most), most);
}

double least_budget_spp(const FoveationSettings& foveation, const FrameRequest& request) {
  constexpr double kRoom = 1.25;
  double least = foveation.min_spp > 0 ? foveation.min_spp : kLeastSpp;
  if (foveation.falloff == "visible") {
    least = std::max(least, kRoom * least_pilot_spp(request));
  } else if (foveation.contrast_strength > 0 && request.gaze_direction_render) {
    least = std::max(least, kRoom * first_look_spp(request));
  }
  return least;
}

}  // namespace gazetrace
