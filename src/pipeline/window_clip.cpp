// SPDX-License-Identifier: Apache-2.0
#include "pipeline/window_clip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/statistics.hpp"
#include "foveation/site_images.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/adaptive_rates.hpp"
#include "pipeline/clip_score.hpp"
#include "pipeline/discarded.hpp"
#include "pipeline/frame_window.hpp"
#include "pipeline/trace_counts.hpp"
#include "trace/guiding/learned_light.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kRatesTag = 0x5241544553ULL;     // "RATES"
constexpr std::uint64_t kAroundTag = 0x41524f554e44ULL;  // "AROUND"
constexpr double kAroundSpp = 1;
// What is seen of an error is about this power of its mean square, so that squares can be taken off each other.
constexpr double kPowerOfSquare = 0.9;
// Of a picture alone: examples of it that are judged.
constexpr std::size_t kStillRuns = 2;
constexpr std::size_t kMostLightBytes = std::size_t{256} << 20U;  // of what frames have learned, kept at once
constexpr std::uint64_t kPilots = 4;  // whose rates are averaged, where all frames share them

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

}  // namespace

WindowClip::WindowClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                       const ColorPipeline& color)
    : tracer_(tracer),
      judged_(judged),
      settings_(settings),
      color_(color),
      windows_(judged_windows(first().view, looked_at(judged), judged.view_moves)),
      reference_(tracer, windows_, seen(judged), settings,
                 [this](const FrameRequest& request) { return light_of(request.frame); }) {
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    for (const FrameRequest& request : run) {
      requests_.emplace(request.frame, &request);
    }
  }
  for (const FrameRequest& request : judged_.around) {
    requests_.emplace(request.frame, &request);
  }
  render_around();
}

void WindowClip::render_around() {
  const FrameSettings around = raw(discarded(settings_, kAroundTag), kAroundSpp, "guided");
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    if (!around_.empty() && !judged_.view_moves) {
      break;
    }
    around_.emplace_back();
    if (windows_.is_whole_frame()) {
      around_.back().radiance = ImageRgb(first().width_px, first().height_px);
      continue;
    }
    TemporalHistory none;
    RenderedFrame rendered = FrameRenderer(tracer_, around).render(run.front(), none);
    add_traces(rendered.samples, stats_);
    around_.back().radiance = std::move(rendered.frame.radiance);
  }
}

std::size_t WindowClip::around_of(std::size_t index) const {
  std::size_t run = 0;
  while (judged_.view_moves && index >= judged_.runs[run].size()) {
    index -= judged_.runs[run].size();
    ++run;
  }
  return run;
}

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

bool WindowClip::is_steady() const {
  const auto same = [&](const FrameRequest& request) {
    return request.gaze_direction_render == first().gaze_direction_render &&
           request.gaze_uncertainty_deg == first().gaze_uncertainty_deg &&
           request.eye_speed_deg_s == first().eye_speed_deg_s && request.eye_in_saccade == first().eye_in_saccade;
  };
  const auto all_same = [&](const std::vector<FrameRequest>& run) { return std::all_of(run.begin(), run.end(), same); };
  return !judged_.gaze_moves && !(settings_.foveation.falloff == "visible" && judged_.view_moves) &&
         std::all_of(judged_.runs.begin(), judged_.runs.end(), all_same) && all_same(judged_.around);
}

// The reference is pasted in first: what it shows decides the exposure.
void WindowClip::show_around() {
  for (Around& around : around_) {
    TemporalHistory none;
    around.exposure_ev = choose_exposure_ev(around.radiance, 0, settings_.exposure, none);
    const ImageRgb code = shown_code(around.radiance, color_, around.exposure_ev, settings_.threads);
    around.shown = display_luminance(code, {}, settings_.threads);
  }
}

void WindowClip::refine(double spp) {
  reference_.refine(spp);
  reference_shown_.clear();
  const WindowPictures& pictures = reference_.pictures();
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
      paste(pictures[v][w], windows_.windows[w].traced, around_[around_of(v)].radiance);
    }
  }
  show_around();
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    reference_shown_.push_back(shown(pictures[v], v));
  }
  // What stands still shows in one frame what it does in all.
  const JudgedFrames one{{{first_looked_at()}}, {}, judged_.sequence_frames, false};
  reference_q_ = measured_q(judged_.view_moves ? judged_ : one, reference_.as_far_off());
}

