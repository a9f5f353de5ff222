// SPDX-License-Identifier: Apache-2.0
#include "job/sampling_notes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/foveation.hpp"
#include "gazetrace/frame_renderer.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastSaving = 1.1;

std::string name_of(const Sampling& sampling) {
  const auto* density = std::get_if<DensitySampling>(&sampling);
  return density == nullptr ? "`sampling` " + to_string(sampling) : "`density` " + to_string(*density);
}

// Where the gaze decides nothing, or where rates are known only once a frame is looked at.
std::string rates_without_gaze(const FoveationSettings& foveation) {
  const SamplingTraits traits = traits_of(foveation.sampling);
  if (foveation.target.is_given()) {
    return "as many samples as the stated quality takes";
  }
  if (!foveation.spp && traits.follows_picture && !traits.looks_first) {
    return "as many samples as the picture states";
  }
  return fmt::format("{} samples a pixel {}", foveation.spp.value_or(kUsualSpp),
                     !traits.follows_picture ? "everywhere, wherever the eye looks"
                     : traits.looks_first    ? "on average, more where a pilot of the frame finds noise"
                                             : "on average, spread by the picture");
}

std::string remedies(const Sampling& sampling) {
  if (regions_of(sampling) != nullptr) {
    return "smaller `region-eccentricities`, or a `screen` that fills more of the field of view, would change that";
  }
  return "a larger `size`, a `density` such as acuity:relative-to=fovea or `sampling` regions would change that";
}

}  // namespace

SamplingNotes sampling_notes(const Job& job, const FramePlan& plan) {
  const FoveationSettings& foveation = job.settings.foveation;
  const auto frame = std::find_if(plan.frames.begin(), plan.frames.end(), [](const FrameRequest& request) {
    return request.gaze_direction_render.has_value();
  });
  const SamplingTraits traits = traits_of(foveation.sampling);
  if (frame == plan.frames.end() && !traits.follows_picture) {
    return {};
  }
  if (!traits.needs_gaze || foveation.target.is_given()) {
    return {name_of(foveation.sampling) + ": " + rates_without_gaze(foveation), {}};
  }
  const PlannedRates rates = planned_rates(foveation, *frame, job.settings.trace.seed, job.settings.threads);
  const double saving = rates.most_spp / rates.mean_spp;
  SamplingNotes notes;
  notes.decision = fmt::format("{}: {:.3g} samples a pixel in frame {}, {:.3g} where the eye looks",
                               name_of(foveation.sampling), rates.mean_spp, frame->frame, rates.most_spp);
  if (saving >= kLeastSaving) {
    return notes;
  }
  const double pixels_a_degree = 1 / (frame->view.step_x * kDegPerRad);
  if (!job.sources.contains("sampling")) {
    notes.decision += fmt::format(
        "; nearly uniform, since at {:.1f} pixels a degree the eye resolves nearly all of them", pixels_a_degree);
    return notes;
  }
  notes.warnings.push_back(
      fmt::format("{} saves only {:.2f} times the samples in frame {}: at {}x{} a degree has {:.1f} pixels, "
                  "and nearly all of them keep their full rate; {}",
                  name_of(foveation.sampling), saving, frame->frame, frame->width_px, frame->height_px, pixels_a_degree,
                  remedies(foveation.sampling)));
  return notes;
}

}  // namespace gazetrace
