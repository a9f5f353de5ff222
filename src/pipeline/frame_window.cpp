// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_window.hpp"

#include <iterator>

namespace gazetrace {

FrameWindow::FrameWindow(const FrameRenderer& renderer, const FramePlan& plan) : renderer_(&renderer) {
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
  std::size_t at = 0;
  for (auto next = first; next != requests_.end() && next->first <= request.frame + reach; ++next) {
    if (next != first && std::prev(next)->first + 1 != next->first) {
      break;
    }
    auto held = held_.find(next->first);
    if (held == held_.end()) {
      held = held_.emplace(next->first, renderer_->reconstruct(*next->second)).first;
    }
    if (next == own) {
      at = window.size();
    }
    window.push_back(&held->second);
  }
  return renderer_->join(window, at, history);
}

}  // namespace gazetrace
