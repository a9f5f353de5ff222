// SPDX-License-Identifier: Apache-2.0
#include "job/exposure_probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "job/scene.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostProbes = 8;
constexpr int kProbeWidthPx = 128;
constexpr double kProbeSpp = 2;  // 512 samples in each of the blocks whose means count
constexpr double kStepsOfAStop = 100;

// Those of the whole sequence whose views exist, or of the job where its sequence has no length that makes sense.
std::vector<std::int32_t> frames_to_probe(const JobSettings& job, const ViewInputs& inputs, const PlanSettings& plan) {
  std::vector<std::int32_t> frames;
  try {
    frames = frames_of_sequence(job, inputs);
  } catch (const Error&) {
    return plan.frames;
  }
  std::erase_if(frames, [&](std::int32_t frame) { return !has_frame(inputs.camera, plan, frame); });
  return frames.empty() ? plan.frames : frames;
}

}  // namespace

FramePlan plan_exposure_probe(const JobSettings& job, const ViewInputs& inputs, PlanSettings plan) {
  if (job.exposure.mode == ExposureMode::fixed) {
    return {};
  }
  const std::vector<std::int32_t> all = frames_to_probe(job, inputs, plan);
  const bool rests = inputs.camera.is_static && (inputs.scene == nullptr || !moves(*inputs.scene));
  const std::size_t count = rests ? 1 : std::min(all.size(), kMostProbes);
  plan.frames.clear();
  for (std::size_t i = 0; i < count; ++i) {
    plan.frames.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);  // in the middle of its share
  }
  const int width = std::min(plan.width_px, kProbeWidthPx);
  plan.height_px =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(plan.height_px) * width / plan.width_px)));
  plan.width_px = width;
  plan.camera_extrapolation = CameraExtrapolation::hold;  // what lies beyond the path was told of the job's own plan
  return plan_frames(inputs.camera, nullptr, plan, nullptr);
}

void settle_exposure(PathTracer& tracer, ResolvedJob& resolved) {
  const std::vector<FrameRequest>& probes = resolved.exposure_probe.frames;
  ExposureSettings& exposure = resolved.pipeline.exposure;
  if (exposure.mode == ExposureMode::fixed || probes.empty()) {
    return;
  }
  FrameSettings settings;
  settings.foveation.sampling = UniformSampling();
  settings.foveation.spp = kProbeSpp;
  settings.trace = resolved.pipeline.trace;
  settings.trace.seed = 0;
  settings.trace.guiding = false;
  settings.trace.only_pixel.reset();
  settings.reconstruction = {"none"};
  settings.exposure = exposure;
  settings.threads = resolved.pipeline.threads;
  const FrameRenderer renderer(tracer, std::move(settings));
  double sum = 0;
  std::vector<std::int32_t> frames;
  for (const FrameRequest& probe : probes) {
    sum += renderer.render(probe).exposure_ev;
    frames.push_back(probe.frame);
  }
  const double ev = std::round(sum / static_cast<double>(probes.size()) * kStepsOfAStop) / kStepsOfAStop;
  exposure = {ExposureMode::fixed, ev, exposure.key};
  resolved.decisions.emplace_back(
      "exposure",
      fmt::format("{:.2f} stops for all frames, from a look at frame{} {} of the sequence (`exposure` changes it)", ev,
                  frames.size() == 1 ? "" : "s", format_frame_list(frames)));
}

}  // namespace gazetrace
