// SPDX-License-Identifier: Apache-2.0
// From a job to loaded and checked inputs: everything that can fail is found here, before the first ray. A run is
//   const Job job = load_job("job.toml");
//   ResolvedJob resolved = resolve(job);
//   PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
//   render_sequence(tracer, resolved.plan, ColorPipeline(resolved.job.settings.color), resolved.pipeline, {},
//                   std::move(resolved.history));
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

enum class ResolveScope {
  // The plan alone. The scene is read only where the camera comes from it, and may be missing where nothing needs it;
  // no file is hashed.
  plan,
  // The plan, and digests of all files: for what belongs to pictures that were rendered already.
  digests,
  // All that a rendering needs: the scene with its environment, digests, and the history it begins with.
  render,
};

struct ResolveOptions {
  ResolveScope scope = ResolveScope::render;
  // Of the scene's textures and meshes, see SceneReadOptions.
  std::function<void(std::size_t done, std::size_t total)> progress;
  // This scene, with its environment, is taken in place of the job's file, and ResolvedJob::scene stays empty.
  const Scene* loaded = nullptr;
  // Options that do nothing are among the warnings.
  bool tell_idle = true;
};

struct ResolvedJob {
  Job job;  // with the filter that "auto" stands for
  std::unique_ptr<Scene> scene;
  std::optional<GazeLog> gaze;            // without times of day, unless the job keeps them
  std::optional<ProcessedGaze> steering;  // what `gaze-process` made of it
  PlanSettings plan_settings;
  FramePlan plan;                                    // with the frames of `preroll` at its beginning
  std::vector<std::int32_t> frames;                  // that are wanted
  PipelineSettings pipeline;                         // with its digests, unless the scope is the plan alone
  TemporalHistory history;                           // what the first frame finds; scope render
  std::map<std::string, std::string> input_digests;  // path -> content hash
  // What was decided where the settings left a choice, "environment" -> "the built-in sky, ...", and what of the
  // settings replaced what.
  Decisions decisions;
  Warnings warnings;  // of scene, camera, log and plan; options that do nothing come first
  double load_s = 0;  // of scene and environment
};

// Error(usage or input) for whatever is wrong with the job or the files that it names. Nothing is written.
ResolvedJob resolve(const Job& job, const ResolveOptions& options = {});

// The checks that need no file: ranges, names, patterns, what excludes what; and whether the folders of the outputs can
// be written to. resolve() begins with it.
void check_job(const Job& job, const JobSchema& schema = job_schema());

// What `filter` says, without a reason, or what its "auto" stands for and why: see choose_filter().
FilterChoice filter_of(const JobSettings& job);

TracerOptions tracer_options(const JobSettings& job);

// Error(input) naming the first output that exists, unless the job overwrites or resumes; then makes the folders and
// tries whether files can be made in them.
void prepare_outputs(const ResolvedJob& resolved);

// The record of a run that begins now, which says "running"; finish_run_record() says what became of it. It carries no
// time of day of the gaze log unless the job keeps them, but what the job itself says in `gaze-start` and
// `gaze-anchor`. `command_line` may be empty.
RunRecord start_run_record(const ResolvedJob& resolved, const PathTracer& tracer, const ColorPipeline& color,
                           const std::vector<std::string>& command_line = {});
void finish_run_record(RunRecord& record, const SequenceResult& result, const FramePlan& plan, double wall_s);
// What to tell of a finished run: frames without gaze, clamped values, samples that were not finite with the options
// that replay them.
Warnings result_warnings(const SequenceResult& result, const FramePlan& plan);

// ---- parts of it, for commands that need no more

// Pipeline settings from a job's. Without digests; patterns are not held against the number of frames.
PipelineSettings pipeline_settings(const JobSettings& job);
// Content hashes of all files that the job reads.
std::map<std::string, std::string> digest_job_files(const JobSettings& job);
// Sets the digests of `settings`: of what reaches into pixels (options, file contents, version), and of this with the
// frame list and where the history comes from, where frames depend on those before them. The same files under other
// names give the same digests.
void digest_job(const JobSettings& job, const std::vector<std::int32_t>& frames,
                const std::map<std::string, std::string>& files, PipelineSettings& settings,
                const JobSchema& schema = job_schema());

std::optional<DisplayGeometry> screen_geometry(const ScreenSettings& screen);
GazeColumns merged_columns(const GazeFileSettings& gaze);  // options over the column map
GazeReadOptions read_options(const GazeFileSettings& gaze, const ScreenSettings& screen);
GazeLog read_gaze_file(const GazeFileSettings& gaze, const ScreenSettings& screen);
// Error(usage, input) of anchors; `decision` says what they gave. `taken_off_ns` are the nanoseconds by which the log's
// stamps are less than those of its file.
GazeMapping gaze_mapping(const JobSettings& job, const GazeLog* log, std::int64_t taken_off_ns = 0,
                         std::string* decision = nullptr);
// Where the log of a screen knows no angles, what it does not state of its geometry is that of the given screen.
void complete_recording_geometry(GazeLog& log, const ScreenSettings& screen);
std::vector<GazeStep> gaze_steps_of(const std::vector<std::string>& texts);
// The camera stands in the scene's file.
bool camera_needs_scene(const JobSettings& job);
// "auto" is resolved by the scene; returns what was taken, in words.
std::string set_environment(const JobSettings& job, Scene& scene);
// The scene of the job with its environment.
Scene load_job_scene(const JobSettings& job,
                     const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace gazetrace
