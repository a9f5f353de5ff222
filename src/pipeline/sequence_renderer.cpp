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

RenderedFrame SequenceRenderer::render(const FrameRequest& request) {
  return window_ ? window_->render(request) : renderer_.render(request, light_);
}

}  // namespace gazetrace
