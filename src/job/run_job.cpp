// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/run_job.hpp"

#include <chrono>
#include <utility>

#include "gazetrace/aovs.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output_lock.hpp"
#include "job/run_record_file.hpp"

namespace gazetrace {
namespace {

struct AovsOfMemory {
  bool first_hits = false;  // they show what samples hit first
  LayerSettings layers;
};

// AOVs that no EXR is to hold are no mistake where frames are looked at in memory. Takes such ones out of the job.
AovsOfMemory take_aovs_of_memory(JobSettings& settings) {
  const PipelineSettings pipeline = pipeline_settings(settings);
  OutputSettings output = pipeline.output;
  if (output.exr.pattern.empty()) {
    output.exr.pattern = "frame.####.exr";
    check_output_settings(output, false);
    settings.exr.aovs.clear();
  }
  return {pipeline.trace.guides, pipeline.layers};
}

// Pictures go through the view, and so does the judging of a sequence's quality.
ColorSettings colors_of_run(const JobSettings& job, const RunOptions& options) {
  ColorSettings color = job.color;
  color.is_needed = options.shows_frames || !pipeline_settings(job).output.display.pattern.empty() ||
                    job.foveation.target.jod.has_value();
  return color;
}

ResolvedJob resolve_run(const Job& job, const RunObserver& observer, const RunOptions& options) {
  if (job.settings.scene.empty() && options.loaded == nullptr) {
    throw Error(ErrorKind::usage, "", "no scene was given", "give `scene`");
  }
  ResolveOptions resolving;
  resolving.progress = observer.loading;
  resolving.loaded = options.loaded;
  if (!options.shows_frames) {
    return resolve(job, resolving);
  }
  Job asked = job;
  const AovsOfMemory aovs = take_aovs_of_memory(asked.settings);
  ResolvedJob resolved = resolve(asked, resolving);
  resolved.pipeline.trace.guides = resolved.pipeline.trace.guides || aovs.first_hits;
  resolved.pipeline.layers = aovs.layers;
  return resolved;
}

SequenceResult render(ResolvedJob& resolved, PathTracer& tracer, const ColorPipeline& color,
                      const RunObserver& observer, const RunRecordFile& file) {
  bool any_done = false;
  PipelineObserver frames = observer;
  frames.frame_done = [&](const TimingRow& row, bool skipped) {
    any_done = true;
    if (observer.frame_done) {
      observer.frame_done(row, skipped);
    }
  };
  try {
    return render_sequence(tracer, resolved.plan, color, resolved.pipeline, frames);
  } catch (const Error& error) {
    // The folder is left as it was, so that the same job can be started again with what the message advises.
    if (error.kind() == ErrorKind::usage && !any_done) {
      file.put_back();
    }
    throw;
  }
}

}  // namespace

FinishedRun run_job(const Job& job, const RunObserver& observer, const RunOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto color = std::make_shared<ColorPipeline>(colors_of_run(job.settings, options));
  FinishedRun run;
  ResolvedJob& resolved = run.resolved = resolve_run(job, observer, options);
  resolved.warnings.insert(resolved.warnings.end(), color->warnings().begin(), color->warnings().end());
  make_output_folders(resolved);
  const OutputLock lock = lock_outputs(resolved.pipeline, resolved.frames);
  resolved.warnings.insert(resolved.warnings.end(), lock.warnings().begin(), lock.warnings().end());
  prepare_outputs(resolved);
  const std::vector<std::string> files = output_files(resolved.pipeline, resolved.frames);
  if (observer.building_tree) {
    observer.building_tree();
  }
  PathTracer tracer(options.loaded != nullptr ? *options.loaded : *resolved.scene,
                    tracer_options(resolved.job.settings));
  settle_exposure(tracer, resolved);
  const RunRecordFile file(files.empty() ? std::string() : files.front(), options.words);
  run.record = start_run_record(resolved, tracer, *color, options.command_line);
  if (resolved.job.settings.resume) {
    file.check_machine(run.record, resolved.warnings);
    run.record.warnings = resolved.warnings;
  }
  const StartedRun started{resolved, tracer, color, files};
  if (observer.begins) {
    observer.begins(started);
  }
  file.write(run.record);

  resolved.pipeline.trace.stop = observer.stop_now;
  const Clock::time_point begin = Clock::now();
  run.result = render(resolved, tracer, *color, observer, file);
  run.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  finish_run_record(run.record, run.result, resolved.plan, run.wall_s);
  if (!files.empty()) {
    file.write(run.record);
    finish_files(files.front());
  }
  run.warnings = result_warnings(run.result, resolved.plan);
  resolved.pipeline.trace.stop = {};
  return run;
}

}  // namespace gazetrace