ImageGray WindowClip::shown(const std::vector<ImageRgb>& windows, std::size_t index) const {
  const Around& around = around_[around_of(index)];
  ImageGray luminance = around.shown;
  std::vector<ImageGray> parts;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const ImageRgb code = shown_code(windows[w], color_, around.exposure_ev, settings_.threads);
    parts.push_back(display_luminance(code, {}, settings_.threads));
    paste(parts.back(), windows_.windows[w].traced, luminance);
  }
  // Where foveae overlap, what counts is never the margin of another.
  for (std::size_t w = 0; w < parts.size(); ++w) {
    const JudgedWindow& window = windows_.windows[w];
    const PixelRect inner{window.counted.x_px - window.traced.x_px, window.counted.y_px - window.traced.y_px,
                          window.counted.width_px, window.counted.height_px};
    paste(cut_out(parts[w], inner), window.counted, luminance);
  }
  return luminance;
}

double WindowClip::measured_q(const JudgedFrames& judged, const WindowPictures& pictures) const {
  const auto reference = [&](std::size_t index) -> const ImageGray& { return reference_shown_[reference_of(index)]; };
  const auto frame = [&](const FrameRequest&, std::size_t index) {
    return shown(pictures[index % pictures.size()], index);
  };
  const bool fills = settings_.accumulate.mode == AccumulateMode::two_sided && settings_.accumulate.window > 0;
  return clip_q(judged, reference, frame, {settings_.frames_per_second, fills, windows_.weights, settings_.threads});
}

double WindowClip::q_of(const WindowPictures& pictures) const {
  const double q = measured_q(judged_, pictures);
  // Errors of picture and reference have nothing in common: their squares add up.
  const auto square = [](double seen) { return std::pow(seen, 1 / kPowerOfSquare); };
  constexpr double kLeastShare = 0.1;
  return std::pow(std::max(square(q) - square(reference_q_), kLeastShare * square(q)), kPowerOfSquare);
}

// Where the view rests, all frames are lit alike, and learn once.
std::shared_ptr<const LearnedLight> WindowClip::light_of(std::int32_t frame) {
  if (!settings_.trace.learn_light) {
    return nullptr;
  }
  const std::int32_t lit = judged_.view_moves ? frame : first().frame;
  if (const auto known = light_.find(lit); known != light_.end()) {
    return known->second;
  }
  if (!last_light_.request || last_light_.request->frame != lit) {
    const FrameRequest& whole = *requests_.at(lit);
    TraceSettings own = settings_.trace;
    own.seed = hash_combine(own.seed, kLookTag);
    LightLearning learning = tracer_.at({whole.shutter_open_ns, whole.shutter_close_ns})
                                 .learn_light(whole.camera, whole.width_px, whole.height_px, own);
    stats_.learning_paths += learning.paths;
    last_light_ = {whole, std::move(learning.light)};
  }
  // Frames that no longer fit learn anew for each window, bit by bit the same.
  const std::size_t bytes = last_light_.light ? last_light_.light->bytes() : 0;
  if (light_bytes_ + bytes <= kMostLightBytes) {
    light_bytes_ += bytes;
    light_.emplace(lit, last_light_.light);
  }
  return last_light_.light;
}

ImageGray WindowClip::pilot_rates(const FrameRequest& request, FrameSettings settings) {
  settings.trace.learned = light_of(request.frame);
  AdaptiveRates adaptive =
      adaptive_rates(tracer_.at({request.shutter_open_ns, request.shutter_close_ns}), request, settings);
  add_traces(adaptive.pilot, stats_);
  return std::move(adaptive.rates);
}

// Blocks share what they expect, as in the frame.
ImageGray WindowClip::expected_spp(const FrameRequest& request, double spp, std::uint64_t round) {
  FrameSettings own = discarded(settings_, hash_combine(kRatesTag, round));
  own.foveation.budget_spp = spp;
  SamplingMap map;
  if (own.foveation.falloff == "visible") {
    ImageGray rates;
    if (is_steady()) {
      // Of a pilot that may be larger than such a frame; what it says of the rates is brought to their mean.
      own.foveation.budget_spp = std::max(spp, 16 * least_pilot_spp(request));
      for (std::uint64_t k = 0; k < kPilots; ++k) {
        own.trace.seed = hash_combine(own.trace.seed, k);
        const ImageGray one = pilot_rates(request, own);
        if (rates.empty()) {
          rates = one;
          continue;
        }
        for (std::size_t i = 0; i < rates.pixels.size(); ++i) {
          rates.pixels[i] += one.pixels[i];
        }
      }
      rates = rates_between(rates, spp, own.foveation.min_spp, own.foveation.max_spp);
      shared_rates_ = rates;
    } else {
      rates = pilot_rates(request, own);
    }
    own.foveation.budget_spp = mean_of(rates);
    MapContext context = map_context(request, own.trace.seed, settings_.threads);
    context.density = &rates;
    map = make_sampling_map(own.foveation, request.view, request.gaze_direction_render, context);
  } else {
    map = planned_sampling_map(own.foveation, request, own.trace.seed, settings_.threads);
  }
  return expected_spp_of(map);
}

