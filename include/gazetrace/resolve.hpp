// SPDX-License-Identifier: Apache-2.0
// From a job to loaded and checked inputs. Everything that can fail fails here, before the first ray is traced.
// run_job.hpp makes files of a job; in memory a run is
//   const Job job = load_job("job.toml");
//   ResolvedJob resolved = resolve(job);
//   PathTracer tracer(*resolved.scene, tracer_options(resolved.job.settings));
//   settle_exposure(tracer, resolved);
//   render_sequence(tracer, resolved.plan, ColorPipeline(resolved.job.settings.color), resolved.pipeline, {});
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
  // How pictures of the job are looked at: the gaze log with its clock, the screen, and where the frame lies on it,
  // which are in `gaze` and `plan_settings`. The plan stays empty, and scene, camera and outputs are not looked at. The
  // screen is not checked, and stays empty where neither the job nor the log states one.
  viewing,
  // The plan alone. The scene is read only where the camera comes from it, or where the number of frames may (no
  // `frames`, a camera at rest, no gaze log), and may be missing where nothing needs it.
  // No file is hashed.
  plan,
  // The plan and the digests of all files, for work on pictures that were rendered already.
  digests,
  // Everything that a rendering needs: the scene with its environment, and the digests.
  render,
};

struct ResolveOptions {
  ResolveScope scope = ResolveScope::render;
  // Reports the loading of the scene's textures and meshes, see SceneReadOptions.
  std::function<void(std::size_t done, std::size_t total)> progress;
  // If set, this scene with its environment is used instead of the job's file, and ResolvedJob::scene stays empty.
  const Scene* loaded = nullptr;
  // Whether the warnings include options that have no effect.
  bool tell_idle = true;
};

// Shared by the tasks of an array job: how the frames are divided (ChunkFile), for the first task to write down.
struct ChunkBorders {
  std::string path;  // empty: nothing is divided
  std::string text;  // empty: it is written
};

struct ResolvedJob {
  Job job;  // with the filter that "auto" stands for
  std::unique_ptr<Scene> scene;
  std::optional<GazeLog> gaze;            // without times of day, unless the job keeps them
  std::optional<ProcessedGaze> steering;  // the gaze after the steps of `gaze-process`
  PlanSettings plan_settings;
  FramePlan plan;
  FramePlan exposure_probe;          // small frames of the whole sequence; empty where the exposure is fixed
  std::vector<std::int32_t> frames;  // those that are wanted
  ChunkBorders chunk_borders;        // prepare_outputs() writes them once
  PipelineSettings pipeline;         // with its digest, from the scope `digests` on
  std::map<std::string, std::string> input_digests;  // path -> content hash
  // Decisions where the settings left a choice, such as "environment" -> "the built-in sky, ...", and which
  // settings were replaced by others.
  Decisions decisions;
  Warnings warnings;  // about scene, camera, log and plan; those about options without effect come first
  double load_s = 0;  // of scene and environment
};

// Where a quality is stated (QualityTarget::jod or ::relmse) and nothing names a sampling, one is chosen that
// can meet it, and `decisions` says so. Throws Error(usage or input) for anything that is wrong with the job or with
// the files that it names, as far as the scope goes. Writes nothing. For pictures that were rendered already,
// recorded_run.hpp finds the job.
ResolvedJob resolve(const Job& job, const ResolveOptions& options = {});

// The checks that need no input file: ranges, names, patterns, and options that exclude each other; and whether the
// folders of the outputs can be written to. resolve() begins with these checks, except with the scope viewing.
void check_job(const Job& job, const JobSchema& schema = job_schema());

// The filter that the setting names, without a reason; or the filter that "auto" stands for, with the reason, see
// choose_filter().
FilterChoice filter_of(const JobSettings& job);

TracerOptions tracer_options(const JobSettings& job);

