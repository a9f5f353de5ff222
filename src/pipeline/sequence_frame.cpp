// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sequence_frame.hpp"

#include <string>
#include <utility>

#include "core/stopwatch.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/unfinished_frames.hpp"

namespace gazetrace {
namespace {

void keep_bad_samples(const TraceStats& samples, SequenceResult& result) {
  result.bad_samples.insert(result.bad_samples.end(), samples.bad_samples.begin(), samples.bad_samples.end());
}

// For a run that leaves frames unfinished: what was found is all that becomes of this one.
void trace_to_file(const PipelineSettings& settings, const FrameRequest& request, SequenceRenderer& renderer,
                   TimingRow& row, SequenceResult& result) {
  const TracedFrame traced = renderer.trace(request);
  add_samples(traced.sparse.stats, traced.pilot, traced.map, row);
  keep_bad_samples(traced.sparse.stats, result);
  add_times(traced.times, row);
  save_unfinished(request.frame, traced, settings, row, result.files);
}

// The row counts what tracing took, on whatever machine that was.
RenderedFrame finish_from_file(const PipelineSettings& settings, const FrameRequest& request,
                               const SequenceRenderer& renderer, TemporalHistory& history, TimingRow& row) {
  TracedFrame traced = load_unfinished(request, settings);
  row.total_ms += traced.times.plan_ms + traced.times.learn_ms + traced.times.pilot_ms + traced.times.trace_ms;
  return renderer.finish(request, std::move(traced), history);
}

// Only frames that are to be rendered get files; others are there for their history.
RenderedFrame make_picture(const SequenceInputs& inputs, const FrameRequest& request, FrameWork work,
                           SequenceRenderer& renderer, TemporalHistory& history, TimingRow& row,
                           SequenceResult& result) {
  const PipelineSettings& settings = inputs.settings;
  const std::string behind = uses_history(settings) ? history_text(history.passed) : std::string();
  RenderedFrame rendered = settings.stage == SequenceStage::finish
                               ? finish_from_file(settings, request, renderer, history, row)
                               : renderer.render(request, history);
  add_samples(rendered.samples, rendered.pilot, rendered.map, row);
  add_others(rendered.others, row);
  keep_bad_samples(rendered.samples, result);
  add_times(rendered.times, row);
  add_prediction(rendered.prediction, row);
  row.exposure_ev = rendered.exposure_ev;
  if (inputs.observer.frame_ready) {
    inputs.observer.frame_ready(request, rendered.frame, rendered.exposure_ev);
  }
  if (work == FrameWork::render) {
    write_frame_files(request, inputs.plan, rendered, inputs.color, settings, behind, row, result);
  }
  return rendered;
}

}  // namespace

RenderedFrame make_frame(const SequenceInputs& inputs, const FrameRequest& request, FrameWork work,
                         SequenceRenderer& renderer, TemporalHistory& history, TimingRow& row, SequenceResult& result) {
  const Stopwatch total;
  RenderedFrame rendered;
  result.files.clear();
  if (leaves_unfinished(inputs.settings)) {
    trace_to_file(inputs.settings, request, renderer, row, result);
  } else {
    rendered = make_picture(inputs, request, work, renderer, history, row, result);
  }
  row.total_ms += total.elapsed_ms();
  return rendered;
}

}  // namespace gazetrace
