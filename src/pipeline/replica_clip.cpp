// SPDX-License-Identifier: Apache-2.0
#include "pipeline/replica_clip.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/metrics.hpp"
#include "pipeline/clip_score.hpp"
#include "pipeline/trace_counts.hpp"
#include "temporal/frames_at_rest.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kBaseTag = 0x42415345ULL;  // "BASE"
constexpr std::size_t kStills = 2;                 // by which FLIP is judged

}  // namespace

ReplicaClip::ReplicaClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                         const ColorPipeline& color)
    : tracer_(tracer), judged_(judged), settings_(settings), color_(color) {}

void ReplicaClip::look(double spp, std::uint64_t round) {
  if (2 * spp_ >= spp) {
    return;
  }
  FrameSettings base = discarded_settings(settings_, spp, hash_combine(kBaseTag, round));
  base.reconstruction = {"guided", {}};
  TemporalHistory none;
  RenderedFrame rendered = FrameRenderer(tracer_, base).render(judged_.runs.front().front(), none);
  add_traces(rendered.samples, stats_);
  add_traces(rendered.first_look, stats_);
  ++looks_;
  spp_ = spp;
  base_ = std::move(rendered.frame.radiance);
  exposure_ev_ = choose_exposure_ev(base_, 0, settings_.exposure, none);
  code_ = shown_code(base_, color_, exposure_ev_, settings_.threads);
  luminance_ = display_luminance(code_, {}, settings_.threads);
}

std::int64_t ReplicaClip::reach() const {
  return settings_.accumulate.mode == AccumulateMode::two_sided ? settings_.accumulate.window : 0;
}

SummedFrames ReplicaClip::summed_in(std::int64_t frame) const {
  if (reach() == 0) {
    return {static_cast<std::size_t>(frame), 1};
  }
  const ShownAtRest shown = shown_at_rest(frame, frame + reach(), settings_.accumulate);
  const std::int64_t first = std::max<std::int64_t>(1, shown.first);
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(shown.last + 1 - first)};
}

SummedFrames ReplicaClip::example_of(std::int64_t frame, std::size_t n) const {
  const SummedFrames one = summed_in(frame);
  return {one.first + n * one.count, one.count};
}

double ReplicaClip::most_summed() const {
  return static_cast<double>(summed_in(judged_.sequence_frames).count);
}

double ReplicaClip::q_at(const ReplicaNoise& noise, double share) const {
  const bool is_still = judged_.sequence_frames == 1;
  const auto shown = [&](const FrameRequest& request, std::size_t index) {
    const SummedFrames frames = is_still ? example_of(1, index) : summed_in(request.frame);
    return display_luminance(shown_code(noise.noisy(base_, share, frames), color_, exposure_ev_, settings_.threads), {},
                             settings_.threads);
  };
  const auto reference = [&](std::size_t) -> const ImageGray& { return luminance_; };
  return clip_q(judged_, reference, shown, {settings_.frames_per_second, reach() > 0, {}, settings_.threads});
}

double ReplicaClip::flip_at(const ReplicaNoise& noise, double share) const {
  MetricSettings metric;
  metric.pixels_per_degree = 1 / (judged_.runs.front().front().view.step_x * kDegPerRad);
  metric.threads = settings_.threads;
  const auto flip_of = [&](std::int64_t frame) {
    double sum = 0;
    for (std::size_t i = 0; i < kStills; ++i) {
      sum += measure(
                 "flip", {{}, code_},
                 {{},
                  shown_code(noise.noisy(base_, share, example_of(frame, i)), color_, exposure_ev_, settings_.threads)},
                 metric)
                 .mean;
    }
    return sum / static_cast<double>(kStills);
  };
  // The first frames are judged by the first of them and by the first whose window is full.
  const std::int64_t frames = judged_.sequence_frames;
  const std::int64_t filling = std::min(frames, reach() + 1);
  const double full = flip_of(filling);
  const double early = filling > 1 ? 0.5 * (flip_of(1) + full) : full;
  return (static_cast<double>(filling) * early + static_cast<double>(frames - filling) * full) /
         static_cast<double>(frames);
}

}  // namespace gazetrace
