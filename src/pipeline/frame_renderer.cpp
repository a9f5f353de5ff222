// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/frame_renderer.hpp"

#include <optional>
#include <utility>

#include "pipeline/frame_layers.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/quality/adaptive_rates.hpp"
#include "pipeline/trace_counts.hpp"
#include "temporal/join_window.hpp"
#include "temporal/same_camera.hpp"

namespace gazetrace {
namespace {

ShutterTimes shutter_of(const FrameRequest& request) {
  return {request.shutter_open_ns, request.shutter_close_ns};
}

}  // namespace

FrameRenderer::FrameRenderer(PathTracer& tracer, FrameSettings settings)
    : tracer_(&tracer),
      settings_(std::move(settings)),
      reconstruction_(settings_.reconstruction),
      tables_(matte_tables(tracer.scene(), settings_.layers.mattes)) {}

bool FrameRenderer::is_trained(const TrainedField& known, const FrameRequest& request) const {
  return known.request && (known.request->frame == request.frame || at_rest(*known.request, request));
}

std::shared_ptr<const GuidingField> FrameRenderer::guiding_field(const PosedScene& scene, const FrameRequest& request,
                                                                 TrainedField& known, TraceStats& stats) const {
  if (settings_.light_of) {
    return settings_.light_of(request);
  }
  if (!is_trained(known, request)) {
    known = {};
    // A part of a frame knows what the frame does.
    const FrameWindow& window = request.window;
    Camera camera = request.camera;
    if (window.is_part()) {
      camera.projection = window.projection;
      camera.middle_px.x -= window.x_px + 0.5 * (request.width_px - window.frame_width_px);
      camera.middle_px.y -= window.y_px + 0.5 * (request.height_px - window.frame_height_px);
    }
    TrainedGuiding training =
        scene.train_guiding(camera, window.is_part() ? window.frame_width_px : request.width_px,
                            window.is_part() ? window.frame_height_px : request.height_px, settings_.trace);
    stats.training_paths += training.paths;
    known = {request, std::move(training.field)};
  }
  return known.field;
}

TracedFrame FrameRenderer::trace(const FrameRequest& request) const {
  TrainedField none;
  return trace(request, none);
}

TracedFrame FrameRenderer::trace(const FrameRequest& request, TrainedField& known) const {
  TracedFrame traced;
  StageTimes& times = traced.times;
  const PosedScene scene = timed(times.trace_ms, [&] { return tracer_->at(shutter_of(request)); });
  // The pilot sees the noise that the frame will have, so that it is guided as that is.
  FrameSettings frame_settings = settings_;
  if (settings_.trace.guiding) {
    frame_settings.trace.guiding_field =
        timed(times.guiding_ms, [&] { return guiding_field(scene, request, known, traced.pilot); });
  }
  MapContext context = map_context(request, settings_.trace.seed, settings_.threads);
  context.frame = settings_.accumulate.scrambling(request.frame);
  FoveationSettings foveation = settings_.foveation;
  ImageGray density;
  if (settings_.rates_of) {
    FrameRates rates = timed(times.plan_ms, [&] { return settings_.rates_of(request); });
    density = std::move(rates.spp);
    context.density = &density;
    context.full_rate_spp = rates.full_rate_spp;
  } else if (!looks_first(foveation.sampling)) {
    density = timed(times.plan_ms, [&] { return read_density_picture(foveation, request.frame); });
    context.density = density.empty() ? nullptr : &density;
  } else {
    AdaptiveRates adaptive = timed(times.pilot_ms, [&] { return adaptive_rates(scene, request, frame_settings); });
    foveation.target = {};
    foveation.spp = adaptive.spp;
    density = std::move(adaptive.rates);
    context.density = &density;
    add_traces(adaptive.pilot, traced.pilot);
    traced.prediction = adaptive.prediction;
  }
  traced.map = timed(times.plan_ms, [&] {
    return make_sampling_map(foveation, request.view, request.gaze_direction_render, context);
  });
  traced.map.x_px = request.window.x_px;
  traced.map.y_px = request.window.y_px;
  TraceSettings settings = reconstruction_.trace_settings(frame_settings.trace, &traced.map);
  settings.light_groups = settings_.layers.light;
  settings.surfaces = settings.surfaces || settings_.accumulate.mode == AccumulateMode::window;
  traced.sparse =
      timed(times.trace_ms, [&] { return scene.trace(request.camera, context.frame, traced.map, settings); });
  for (BadSample& bad : traced.sparse.stats.bad_samples) {
    bad.frame = request.frame;
  }
  return traced;
}

RenderedFrame FrameRenderer::render(const FrameRequest& request) const {
  TrainedField none;
  return render(request, none);
}

RenderedFrame FrameRenderer::render(const FrameRequest& request, TrainedField& known) const {
  return finish(request, trace(request, known));
}

RenderedFrame FrameRenderer::finish(const FrameRequest& request, TracedFrame traced) const {
  const SparseFrame sparse = std::move(traced.sparse);
  traced.sparse.stats = sparse.stats;
  const SamplingMap map = traced.map;
  return finish_with(request, map, sparse, std::move(traced));
}

bool FrameRenderer::at_rest(const FrameRequest& a, const FrameRequest& b) const {
  return !tracer_->moves() && a.width_px == b.width_px && a.height_px == b.height_px && same_camera(a.camera, b.camera);
}

WindowFrame FrameRenderer::window_frame(const FrameRequest& request, TrainedField& known) const {
  WindowFrame frame{request, trace(request, known), {}, {}};
  frame.hits = timed(frame.traced.times.temporal_ms, [&] {
    return tracer_->at(shutter_of(request))
        .pixel_hits({request.camera, request.t_video_ns}, request.width_px, request.height_px);
  });
  frame.glossy = timed(frame.traced.times.temporal_ms, [&] { return glossy_sites(frame.traced.sparse); });
  return frame;
}

RenderedFrame FrameRenderer::finish(const std::vector<const WindowFrame*>& window, std::size_t own) const {
  const WindowFrame& frame = *window[own];
  const FrameRequest& request = frame.request;
  if (settings_.accumulate.mode != AccumulateMode::window) {
    return finish(request, frame.traced);  // traced without the surfaces by which frames join
  }
  const auto samples_of = [this](const WindowFrame& one) {
    const std::int32_t scrambling = settings_.accumulate.scrambling(one.request.frame);
    return WindowSamples{one.request.frame, scrambling,         &one.request.camera,
                         &one.traced.map,   &one.traced.sparse, &one.glossy};
  };
  TracedFrame itself;
  itself.map = frame.traced.map;
  itself.sparse.stats = frame.traced.sparse.stats;
  itself.pilot = frame.traced.pilot;
  itself.prediction = frame.traced.prediction;
  itself.times = frame.traced.times;
  const JoinedSamples joined = timed(itself.times.temporal_ms, [&] {
    const PosedScene scene = tracer_->at(shutter_of(request));
    const OtherView view{request.camera, request.t_video_ns};
    const HitPlaces places = scene.places_of(frame.hits, view);
    WindowJoin join(samples_of(frame), places, tracer_->moves(), settings_.threads);
    for (const WindowFrame* other : window) {
      if (other != &frame) {
        std::optional<HitPlaces> back;
        if (tracer_->moves()) {
          back.emplace(scene.places_of(frame.hits, {other->request.camera, other->request.t_video_ns}));
        }
        join.add(samples_of(*other), scene.places_of(other->hits, view), back ? &*back : nullptr);
      }
    }
    return join.joined();
  });
  return finish_with(request, joined.map, joined.sparse, std::move(itself));
}

RenderedFrame FrameRenderer::finish_with(const FrameRequest& request, const SamplingMap& map, const SparseFrame& shown,
                                         TracedFrame own) const {
  RenderedFrame rendered;
  rendered.times = own.times;
  StageTimes& times = rendered.times;
  std::optional<Guides> first_hits;
  const bool joins = settings_.accumulate.mode == AccumulateMode::window;
  if (const auto wanted = reconstruction_.guide_settings(settings_.trace, joins)) {
    first_hits = timed(times.guides_ms, [&] {
      return tracer_->at(shutter_of(request)).guides(request.camera, request.width_px, request.height_px, *wanted);
    });
  }
  rendered.frame = timed(times.reconstruct_ms, [&] {
    return reconstruction_.frame(shown, map, first_hits ? &*first_hits : nullptr, settings_.threads);
  });
  std::vector<ImageRgb> light = filtered_light(shown, map, times);
  rendered.map = std::move(own.map);
  rendered.samples = std::move(own.sparse.stats);
  rendered.pilot = std::move(own.pilot);
  rendered.prediction = own.prediction;
  rendered.exposure_ev =
      timed(times.exposure_ms, [&] { return choose_exposure_ev(rendered.frame.radiance, settings_.exposure); });
  add_layers(request, std::move(light), rendered);
  return rendered;
}

MapContext map_context(const FrameRequest& request, std::uint64_t seed, int threads) {
  MapContext context;
  context.seed = seed;
  context.frame = request.frame;
  context.threads = threads;
  return context;
}

}  // namespace gazetrace
