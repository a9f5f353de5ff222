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
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kBaseTag = 0x42415345ULL;  // "BASE"
constexpr std::size_t kStills = 2;                 // by which FLIP is judged

std::optional<Vec2d> gaze_px(const FrameRequest& request) {
  if (!request.gaze_direction_true || request.gaze_true.no_gaze) {
    return std::nullopt;
  }
  return request.view.pixel(*request.gaze_direction_true);
}

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
  ++looks_;
  spp_ = spp;
  base_ = std::move(rendered.frame.radiance);
  exposure_ev_ = choose_exposure_ev(base_, 0, settings_.exposure, none);
  code_ = code_of(base_);
  luminance_ = display_luminance(code_, {}, settings_.threads);
}

// As `compare` reads pictures: in 8 bits.
ImageRgb ReplicaClip::code_of(const ImageRgb& radiance) const {
  constexpr int kBits = 8;
  constexpr float kMostCode = 255;
  const DisplayImage image = color_.apply(radiance, exposure_ev_, kBits, settings_.threads);
  ImageRgb code(radiance.width_px, radiance.height_px);
  const auto width = static_cast<std::size_t>(radiance.width_px);
  parallel_for(static_cast<std::size_t>(radiance.height_px), settings_.threads, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      const std::uint8_t* bytes = &image.bytes[3 * i];
      code.pixels[i] = {static_cast<float>(bytes[0]) / kMostCode, static_cast<float>(bytes[1]) / kMostCode,
                        static_cast<float>(bytes[2]) / kMostCode};
    }
  });
  return code;
}

std::int64_t ReplicaClip::reach() const {
  return settings_.accumulate.mode == AccumulateMode::two_sided ? settings_.accumulate.window : 0;
}

SummedFrames ReplicaClip::summed_in(std::int64_t frame) const {
  const std::int64_t first = std::max<std::int64_t>(1, frame - reach());
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(frame + reach() + 1 - first)};
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
  const PlanarView& view = judged_.runs.front().front().view;
  FovVideoVdpSettings metric_settings;
  metric_settings.geometry = fovvideovdp_geometry(view);
  metric_settings.frames_per_second = is_still ? 0 : settings_.frames_per_second;
  metric_settings.threads = settings_.threads;
  // The first frames of the sequence stand for themselves, those that have all before them in view for all the others.
  // What is added up at rest grows until a window has filled: the runs in the middle and at the end show that.
  double early = 0;
  double late = 0;
  double early_frames = 0;
  double late_frames = 0;
  std::size_t index = 0;
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    FovVideoVdp metric(metric_settings, view.width_px, view.height_px);
    for (std::size_t i = 0; i < run.size(); ++i, ++index) {
      const ImageGray seen = display_luminance(
          code_of(noise.noisy(base_, share, is_still ? example_of(1, index) : summed_in(run[i].frame))), {},
          settings_.threads);
      const std::optional<Vec2d> gaze = gaze_px(run[i]);
      // Where a window still fills, the first run stands for itself alone.
      const bool fills = reach() > 0 && judged_.runs.size() > 1 && &run == &judged_.runs.front();
      const bool is_late = !fills && i + 1 >= static_cast<std::size_t>(metric.taps());
      if (!gaze || (!is_late && &run != &judged_.runs.front())) {
        metric.prime(luminance_, seen);
        continue;
      }
      (is_late ? late : early) += metric.add(luminance_, seen, gaze).q;
      (is_late ? late_frames : early_frames) += 1;
    }
  }
  if (!(early_frames + late_frames > 0)) {
    throw Error(ErrorKind::input, "`target-jod`", "none of the frames by which the sequence is judged has a gaze",
                "check `gaze-start` and `gaze-offset`");
  }
  if (!(late_frames > 0)) {
    return early / early_frames;
  }
  const double rest = std::max(0.0, judged_.sequence_frames - early_frames);
  return (early + rest * late / late_frames) / (early_frames + rest);
}

double ReplicaClip::flip_at(const ReplicaNoise& noise, double share) const {
  MetricSettings metric;
  metric.pixels_per_degree = 1 / (judged_.runs.front().front().view.step_x * kDegPerRad);
  metric.threads = settings_.threads;
  const auto flip_of = [&](std::int64_t frame) {
    double sum = 0;
    for (std::size_t i = 0; i < kStills; ++i) {
      sum += measure("flip", {{}, code_}, {{}, code_of(noise.noisy(base_, share, example_of(frame, i)))}, metric).mean;
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
