// SPDX-License-Identifier: Apache-2.0
// A frame in two steps, for accumulation from both sides: up to its reconstruction, and from there on once its
// neighbours are there as well.
#include <optional>
#include <utility>

#include "gazetrace/frame_renderer.hpp"
#include "pipeline/frame_stages.hpp"
#include "temporal/two_sided.hpp"

namespace gazetrace {
namespace {

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

ReconstructedFrame FrameRenderer::reconstruct(const FrameRequest& request) const {
  TracedFrame traced = trace(request);
  ReconstructedFrame done;
  done.request = request;
  done.times = traced.times;
  const PosedScene scene = tracer_->at({request.shutter_open_ns, request.shutter_close_ns});
  std::optional<Guides> guides;
  if (const auto wanted = reconstruction_.guide_settings(settings_.trace)) {
    guides = timed(done.times.guides_ms,
                   [&] { return scene.guides(request.camera, request.width_px, request.height_px, *wanted); });
  }
  done.frame = timed(done.times.reconstruct_ms, [&] {
    return reconstruction_.frame(traced.sparse, traced.map, guides ? &*guides : nullptr, settings_.threads);
  });
  if (settings_.accumulate.window > 0) {
    done.alone = timed(done.times.temporal_ms, [&] {
      const SurfaceMotion motion =
          scene.surface_motion(request.camera, traced.map.width_px, traced.map.height_px, view_of(request));
      return history_of_frame(done.frame, traced.map, motion, request, settings_.threads);
    });
  }
  done.light = filtered_light(traced, done.times);
  done.map = std::move(traced.map);
  done.samples = std::move(traced.sparse.stats);
  done.first_look = std::move(traced.first_look);
  done.prediction = traced.prediction;
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
    const PosedScene scene = tracer_->at({request.shutter_open_ns, request.shutter_close_ns});
    NeighbourSums sums(frame.frame, frame.map, settings_.accumulate, settings_.threads);
    SurfaceMotion motion;
    for (const std::size_t other : order) {
      motion = scene.surface_motion(request.camera, frame.map.width_px, frame.map.height_px,
                                    view_of(window[other]->request));
      sums.add(window[other]->alone, motion, static_cast<int>(other) - static_cast<int>(own));
    }
    return sums.joined(motion);
  });
  rendered.map = frame.map;
  rendered.samples = frame.samples;
  rendered.first_look = frame.first_look;
  rendered.prediction = frame.prediction;
  history.passed.push_back(request.frame);
  expose(request, settings_, history, rendered);
  add_layers(request, frame.light, rendered);
  return rendered;
}

}  // namespace gazetrace
