// SPDX-License-Identifier: Apache-2.0
#include "job/saving.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/foveation.hpp"
#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSaving = 1.1;

bool is_known_before(const FoveationSettings& foveation) {
  return traits_of(foveation.sampling).needs_gaze && !foveation.target.is_given() && !foveation.spp;
}

std::string name_of(const Sampling& sampling) {
  const auto* density = std::get_if<DensitySampling>(&sampling);
  return density == nullptr ? "`sampling` " + to_string(sampling) : "`density` " + to_string(*density);
}

std::string remedies(const JobSettings& job) {
  if (regions_of(job.foveation.sampling) != nullptr) {
    return "smaller `region-eccentricities`, or a `screen` that fills more of the field of view, would change that";
  }
  return "a larger `size`, a `density` such as acuity:relative-to=fovea or `sampling` regions would change that";
}

}  // namespace

Warnings saving_warnings(const JobSettings& job, const FramePlan& plan) {
  const FoveationSettings& foveation = job.foveation;
  const auto frame = std::find_if(plan.frames.begin(), plan.frames.end(), [](const FrameRequest& request) {
    return request.gaze_direction_render.has_value();
  });
  if (!is_known_before(foveation) || frame == plan.frames.end()) {
    return {};
  }
  const RegionSampling* const regions = regions_of(foveation.sampling);
  const double full_rate = regions != nullptr ? regions->samples[0] : kUsualSpp;
  const SamplingMap map = planned_sampling_map(foveation, *frame, job.trace.seed, job.threads);
  const double all = full_rate * frame->width_px * frame->height_px;
  const double saving = all / std::max(1.0, static_cast<double>(map.samples()));
  if (saving >= kLeastSaving) {
    return {};
  }
  return {
      fmt::format("{} saves only {:.2f} times the samples in frame {}: at {}x{} a degree has {:.1f} pixels, "
                  "and nearly all of them keep their full rate; {}",
                  name_of(foveation.sampling), saving, frame->frame, frame->width_px, frame->height_px,
                  1 / (frame->view.step_x * kDegPerRad), remedies(job))};
}

}  // namespace gazetrace
