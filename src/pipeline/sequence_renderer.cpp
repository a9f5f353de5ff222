// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sequence_renderer.hpp"

#include <utility>

namespace gazetrace {

SequenceRenderer::SequenceRenderer(PathTracer& tracer, FrameSettings settings, const FramePlan& plan,
                                   std::set<std::int32_t> counted, const OutputSettings& output)
    : tracer_(tracer), settings_(std::move(settings)), renderer_(tracer, settings_) {
  if (settings_.accumulate.mode == AccumulateMode::two_sided) {
    window_.emplace(renderer_, plan, std::move(counted));
  }
  if (settings_.foveation.target.time_s) {
    time_budget_.emplace(tracer, settings_, output);
  }
}

RenderedFrame SequenceRenderer::render(const FrameRequest& request, TemporalHistory& history) {
  if (time_budget_) {
    // Budgets change nothing of what is learned.
    const FrameSettings within = time_budget_->settings_for(request, history, light_);
    return FrameRenderer(tracer_, within).render(request, history, light_);
  }
  return window_ ? window_->render(request, history) : renderer_.render(request, history, light_);
}

TracedFrame SequenceRenderer::trace(const FrameRequest& request) {
  return renderer_.trace(request, light_);
}

RenderedFrame SequenceRenderer::finish(const FrameRequest& request, TracedFrame traced,
                                       TemporalHistory& history) const {
  return renderer_.finish(request, std::move(traced), history);
}

void SequenceRenderer::learn(TimingRow& row) {
  if (time_budget_) {
    time_budget_->learn(row);
  }
}

void SequenceRenderer::check(const TimingRow& row) {
  if (time_budget_) {
    time_budget_->check(row);
  }
}

std::string SequenceRenderer::warning() const {
  return time_budget_ ? time_budget_->warning() : std::string();
}

}  // namespace gazetrace