std::size_t WindowClip::stills_a_look() const {
  return judged_.sequence_frames == 1 ? kStillRuns : 1;
}

std::vector<ImageRgb> WindowClip::look_at(std::size_t window, const FrameSettings& settings) {
  const PixelRect& rect = windows_.windows[window].traced;
  const bool is_still = judged_.sequence_frames == 1;
  std::vector<ImageRgb> pictures;
  for (std::size_t example = 0; example < stills_a_look(); ++example) {
    FrameSettings own = settings;
    own.trace.seed = hash_combine(settings.trace.seed, example);
    const FrameRenderer renderer(tracer_, own);
    FramePlan plan;
    std::set<std::int32_t> numbers;
    for (const std::vector<FrameRequest>& run : judged_.runs) {
      for (const FrameRequest& request : run) {
        // Of a still the others are examples of it, or read by it.
        const bool is_shown = !is_still || request.frame == first().frame;
        (is_shown ? plan.frames : plan.around).push_back(part_of(request, rect));
        if (is_shown) {
          numbers.insert(request.frame);
        }
      }
    }
    for (const FrameRequest& request : judged_.around) {
      plan.around.push_back(part_of(request, rect));
    }
    std::optional<FrameWindow> joined;
    if (own.accumulate.mode == AccumulateMode::two_sided) {
      joined.emplace(renderer, plan, numbers);
    }
    TemporalHistory history;
    for (const FrameRequest& request : plan.frames) {
      RenderedFrame rendered = joined ? joined->render(request, history) : renderer.render(request, history);
      add_traces(rendered.samples, stats_);
      add_traces(rendered.others, stats_);
      pictures.push_back(std::move(rendered.frame.radiance));
    }
  }
  return pictures;
}

WindowPictures WindowClip::look(double spp, std::uint64_t round) {
  const bool is_uniform = settings_.foveation.falloff == "uniform";
  // Of each window by the number of the frame, or once for all of them.
  std::map<std::int32_t, std::vector<FrameRates>> rates;
  const bool is_same = is_steady();
  const auto number = [&](const FrameRequest& request) { return is_same ? 0 : request.frame; };
  const auto find_rates = [&](const std::vector<FrameRequest>& requests) {
    for (const FrameRequest& request : requests) {
      if (is_uniform || rates.contains(number(request))) {
        continue;
      }
      const ImageGray expected = expected_spp(request, spp, round);
      const double full = static_cast<double>(*std::max_element(expected.pixels.begin(), expected.pixels.end()));
      for (const JudgedWindow& window : windows_.windows) {
        rates[number(request)].push_back({cut_out(expected, window.traced), full});
      }
    }
  };
  for (const std::vector<FrameRequest>& run : judged_.runs) {
    find_rates(run);
  }
  find_rates(judged_.around);
  WindowPictures pictures;
  for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
    FrameSettings own = discarded(settings_, hash_combine(hash_combine(kLookTag, round), w));
    own.light_of = [&](const FrameRequest& request) { return light_of(request.frame); };
    if (is_uniform) {
      own.foveation.budget_spp = spp;
    } else {
      // All that the fall-off thinks of eye and picture is in the rates.
      own.foveation.falloff = own.foveation.falloff == "visible" ? "visible" : "map";
      own.foveation.budget_spp.reset();
      own.foveation.retinal_velocity = false;
      own.foveation.saccade_density = 1;
      own.rates_of = [&](const FrameRequest& request) { return rates.at(number(request))[w]; };
    }
    std::vector<ImageRgb> of_window = look_at(w, own);
    pictures.resize(of_window.size());
    for (std::size_t frame = 0; frame < of_window.size(); ++frame) {
      pictures[frame].push_back(std::move(of_window[frame]));
    }
  }
  return pictures;
}

ImageGray WindowClip::shared_rates(double spp) const {
  const FoveationSettings& limits = settings_.foveation;
  return shared_rates_.empty() ? ImageGray() : rates_between(shared_rates_, spp, limits.min_spp, limits.max_spp);
}

}  // namespace gazetrace
