// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/window_clip.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/hash.hpp"
#include "pipeline/joined_frames.hpp"
#include "pipeline/quality/clip_score.hpp"
#include "pipeline/quality/discarded.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

// What is seen of an error is about this power of its mean square, so that squares can be taken off each other.
constexpr double kPowerOfSquare = 0.9;
// Of a picture alone: examples of it that are judged.
constexpr std::size_t kStillRuns = 2;

std::vector<Vec2d> looked_at(const JudgedFrames& judged) {
  std::vector<Vec2d> gazes;
  for (const std::vector<FrameRequest>& run : judged.runs) {
    for (const FrameRequest& request : run) {
      if (const std::optional<Vec2d> gaze = looked_at_px(request)) {
        gazes.push_back(*gaze);
      }
    }
  }
  return gazes;
}

// The frames that have a reference of their own: every judged one, or the first where all show the same.
std::vector<const FrameRequest*> seen(const JudgedFrames& judged) {
  std::vector<const FrameRequest*> views;
  for (const std::vector<FrameRequest>& run : judged.runs) {
    for (const FrameRequest& request : run) {
      if (judged.view_moves || views.empty()) {
        views.push_back(&request);
      }
    }
  }
  return views;
}

// A window of all judged frames, and of those that they read.
FramePlan plan_of_window(const JudgedFrames& judged, const PixelRect& window) {
  const bool is_still = judged.sequence_frames == 1;
  const std::int32_t first = judged.runs.front().front().frame;
  FramePlan plan;
  for (const std::vector<FrameRequest>& run : judged.runs) {
    for (const FrameRequest& request : run) {
      // Of a still the others are examples of it, or read by it.
      const bool is_shown = !is_still || request.frame == first;
      (is_shown ? plan.frames : plan.around).push_back(part_of(request, window));
    }
  }
  for (const FrameRequest& request : judged.around) {
    plan.around.push_back(part_of(request, window));
  }
  return plan;
}

}  // namespace

WindowClip::WindowClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                       const ColorPipeline& color)
    : tracer_(tracer),
      judged_(judged),
      settings_(settings),
      light_(tracer, judged, settings),
      windows_(judged_windows(first().view, looked_at(judged), judged.view_moves)),
      rates_(tracer, judged, windows_, settings, light_),
      around_(tracer, judged, windows_, settings, color, stats_),
      reference_(tracer, windows_, seen(judged), settings,
                 [this](const FrameRequest& request) { return light_.of(request.frame, stats_); }) {}

const FrameRequest& WindowClip::first_looked_at() const {
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    for (const FrameRequest& request : run) {
      if (looked_at_px(request)) {
        return request;
      }
    }
  }
  return first();
}

double WindowClip::share_of_frame() const {
  return windows_.share_of(first().view);
}

double WindowClip::counted_px() const {
  double pixels = 0;
  for (const JudgedWindow& window : windows_.windows) {
    pixels += static_cast<double>(window.counted.width_px) * window.counted.height_px;
  }
  return pixels;
}

TraceStats WindowClip::stats() const {
  TraceStats all = stats_;
  add_traces(reference_.stats(), all);
  return all;
}

void WindowClip::refine(double spp) {
  reference_.refine(spp);
  const WindowPictures& pictures = reference_.pictures();
  around_.expose(pictures);
  reference_shown_.clear();
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    reference_shown_.push_back(around_.shown(pictures[v], v));
  }
  // What stands still shows in one frame what it does in all.
  const JudgedFrames one{{{first_looked_at()}}, {}, judged_.sequence_frames, false};
  reference_q_ = measured_q(judged_.view_moves ? judged_ : one, reference_.as_far_off());
}

double WindowClip::measured_q(const JudgedFrames& judged, const WindowPictures& pictures) const {
  const auto reference = [&](std::size_t index) -> const ImageGray& { return reference_shown_[reference_of(index)]; };
  const auto frame = [&](std::size_t index) { return around_.shown(pictures[index % pictures.size()], index); };
  const bool fills = settings_.accumulate.mode == AccumulateMode::window;
  return clip_q(judged, reference, frame, {settings_.frames_per_second, fills, windows_.weights, settings_.threads});
}

double WindowClip::q_of(const WindowPictures& pictures) const {
  const double q = measured_q(judged_, pictures);
  // Errors of picture and reference have nothing in common: their squares add up.
  const auto square = [](double seen) { return std::pow(seen, 1 / kPowerOfSquare); };
  constexpr double kLeastShare = 0.1;
  return std::pow(std::max(square(q) - square(reference_q_), kLeastShare * square(q)), kPowerOfSquare);
}

std::size_t WindowClip::stills_a_look() const {
  return judged_.sequence_frames == 1 ? kStillRuns : 1;
}

std::vector<ImageRgb> WindowClip::look_at(std::size_t window, const FrameSettings& settings) {
  const FramePlan plan = plan_of_window(judged_, windows_.windows[window].traced);
  std::vector<ImageRgb> pictures;
  for (std::size_t example = 0; example < stills_a_look(); ++example) {
    FrameSettings own = settings;
    own.trace.seed = hash_combine(settings.trace.seed, example);
    render(plan, own, pictures);
  }
  return pictures;
}

void WindowClip::render(const FramePlan& plan, const FrameSettings& settings, std::vector<ImageRgb>& pictures) {
  const FrameRenderer renderer(tracer_, settings);
  std::set<std::int32_t> numbers;
  for (const FrameRequest& request : plan.frames) {
    numbers.insert(request.frame);
  }
  JoinedFrames frames(renderer, plan, numbers);
  for (const FrameRequest& request : plan.frames) {
    RenderedFrame rendered = frames.render(request);
    add_traces(rendered.samples, stats_);
    add_traces(rendered.others, stats_);
    pictures.push_back(std::move(rendered.frame.radiance));
  }
}

WindowPictures WindowClip::look(double spp, std::uint64_t round) {
  const bool same_everywhere = is_uniform(settings_.foveation.sampling);
  const RatesOfLook rates = same_everywhere ? RatesOfLook{} : rates_.of_look(spp, round, stats_);
  WindowPictures pictures;
  for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
    FrameSettings own = discarded(settings_, hash_combine(hash_combine(kLookTag, round), w));
    own.light_of = [&](const FrameRequest& request) { return light_.of(request.frame, stats_); };
    if (same_everywhere) {
      own.foveation.spp = spp;
    } else {
      // All that the sampling thinks of eye and picture is in the rates.
      if (!follows_picture(own.foveation.sampling)) {
        own.foveation.sampling = density_of_picture();
      }
      own.foveation.spp.reset();
      own.rates_of = [&](const FrameRequest& request) { return rates.of(request, w); };
    }
    std::vector<ImageRgb> of_window = look_at(w, own);
    pictures.resize(of_window.size());
    for (std::size_t frame = 0; frame < of_window.size(); ++frame) {
      pictures[frame].push_back(std::move(of_window[frame]));
    }
  }
  return pictures;
}

}  // namespace gazetrace
