// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sequence_renderer.hpp"

#include <utility>

namespace gazetrace {

SequenceRenderer::SequenceRenderer(PathTracer& tracer, FrameSettings settings, const FramePlan& plan,
                                   std::set<std::int32_t> counted)
    : renderer_(tracer, std::move(settings)) {
  if (renderer_.settings().accumulate.mode == AccumulateMode::window) {
    window_.emplace(renderer_, plan, std::move(counted));
  }
}

RenderedFrame SequenceRenderer::render(const FrameRequest& request, TemporalHistory& history) {
  return window_ ? window_->render(request, history) : renderer_.render(request, history, light_);
}

TracedFrame SequenceRenderer::trace(const FrameRequest& request) {
  return renderer_.trace(request, light_);
}

RenderedFrame SequenceRenderer::finish(const FrameRequest& request, TracedFrame traced,
                                       TemporalHistory& history) const {
  return renderer_.finish(request, std::move(traced), history);
}

}  // namespace gazetrace
