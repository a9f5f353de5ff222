// SPDX-License-Identifier: Apache-2.0
// Frames in order, each to its files: what is skipped or done again, the row of timing.csv, the checkpoint. Only the
// history and the log of the run outlive a frame.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/checkpoint.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"
#include "output/aovs.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/quality/clip_rate.hpp"
#include "pipeline/resume.hpp"
#include "pipeline/sequence_frame.hpp"
#include "pipeline/sequence_history.hpp"
#include "pipeline/sequence_renderer.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/unfinished_frames.hpp"

namespace gazetrace {
namespace {

// What a sequence traces in every frame: what its files show of first hits is summed over the samples.
FrameSettings frame_settings(const PipelineSettings& settings, const ColorPipeline& color) {
  FrameSettings frame = settings;
  frame.frames_per_second = static_cast<double>(settings.fps.numerator) / static_cast<double>(settings.fps.denominator);
  frame.display_curve = [&color](double exposure_ev) { return view_display_curve(color, {}, exposure_ev); };
  frame.trace.guides = frame.trace.guides || show_first_hits(settings.output.exr.aovs);
  if (!settings.output.exr.pattern.empty()) {
    frame.layers = layer_settings(settings.output.exr);
  }
  return frame;
}

RunPaths paths_of(const FramePlan& plan, const PipelineSettings& settings) {
  std::vector<std::int32_t> frames;
  for (std::size_t i = static_cast<std::size_t>(settings.preroll); i < plan.frames.size(); ++i) {
    frames.push_back(plan.frames[i].frame);
  }
  const std::vector<std::string> files = output_files(settings, frames);
  return files.empty() ? RunPaths() : RunPaths{files[0], files[1]};
}

// Those to be rendered, and with `replayed` those that are traced for their history alone as well.
std::vector<std::int32_t> frames_to_make(const FramePlan& plan, const ResumePlan& resume, bool replayed) {
  std::vector<std::int32_t> frames;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    if (resume.work[i] == FrameWork::render || (replayed && resume.work[i] == FrameWork::replay)) {
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

// The file of PipelineSettings::checkpoint while frames pass.
class CheckpointFile {
 public:
  CheckpointFile(const PipelineSettings& settings, bool is_wanted) : settings_(settings), is_wanted_(is_wanted) {}

  void frame_made() { is_old_ = true; }
  void save_if_due(const TemporalHistory& history, std::size_t done, std::size_t total) {
    const auto every = static_cast<std::size_t>(settings_.checkpoint_every);
    if (done == total || (settings_.checkpoint_every > 0 && done % every == 0)) {
      save(history);
    }
  }
  void save(const TemporalHistory& history) {
    if (is_wanted_ && is_old_) {
      save_checkpoint(settings_.checkpoint, history, settings_.settings_digest);
      is_old_ = false;
    }
  }

 private:
  const PipelineSettings& settings_;
  bool is_wanted_;
  bool is_old_ = false;  // frames have passed since it was written
};

// A frame that has passed, made or not.
void tell(const PipelineObserver& observer, const FrameRequest& request, bool skipped, const TimingRow& row,
          RenderedFrame&& rendered) {
  if (observer.frame_done) {
    observer.frame_done(row, skipped);
  }
  if (observer.take_frame && !skipped && !rendered.frame.radiance.empty()) {
    observer.take_frame(request, std::move(rendered), row);
  }
}

// All frames of the plan in order, until the sequence is asked to stop.
void make_frames(const SequenceInputs& inputs, const ResumePlan& resume, SequenceRenderer& renderer,
                 const std::optional<ClipRate>& rate, TemporalHistory& history, RunLog& log, SequenceResult& result) {
  const FramePlan& plan = inputs.plan;
  const PipelineObserver& observer = inputs.observer;
  CheckpointFile checkpoint(inputs.settings, resume.writes_checkpoint);
  double made_ms = 0;
  int made = 0;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const FrameRequest& request = plan.frames[i];
    const FrameWork work = resume.work[i];
    TimingRow row = timing_row(request);
    RenderedFrame rendered;
    if (work != FrameWork::skip) {
      result.interrupted = is_asked_to_stop(observer, made == 0 ? 0 : made_ms / made);
      if (result.interrupted) {
        break;
      }
      if (observer.frame_begins) {
        observer.frame_begins(request);
      }
      const Stopwatch own_time;  // without the choice of the rate, which the first row counts
      result.interrupted =
          !is_completed([&] { rendered = make_frame(inputs, request, work, renderer, history, row, result); });
      if (result.interrupted) {
        break;
      }
      if (work == FrameWork::render) {
        if (rate) {
          add_rate(*rate, result.rows.empty(), row);
        }
        log.add(row, result);
      }
      made_ms += own_time.elapsed_ms();
      ++made;
      checkpoint.frame_made();
    }
    checkpoint.save_if_due(history, i + 1, plan.frames.size());
    const bool skipped = work != FrameWork::render;
    if (skipped && i >= static_cast<std::size_t>(inputs.settings.preroll)) {
      result.skipped.push_back(request.frame);
    }
    tell(observer, request, skipped, row, std::move(rendered));
  }
  if (result.interrupted) {
    checkpoint.save(history);
  }
}

}  // namespace

SequenceResult render_sequence(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer,
                               TemporalHistory history) {
  const RunPaths paths = paths_of(plan, settings);
  ResumePlan resume = plan_resume(plan, settings, paths, history);
  if (resume.taken_up) {
    history = std::move(*resume.taken_up);
  }
  const std::vector<std::int32_t> to_make = frames_to_make(plan, resume, true);
  const std::vector<std::int32_t> to_render = frames_to_make(plan, resume, false);
  check_history_for(to_make, settings, history);
  if (settings.stage == SequenceStage::finish) {
    check_all_traced(to_make, settings);
  }
  SequenceResult result;
  result.warnings = resume.warnings;

  FrameSettings own = frame_settings(settings, color);
  std::optional<ClipRate> rate;
  if (own.foveation.target.jod && !to_make.empty()) {
    result.interrupted =
        is_asked_to_stop(observer, 0) || !is_completed([&] { rate = clip_rate(tracer, plan.judged, own, color); });
  }
  if (rate) {
    own = with_rate(std::move(own), *rate);
    result.facts.emplace_back("rate", rate->text());
    const std::vector<std::string> doubts = rate->doubts();
    result.warnings.insert(result.warnings.end(), doubts.begin(), doubts.end());
  }

  SequenceRenderer renderer(tracer, std::move(own), plan, {to_render.begin(), to_render.end()});
  RunLog log{TimingLog(paths.timing, resume.kept_rows), FileJournal(paths.record, resume.kept_files)};
  if (!settings.output.display.pattern.empty() && !plan.frames.empty()) {
    const FrameRequest& first = plan.frames.front();
    color.prepare(first.width_px, first.height_px, display_image_bits(settings.output.display), settings.threads);
  }
  if (!result.interrupted) {
    make_frames({plan, color, settings, observer}, resume, renderer, rate, history, log, result);
  }
  if (result.interrupted) {
    result.left = frames_left(to_render, result.rows);
  }
  log.timing.finish();
  result.files = log.journal.files();
  return result;
}

}  // namespace gazetrace
