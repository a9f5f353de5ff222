// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/frame_renderer.hpp"

#include <optional>
#include <utility>

#include "pipeline/frame_layers.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/quality/adaptive_rates.hpp"
#include "pipeline/trace_counts.hpp"

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

bool FrameRenderer::knows_light(const KnownLight& known, const FrameRequest& request) const {
  return known.request && (known.request->frame == request.frame || at_rest(*known.request, request));
}

std::shared_ptr<const LearnedLight> FrameRenderer::learned_light(const PosedScene& scene, const FrameRequest& request,
                                                                 KnownLight& known, TraceStats& stats) const {
  if (settings_.light_of) {
    return settings_.light_of(request);
  }
  if (!knows_light(known, request)) {
    known = {};
    LightLearning learning = scene.learn_light(request.camera, request.width_px, request.height_px, settings_.trace);
    stats.learning_paths += learning.paths;
    known = {request, std::move(learning.light)};
  }
  return known.light;
}

TracedFrame FrameRenderer::trace(const FrameRequest& request) const {
  KnownLight none;
  return trace(request, none);
}

TracedFrame FrameRenderer::trace(const FrameRequest& request, KnownLight& known) const {
  TracedFrame traced;
  StageTimes& times = traced.times;
  const PosedScene scene = timed(times.trace_ms, [&] { return tracer_->at(shutter_of(request)); });
  // The pilot sees the noise that the frame will have, so that it knows what that has learned.
  FrameSettings frame_settings = settings_;
  if (settings_.trace.learn_light) {
    frame_settings.trace.learned =
        timed(times.learn_ms, [&] { return learned_light(scene, request, known, traced.pilot); });
  }
  MapContext context = map_context(request, settings_.trace.seed, settings_.threads);
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
  TraceSettings settings = reconstruction_.trace_settings(frame_settings.trace);
  settings.light_groups = settings_.layers.light;
  traced.sparse =
      timed(times.trace_ms, [&] { return scene.trace(request.camera, request.frame, traced.map, settings); });
  return traced;
}

RenderedFrame FrameRenderer::render(const FrameRequest& request, TemporalHistory& history) const {
  KnownLight none;
  return render(request, history, none);
}

RenderedFrame FrameRenderer::render(const FrameRequest& request, TemporalHistory& history, KnownLight& known) const {
  if (settings_.accumulate.mode == AccumulateMode::two_sided) {
    throw Error(ErrorKind::usage, "`accumulate`", "two-sided reads the frames around a frame, and here is one alone",
                "reconstruct them and join them, or call render_sequence()");
  }
  return finish(request, trace(request, known), history);
}

RenderedFrame FrameRenderer::finish(const FrameRequest& request, TracedFrame traced, TemporalHistory& history) const {
  const PosedScene scene = tracer_->at(shutter_of(request));
  RenderedFrame rendered;
  rendered.times = traced.times;
  StageTimes& times = rendered.times;
  std::optional<Guides> guides;
  if (const auto wanted = reconstruction_.guide_settings(settings_.trace)) {
    guides = timed(times.guides_ms,
                   [&] { return scene.guides(request.camera, request.width_px, request.height_px, *wanted); });
  }
  const auto filtered = [&](const SparseFrame& sparse, const Reconstruction& by) {
    return timed(times.reconstruct_ms,
                 [&] { return by.frame(sparse, traced.map, guides ? &*guides : nullptr, settings_.threads); });
  };
  const auto reprojected = [&](Frame frame) {
    return timed(times.temporal_ms, [&] {
      const OtherView earlier{history.camera.value_or(request.camera),
                              history.camera ? history.t_video_ns : request.t_video_ns};
      const SurfaceMotion motion =
          scene.surface_motion(request.camera, traced.map.width_px, traced.map.height_px, earlier);
      return reproject(std::move(frame), traced.map, motion, request, settings_.accumulate, history, settings_.threads);
    });
  };
  if (settings_.accumulate.mode != AccumulateMode::reproject) {
    Frame frame = filtered(traced.sparse, reconstruction_);
    rendered.frame = timed(times.temporal_ms, [&] {
      return accumulate(std::move(frame), request, settings_.accumulate, history, settings_.threads);
    });
  } else if (settings_.accumulate.order == AccumulateOrder::before && !reconstruction_.needs().surfaces) {
    const Frame sites = reprojected(filtered(traced.sparse, Reconstruction({"none"})));
    rendered.frame = filtered(sites_of_frame(sites, traced.sparse, traced.map), reconstruction_);
  } else {
    rendered.frame = reprojected(filtered(traced.sparse, reconstruction_));
  }
  std::vector<ImageRgb> light = filtered_light(traced, times);
  rendered.map = std::move(traced.map);
  rendered.samples = std::move(traced.sparse.stats);
  rendered.pilot = std::move(traced.pilot);
  rendered.prediction = traced.prediction;
  history.passed.push_back(request.frame);
  expose(request, settings_, history, rendered);
  add_layers(request, std::move(light), rendered);
  return rendered;
}

bool uses_history(const FrameSettings& settings) {
  return settings.accumulate.mode == AccumulateMode::running || settings.accumulate.mode == AccumulateMode::reproject ||
         (settings.exposure.mode == ExposureMode::log_average && settings.exposure.smoothing_s > 0);
}

void expose(const FrameRequest& request, const FrameSettings& settings, TemporalHistory& history,
            RenderedFrame& rendered) {
  rendered.exposure_ev = timed(rendered.times.exposure_ms, [&] {
    return choose_exposure_ev(rendered.frame.radiance, request.t_video_ns, settings.exposure, history);
  });
}

MapContext map_context(const FrameRequest& request, std::uint64_t seed, int threads) {
  MapContext context;
  context.seed = seed;
  context.frame = request.frame;
  context.threads = threads;
  return context;
}

}  // namespace gazetrace
