// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_window.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "foveation/sites.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/trace_counts.hpp"
#include "temporal/clip.hpp"
#include "temporal/frames_at_rest.hpp"
#include "temporal/moving_views.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {
namespace {

// All from the first to the last. A loop that counts up to the largest number of a frame would never end.
std::vector<std::int32_t> frames_between(std::int64_t first, std::int64_t last) {
  std::vector<std::int32_t> frames;
  for (std::int64_t frame = first; frame <= last; ++frame) {
    frames.push_back(static_cast<std::int32_t>(frame));
  }
  return frames;
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

FrameWindow::Run FrameWindow::window_around(std::int32_t frame) const {
  const std::int32_t reach = renderer_->settings().accumulate.window;
  Run window{frame, frame};
  // The largest number of a frame has none after it.
  const auto is_there = [&](std::int64_t other) {
    return other <= std::numeric_limits<std::int32_t>::max() && requests_.contains(static_cast<std::int32_t>(other));
  };
  while (window.first > frame - reach && is_there(window.first - 1)) {
    --window.first;
  }
  while (window.last - frame < reach && is_there(std::int64_t{window.last} + 1)) {
    ++window.last;
  }
  return window;
}

bool FrameWindow::joins_next(std::int32_t earlier) const {
  const AccumulateSettings& settings = renderer_->settings().accumulate;
  const FrameRequest& later = request_of(earlier + 1);
  return !(settings.blend > 0) && !eye_forbids(later, settings) && renderer_->at_rest(request_of(earlier), later) &&
         same_sites(in_memory_.at(earlier).traced.map, in_memory_.at(earlier + 1).traced.map);
}

FrameWindow::Run FrameWindow::at_rest_with(std::int32_t frame, const Run& window) const {
  Run run{frame, frame};
  while (run.first > window.first && joins_next(run.first - 1)) {
    --run.first;
  }
  while (run.last < window.last && joins_next(run.last)) {
    ++run.last;
  }
  return run;
}

FrameWindow::Run FrameWindow::of_group(const Run& window, std::int32_t frame) const {
  const ShownAtRest shown = shown_at_rest(frame, window.last, renderer_->settings().accumulate);
  return {static_cast<std::int32_t>(std::max<std::int64_t>(window.first, shown.first)),
          static_cast<std::int32_t>(std::min<std::int64_t>(window.last, shown.last))};
}

const Guides* FrameWindow::guides_of(const FrameRequest& request, StageTimes& times) {
  if (!first_hits_ || !renderer_->at_rest(first_hits_->request, request)) {
    first_hits_.reset();
    first_hits_ = FirstHits{request, timed(times.guides_ms, [&] { return renderer_->guides(request); })};
  }
  return first_hits_->guides ? &*first_hits_->guides : nullptr;
}

const ReconstructedFrame& FrameWindow::alone(std::int32_t frame, bool read_by_others, StageTimes& times) {
  WindowFrame& kept = in_memory_.at(frame);
  const FrameRequest& request = request_of(frame);
  if (!kept.alone) {
    const Guides* guides = guides_of(request, times);
    kept.alone = renderer_->reconstruct(request, kept.traced, guides);
    add_times(std::exchange(kept.alone->times, {}), times);
  }
  if (read_by_others && kept.alone->alone.frames == 0) {
    renderer_->keep_history(*kept.alone);
    add_times(std::exchange(kept.alone->times, {}), times);
  }
  return *kept.alone;
}

TracedFrame FrameWindow::sum_of(const Run& run, const Guides* guides) const {
  std::vector<SamplesOfFrame> frames;
  for (const std::int32_t one : frames_between(run.first, run.last)) {
    const TracedFrame& traced = in_memory_.at(one).traced;
    frames.push_back({one, &traced.map, &traced.sparse});
  }
  SamplesAtRest sums = add_up(frames, guides != nullptr ? &guides->camera : nullptr, renderer_->settings().threads);
  TracedFrame all;
  all.map = std::move(sums.map);
  all.sparse = std::move(sums.sparse);
  return all;
}

FrameWindow::Run FrameWindow::seen_by(std::int32_t frame, Run window) const {
  const AccumulateSettings& settings = renderer_->settings().accumulate;
  Run seen{frame, frame};
  while (seen.first > window.first && !eye_forbids(request_of(seen.first), settings)) {
    --seen.first;
  }
  while (seen.last < window.last && !eye_forbids(request_of(seen.last + 1), settings)) {
    ++seen.last;
  }
  return seen;
}

bool FrameWindow::only_views_move(const Run& window) const {
  if (!renderer_->only_views_move()) {
    return false;
  }
  const SamplingMap& size = in_memory_.at(window.first).traced.map;
  for (const std::int32_t frame : frames_between(window.first, window.last)) {
    const TracedFrame& traced = in_memory_.at(frame).traced;
    if (traced.sparse.first_surface.empty() || traced.map.width_px != size.width_px ||
        traced.map.height_px != size.height_px) {
      return false;
    }
  }
  return true;
}

ReconstructedFrame FrameWindow::among_views(const Run& run, const Run& window, std::int32_t frame, StageTimes& times) {
  const FrameRequest& request = request_of(frame);
  const TracedFrame& own = in_memory_.at(frame).traced;
  const Guides* guides = guides_of(request, times);
  std::vector<float> others;
  TracedFrame all;
  timed(times.temporal_ms, [&] {
    if (run.first != run.last) {
      all = sum_of(run, guides);
    } else {
      all.map = own.map;
      all.sparse = own.sparse;
    }
    const ViewSamples base{frame, &request.camera, &all.map, &all.sparse};
    std::vector<ViewSamples> views;
    for (const std::int32_t one : frames_between(window.first, window.last)) {
      if (one < run.first || one > run.last) {
        const TracedFrame& traced = in_memory_.at(one).traced;
        views.push_back({one, &request_of(one).camera, &traced.map, &traced.sparse});
      }
    }
    JoinedSurfaces joined = surfaces_of_views(base, views, *guides, renderer_->settings().threads);
    all.sparse.surfaces = std::move(joined.surfaces);
    all.sparse.first_surface = std::move(joined.first_surface);
    all.sparse.samples_of_others = std::move(joined.samples_of_others);
    others = std::move(joined.others_per_pixel);
    return true;
  });
  ReconstructedFrame shown = renderer_->reconstruct(request, all, guides);
  add_times(std::exchange(shown.times, {}), times);
  for (std::size_t i = 0; i < others.size(); ++i) {
    for_each_pixel(all.map, all.map.sites[i], [&](int x, int y) { shown.frame.sample_count(x, y) += others[i]; });
  }
  shown.map = own.map;
  shown.samples = own.sparse.stats;
  shown.pilot = own.pilot;
  shown.prediction = own.prediction;
  return shown;
}

const ReconstructedFrame& FrameWindow::rested(const Run& run, std::int32_t frame, bool beside_others,
                                              StageTimes& times) {
  const FrameRequest& request = request_of(frame);
  if (!rested_ || rested_->run != run) {
    rested_.reset();
    const Guides* guides = guides_of(request, times);
    const TracedFrame all = timed(times.temporal_ms, [&] { return sum_of(run, guides); });
    rested_ = Rested{run, renderer_->reconstruct(request, all, guides)};
    add_times(std::exchange(rested_->frame.times, {}), times);
  }
  ReconstructedFrame& shown = rested_->frame;
  if (beside_others && shown.alone.frames == 0) {  // what comes after it is compared with it, to find cuts
    renderer_->keep_history(shown);
    add_times(std::exchange(shown.times, {}), times);
  }
  const TracedFrame& own = in_memory_.at(frame).traced;
  shown.request = request;
  shown.map = own.map;
  shown.samples = own.sparse.stats;
  shown.pilot = own.pilot;
  shown.prediction = own.prediction;
  return shown;
}

RenderedFrame FrameWindow::render(const FrameRequest& request, TemporalHistory& history) {
  const Run window = window_around(request.frame);
  in_memory_.erase(in_memory_.begin(), in_memory_.lower_bound(window.first));
  TraceStats others;
  StageTimes times;
  for (const std::int32_t frame : frames_between(window.first, window.last)) {
    if (in_memory_.contains(frame)) {
      continue;
    }
    const TracedFrame& traced =
        in_memory_.emplace(frame, WindowFrame{renderer_->trace(request_of(frame), light_), {}}).first->second.traced;
    if (frame != request.frame && !counted_.contains(frame)) {
      add_traces(traced.sparse.stats, others);
      add_traces(traced.pilot, others);
      add_times(traced.times, times);
    }
  }
  add_times(in_memory_.at(request.frame).traced.times, times);
  const Run run = at_rest_with(request.frame, window);
  const Run seen = seen_by(request.frame, window);
  if (run != seen && only_views_move(seen)) {
    const ReconstructedFrame own = among_views(run, seen, request.frame, times);
    RenderedFrame rendered = renderer_->join({&own}, 0, history);
    rendered.others = std::move(others);
    add_times(times, rendered.times);
    return rendered;
  }
  std::vector<const ReconstructedFrame*> read;
  // Before a saccade or blink nothing is read; that of the frame itself is looked at by join().
  if (run.first == request.frame || !eye_forbids(request_of(run.first), renderer_->settings().accumulate)) {
    for (std::int32_t frame = window.first; frame < run.first; ++frame) {
      read.push_back(&alone(frame, true, times));
    }
  }
  const std::size_t at = read.size();
  for (const std::int32_t frame : frames_between(std::int64_t{run.last} + 1, window.last)) {
    read.push_back(&alone(frame, true, times));
  }
  const Run summed = run == window ? of_group(window, request.frame) : run;
  const ReconstructedFrame& own = summed.first == summed.last ? alone(request.frame, run != window, times)
                                                              : rested(summed, request.frame, run != window, times);
  read.insert(read.begin() + static_cast<std::ptrdiff_t>(at), &own);
  RenderedFrame rendered = renderer_->join(read, at, history);
  rendered.others = std::move(others);
  add_times(times, rendered.times);
  return rendered;
}

}  // namespace gazetrace
