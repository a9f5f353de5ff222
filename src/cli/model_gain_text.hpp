// SPDX-License-Identifier: Apache-2.0
// `plan --model-gain`: what eccentricity alone can save on a job's display, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/model_gain.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// What is assumed of the noise in one line of the result.
struct NoiseKind {
  std::string name;              // its key in JSON
  bool even_resolution = false;  // see ModelGainSettings
  double cut_below_cpd = 0;      // the power below this frequency is a tenth; 0: white noise
};

// Means over the frames that were looked at.
struct GainOfKind {
  NoiseKind kind;
  double gain = 1, uniform_spp = 0, allocated_spp = 0;
};
struct GainOfPlan {
  ModelGainSettings settings;
  double width_deg = 0, height_deg = 0, pixels_per_degree = 0;
  std::size_t frames = 0, frames_with_gaze = 0;  // looked at; of the plan
  std::vector<GainOfKind> kinds;
};

// By the unprocessed gaze of each frame; of long plans at most 24 frames are looked at, evenly spaced. Error(usage)
// where no frame has gaze.
GainOfPlan gain_of_plan(const FramePlan& plan, double frames_per_second, int threads);

std::string gain_as_text(const GainOfPlan& gain);
std::string gain_as_json(const GainOfPlan& gain);

}  // namespace gazetrace
