// SPDX-License-Identifier: Apache-2.0
// Frames in order, each to its files: what is skipped, and the row of timing.csv. Only the log of the run outlives a
// frame.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/joined_frames.hpp"
#include "pipeline/quality/clip_rate.hpp"
#include "pipeline/resume.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"

namespace gazetrace {
namespace {

// What a sequence traces in every frame: what its files show of first hits is summed over the samples.
FrameSettings frame_settings(const PipelineSettings& settings, const ColorPipeline& color) {
  FrameSettings frame = settings;
  frame.frames_per_second = static_cast<double>(settings.fps.numerator) / static_cast<double>(settings.fps.denominator);
  frame.display_curve = [&color](double exposure_ev) { return view_display_curve(color, {}, exposure_ev); };
  return frame;
}

RunPaths paths_of(const FramePlan& plan, const PipelineSettings& settings) {
  std::vector<std::int32_t> frames;
  for (const FrameRequest& request : plan.frames) {
    frames.push_back(request.frame);
  }
  const std::vector<std::string> files = output_files(settings, frames);
  return files.empty() ? RunPaths() : RunPaths{files[0], files[1]};
}

std::vector<std::int32_t> frames_to_render(const FramePlan& plan, const ResumePlan& resume) {
  std::vector<std::int32_t> frames;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    if (!resume.is_done[i]) {
      frames.push_back(plan.frames[i].frame);
    }
  }
  return frames;
}

// What is left when a sequence was stopped: the frames that were to be rendered and were not.
std::vector<std::int32_t> frames_left(const std::vector<std::int32_t>& to_render, const std::vector<TimingRow>& rows) {
  std::set<std::int32_t> made;
  for (const TimingRow& row : rows) {
    made.insert(row.frame);
  }
  std::vector<std::int32_t> left = to_render;
  std::erase_if(left, [&](std::int32_t frame) { return made.contains(frame); });
  return left;
}

bool is_asked_to_stop(const PipelineObserver& observer, double frame_ms) {
  return observer.stop_before_frame && observer.stop_before_frame(frame_ms);
}

// Whether the work came to its end, or was given up since the sequence is to stop (TraceSettings::stop).
template <class Work>
bool is_completed(Work&& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) {
      throw;
    }
    return false;
  }
}

// What a run writes down of each frame as soon as it is finished.
struct RunLog {
  TimingLog timing;
  FileJournal journal;

  void add(TimingRow& row, SequenceResult& result) {
    journal.add(result.files);
    row.peak_memory_mib = peak_memory_mib();
    timing.add(row);
    result.rows.push_back(row);
  }
};

// What a sequence is made from, and who is told of it.
struct SequenceInputs {
  const FramePlan& plan;
  const ColorPipeline& color;
  const PipelineSettings& settings;
  const PipelineObserver& observer;
};

// Makes the picture of a frame. Its files are those of `result`, and its row lacks what the choice of a rate took.
// Error(interrupted) leaves the row as it was, and `result` without files: a frame is given up only while it is traced.
RenderedFrame make_frame(const SequenceInputs& inputs, const FrameRequest& request, JoinedFrames& frames,
                         TimingRow& row, SequenceResult& result) {
  const Stopwatch total;
  result.files.clear();
  RenderedFrame rendered = frames.render(request);
  add_samples(rendered.samples, rendered.pilot, rendered.map, row);
  add_others(rendered.others, row);
  result.camera_rays += rendered.samples.rays_primary;
  result.seen_backs += rendered.samples.seen_backs;
  result.bad_samples.insert(result.bad_samples.end(), rendered.samples.bad_samples.begin(),
                            rendered.samples.bad_samples.end());
  add_times(rendered.times, row);
  add_prediction(rendered.prediction, row);
  row.exposure_ev = rendered.exposure_ev;
  if (inputs.observer.frame_ready) {
    inputs.observer.frame_ready(request, rendered.frame, rendered.exposure_ev);
  }
  write_frame_files(request, inputs.plan, rendered, inputs.color, inputs.settings, row, result);
  row.total_ms += total.elapsed_ms();
  return rendered;
}

// All frames of the plan in order, until the sequence is asked to stop.
void make_frames(const SequenceInputs& inputs, const ResumePlan& resume, JoinedFrames& frames,
                 const std::optional<ClipRate>& rate, RunLog& log, SequenceResult& result) {
  const FramePlan& plan = inputs.plan;
  const PipelineObserver& observer = inputs.observer;
  double made_ms = 0;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const FrameRequest& request = plan.frames[i];
    TimingRow row = timing_row(request);
    if (resume.is_done[i]) {
      result.skipped.push_back(request.frame);
      if (observer.frame_done) {
        observer.frame_done(row, true);
      }
      continue;
    }
    const std::size_t made = result.rows.size();
    result.interrupted = is_asked_to_stop(observer, made == 0 ? 0 : made_ms / static_cast<double>(made));
    if (result.interrupted) {
      return;
    }
    if (observer.frame_begins) {
      observer.frame_begins(request);
    }
    const Stopwatch own_time;  // without the choice of the rate, which the first row counts
    RenderedFrame rendered;
    result.interrupted = !is_completed([&] { rendered = make_frame(inputs, request, frames, row, result); });
    if (result.interrupted) {
      return;
    }
    if (rate) {
      add_rate(*rate, result.rows.empty(), row);
    }
    log.add(row, result);
    made_ms += own_time.elapsed_ms();
    if (observer.frame_done) {
      observer.frame_done(row, false);
    }
    if (observer.take_frame) {
      observer.take_frame(request, std::move(rendered), row);
    }
  }
}

}  // namespace

SequenceResult render_sequence(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer) {
  const RunPaths paths = paths_of(plan, settings);
  const ResumePlan resume = plan_resume(plan, settings, paths);
  const std::vector<std::int32_t> to_render = frames_to_render(plan, resume);
  SequenceResult result;
  result.warnings = resume.warnings;

  FrameSettings own = frame_settings(settings, color);
  std::optional<ClipRate> rate;
  if (own.foveation.target.jod && !to_render.empty()) {
    result.interrupted =
        is_asked_to_stop(observer, 0) || !is_completed([&] { rate = clip_rate(tracer, plan.judged, own, color); });
  }
  if (rate) {
    own = with_rate(std::move(own), *rate);
    result.facts.emplace_back("rate", rate->text());
    const std::vector<std::string> doubts = rate->doubts();
    result.warnings.insert(result.warnings.end(), doubts.begin(), doubts.end());
  }

  const FrameRenderer renderer(tracer, std::move(own));
  JoinedFrames joined(renderer, plan, {to_render.begin(), to_render.end()});
  RunLog log{TimingLog(paths.timing, resume.kept_rows), FileJournal(paths.record, resume.kept_files)};
  if (!settings.output.display.pattern.empty() && !plan.frames.empty()) {
    const FrameRequest& first = plan.frames.front();
    color.prepare(first.width_px, first.height_px, display_image_bits(settings.output.display), settings.threads);
  }
  if (!result.interrupted) {
    make_frames({plan, color, settings, observer}, resume, joined, rate, log, result);
  }
  if (result.interrupted) {
    result.left = frames_left(to_render, result.rows);
  }
  log.timing.finish();
  result.files = log.journal.files();
  return result;
}

}  // namespace gazetrace
