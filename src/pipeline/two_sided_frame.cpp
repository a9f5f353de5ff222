// SPDX-License-Identifier: Apache-2.0
// A frame in two steps, for accumulation from both sides: up to its reconstruction, and from there on once its
// neighbours are there as well.
#include <optional>
#include <utility>

#include "gazetrace/frame_renderer.hpp"
#include "pipeline/frame_stages.hpp"
#include "temporal/same_camera.hpp"
#include "temporal/two_sided.hpp"

namespace gazetrace {
namespace {

PosedScene scene_of(PathTracer& tracer, const FrameRequest& request) {
  return tracer.at({request.shutter_open_ns, request.shutter_close_ns});
}

OtherView view_of(const FrameRequest& request) {
  return {request.camera, request.t_video_ns};
}

// From the nearest neighbours outwards, the earlier one of two first.
std::vector<std::size_t> outwards(const WindowReach& reach, std::size_t own) {
  std::vector<std::size_t> order;
  for (std::size_t apart = 1; own >= reach.begin + apart || own + apart < reach.end; ++apart) {
    if (own >= reach.begin + apart) {
      order.push_back(own - apart);
    }
    if (own + apart < reach.end) {
      order.push_back(own + apart);
    }
  }
  return order;
}

}  // namespace

std::optional<Guides> FrameRenderer::guides(const FrameRequest& request) const {
  const auto wanted = reconstruction_.guide_settings(settings_.trace);
  if (!wanted) {
    return std::nullopt;
  }
  return scene_of(*tracer_, request).guides(request.camera, request.width_px, request.height_px, *wanted);
}

bool FrameRenderer::at_rest(const FrameRequest& a, const FrameRequest& b) const {
  return !tracer_->moves() && a.width_px == b.width_px && a.height_px == b.height_px && same_camera(a.camera, b.camera);
}

bool FrameRenderer::only_views_move() const {
  return !tracer_->moves() && reconstruction_.needs().surfaces && !(settings_.accumulate.blend > 0);
}

ReconstructedFrame FrameRenderer::reconstruct(const FrameRequest& request, const TracedFrame& traced,
                                              const Guides* guides) const {
  ReconstructedFrame done;
  done.request = request;
  done.frame = timed(done.times.reconstruct_ms,
                     [&] { return reconstruction_.frame(traced.sparse, traced.map, guides, settings_.threads); });
  done.light = filtered_light(traced, done.times);
  done.map = traced.map;
  done.samples = traced.sparse.stats;
  done.pilot = traced.pilot;
  done.prediction = traced.prediction;
  return done;
}

void FrameRenderer::keep_history(ReconstructedFrame& frame) const {
  const FrameRequest& request = frame.request;
  frame.alone = timed(frame.times.temporal_ms, [&] {
    const SurfaceMotion motion =
        scene_of(*tracer_, request)
            .surface_motion(request.camera, frame.map.width_px, frame.map.height_px, view_of(request));
    return history_of_frame(frame.frame, frame.map, motion, request, settings_.threads);
  });
}

ReconstructedFrame FrameRenderer::reconstruct(const FrameRequest& request) const {
  const TracedFrame traced = trace(request);
  StageTimes times = traced.times;
  const std::optional<Guides> first_hits = timed(times.guides_ms, [&] { return guides(request); });
  ReconstructedFrame done = reconstruct(request, traced, first_hits ? &*first_hits : nullptr);
  if (settings_.accumulate.window > 0) {
    keep_history(done);
  }
  add_times(times, done.times);
  return done;
}

RenderedFrame FrameRenderer::join(const std::vector<const ReconstructedFrame*>& window, std::size_t own,
                                  TemporalHistory& history) const {
  const ReconstructedFrame& frame = *window[own];
  const FrameRequest& request = frame.request;
  RenderedFrame rendered;
  rendered.times = frame.times;
  rendered.frame = timed(rendered.times.temporal_ms, [&] {
    if (window.size() == 1) {
      return frame.frame;
    }
    std::vector<WindowFrame> views;
    views.reserve(window.size());
    for (const ReconstructedFrame* one : window) {
      views.push_back({&one->request, &one->alone});
    }
    const std::vector<std::size_t> order = outwards(reach_of(views, own, settings_.accumulate), own);
    if (order.empty()) {
      return frame.frame;
    }
    const PosedScene scene = scene_of(*tracer_, request);
    NeighbourSums sums(frame.frame, frame.map, settings_.accumulate, settings_.threads);
    SurfaceMotion motion;
    for (const std::size_t other : order) {
      motion = scene.surface_motion(request.camera, frame.map.width_px, frame.map.height_px,
                                    view_of(window[other]->request));
      sums.add(window[other]->alone, motion, window[other]->request.frame - request.frame);
    }
    return sums.joined(motion);
  });
  rendered.map = frame.map;
  rendered.samples = frame.samples;
  rendered.pilot = frame.pilot;
  rendered.prediction = frame.prediction;
  history.passed.push_back(request.frame);
  expose(request, settings_, history, rendered);
  add_layers(request, frame.light, rendered);
  return rendered;
}

}  // namespace gazetrace
