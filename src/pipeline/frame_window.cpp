// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_window.hpp"

#include <iterator>
#include <utility>

#include "pipeline/trace_counts.hpp"

namespace gazetrace {

namespace {

void add_times(const StageTimes& from, StageTimes& to) {
  to.plan_ms += from.plan_ms;
  to.pilot_ms += from.pilot_ms;
  to.trace_ms += from.trace_ms;
  to.guides_ms += from.guides_ms;
  to.reconstruct_ms += from.reconstruct_ms;
  to.temporal_ms += from.temporal_ms;
}

}  // namespace

FrameWindow::FrameWindow(const FrameRenderer& renderer, const FramePlan& plan, std::set<std::int32_t> counted)
    : renderer_(&renderer), counted_(std::move(counted)) {
  for (const std::vector<FrameRequest>* requests : {&plan.frames, &plan.around}) {
    for (const FrameRequest& request : *requests) {
      requests_.emplace(request.frame, &request);
    }
  }
}

RenderedFrame FrameWindow::render(const FrameRequest& request, TemporalHistory& history) {
  const std::int32_t reach = renderer_->settings().accumulate.window;
  held_.erase(held_.begin(), held_.lower_bound(request.frame - reach));
  const auto own = requests_.find(request.frame);
  auto first = own;
  while (first != requests_.begin() && std::prev(first)->first + 1 == first->first &&
         first->first > request.frame - reach) {
    --first;
  }
  std::vector<const ReconstructedFrame*> window;
  TraceStats others;
  StageTimes times_of_others;
  std::size_t at = 0;
  for (auto next = first; next != requests_.end() && next->first <= request.frame + reach; ++next) {
    if (next != first && std::prev(next)->first + 1 != next->first) {
      break;
    }
    auto held = held_.find(next->first);
    if (held == held_.end()) {
      held = held_.emplace(next->first, renderer_->reconstruct(*next->second)).first;
      if (next != own && !counted_.contains(next->first)) {
        add_traces(held->second.samples, others);
        add_traces(held->second.first_look, others);
        add_times(held->second.times, times_of_others);
      }
    }
    if (next == own) {
      at = window.size();
    }
    window.push_back(&held->second);
  }
  RenderedFrame rendered = renderer_->join(window, at, history);
  rendered.others = std::move(others);
  add_times(times_of_others, rendered.times);
  return rendered;
}

}  // namespace gazetrace
