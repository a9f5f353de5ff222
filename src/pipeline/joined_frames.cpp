// SPDX-License-Identifier: Apache-2.0
#include "pipeline/joined_frames.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/frame_stages.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {

JoinedFrames::JoinedFrames(const FrameRenderer& renderer, const FramePlan& plan, std::set<std::int32_t> counted)
    : renderer_(&renderer), counted_(std::move(counted)) {
  for (const std::vector<FrameRequest>* requests : {&plan.frames, &plan.around}) {
    for (const FrameRequest& request : *requests) {
      requests_.emplace(request.frame, &request);
    }
  }
}

RenderedFrame JoinedFrames::render(const FrameRequest& request) {
  const AccumulateSettings& reach = renderer_->settings().accumulate;
  if (reach.mode == AccumulateMode::off) {
    return renderer_->render(request, light_);
  }
  // Consecutive frames as far as they are there. In 64 bits, since the largest number of a frame has none after it.
  const auto own = requests_.find(request.frame);
  auto first = own;
  while (first != requests_.begin() && std::prev(first)->first == first->first - 1 &&
         std::int64_t{request.frame} - first->first < reach.past_frames) {
    --first;
  }
  auto end = std::next(own);
  while (end != requests_.end() && end->first == std::prev(end)->first + 1 &&
         std::int64_t{end->first} - request.frame <= reach.future_frames) {
    ++end;
  }
  in_memory_.erase(in_memory_.begin(), in_memory_.lower_bound(first->first));
  TraceStats others;
  StageTimes times;
  std::vector<const WindowFrame*> window;
  std::size_t place = 0;
  for (auto at = first; at != end; ++at) {
    const auto [number, other] = *at;
    auto found = in_memory_.find(number);
    if (found == in_memory_.end()) {
      found = in_memory_.emplace(number, renderer_->window_frame(*other, light_)).first;
      const TracedFrame& traced = found->second.traced;
      if (number != request.frame && !counted_.contains(number)) {
        add_traces(traced.sparse.stats, others);
        add_traces(traced.pilot, others);
        add_times(traced.times, times);
      }
    }
    if (at == own) {
      place = window.size();
    }
    window.push_back(&found->second);
  }
  RenderedFrame rendered = renderer_->finish(window, place);
  rendered.others = std::move(others);
  add_times(times, rendered.times);
  return rendered;
}

}  // namespace gazetrace