// Throws Error(input) naming the first output that exists, unless the job overwrites or resumes. Then makes the folders
// and tests whether files can be created in them.
void make_output_folders(const ResolvedJob& resolved);
// The same, and Error(usage) where the job resumes and would render over finished frames of other settings or inputs,
// unless it overwrites as well. Writes down how frames are divided. A run claims its files before (output_lock.hpp).
void prepare_outputs(const ResolvedJob& resolved);

// Where the exposure is automatic: renders `exposure_probe`, at most eight small frames, fixes the exposure of the
// pipeline at their mean, to a hundredth of a stop, and says so in the decisions. It depends on the whole sequence and
// not on the frames that are wanted, their sampling or their seed, so that parts of a sequence, and renderings to be
// compared, share it. Without this call every frame has an exposure of its own.
void settle_exposure(PathTracer& tracer, ResolvedJob& resolved);

// The record of a run that begins now, whose state is "running"; finish_run_record() states how it ended. The record
// carries no time of day of the gaze log unless the job keeps them, except those that the job itself states in
// `gaze-start` and `gaze-anchor`. `command_line` may be empty.
RunRecord start_run_record(const ResolvedJob& resolved, const PathTracer& tracer, const ColorPipeline& color,
                           const std::vector<std::string>& command_line = {});
void finish_run_record(RunRecord& record, const SequenceResult& result, const FramePlan& plan, double wall_s);
// The report on a finished run: frames without gaze, clamped values, and samples that were not finite, with the
// options that replay them.
Warnings result_warnings(const SequenceResult& result, const FramePlan& plan);

// ---- Parts of resolve(), for commands that need no more

// A share of a sequence's frames.
struct FrameChunk {
  std::vector<std::int32_t> frames;
  double samples = 0;  // that the plan expects of them; 0: not known before they are rendered
};
// Divides the frames of a plan so that all chunks cost about the same, by the samples of their maps and their pixels,
// or by their number where a pilot decides the samples. The same for every task, since nothing is measured.
std::vector<FrameChunk> balanced_chunks(const JobSettings& job, const FramePlan& plan, std::uint32_t count);

// The pipeline settings of a job, without digests. Patterns of file names are not checked against the number of frames.
PipelineSettings pipeline_settings(const JobSettings& job);
// Content hashes of all files that the job reads.
std::map<std::string, std::string> digest_job_files(const JobSettings& job);
// The files that it names and that are there, with those that its scene consists of.
std::vector<std::string> job_files(const JobSettings& job);
// The digest of everything that affects pixels: options, file contents, version. The same files under other names give
// the same digest, and so do the parts of a sequence, however it is cut.
std::string digest_job(const JobSettings& job, const std::map<std::string, std::string>& files,
                       const JobSchema& schema = job_schema());

std::optional<DisplayGeometry> screen_geometry(const ScreenSettings& screen);
GazeColumns merged_columns(const GazeFileSettings& gaze);  // the column map, overridden by the options
GazeReadOptions read_options(const GazeFileSettings& gaze, const ScreenSettings& screen);
GazeLog read_gaze_file(const GazeFileSettings& gaze, const ScreenSettings& screen);
// Throws Error(usage, input) for anchors that are wrong; `decision` receives the result of the anchors, in words.
// `taken_off_ns` is how many nanoseconds the log's stamps are below those of its file.
GazeMapping gaze_mapping(const JobSettings& job, const GazeLog* log, std::int64_t taken_off_ns = 0,
                         std::string* decision = nullptr);
// Where the log of a screen gives no angles, takes missing values of its geometry from the given screen.
void complete_recording_geometry(GazeLog& log, const ScreenSettings& screen);
std::vector<GazeStep> gaze_steps_of(const std::vector<std::string>& texts);
// Whether the camera comes from the scene's file.
bool camera_needs_scene(const JobSettings& job);
// Sets the environment of the scene, which also decides on "auto"; returns the choice in words.
std::string set_environment(const JobSettings& job, Scene& scene);
// How the scene of a job is read: its animation, threads and limits.
SceneReadOptions scene_read_options(const JobSettings& job);
// The scene of the job with its environment.
Scene load_job_scene(const JobSettings& job,
                     const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace gazetrace
