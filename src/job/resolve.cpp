// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/resolve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "gazetrace/error.hpp"
#include "job/choose_frames.hpp"
#include "job/defaults.hpp"
#include "job/exposure_probe.hpp"
#include "job/frame_size.hpp"
#include "job/gaze_inputs.hpp"
#include "job/job_plan.hpp"
#include "job/judged_plan.hpp"
#include "job/plan_settings.hpp"
#include "job/sampling_notes.hpp"
#include "job/scene.hpp"
#include "job/scene_camera.hpp"

namespace gazetrace {
namespace {

void append(Warnings& to, const Warnings& from) {
  to.insert(to.end(), from.begin(), from.end());
}

bool judges_sequence(const JobSettings& job) {
  return job.foveation.target.jod.has_value();
}

void load_viewing(ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  std::int64_t taken_off_ns = 0;
  resolved.gaze = gaze_of_job(job, taken_off_ns);
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  resolved.plan_settings = plan_settings(job, {}, log, taken_off_ns, resolved.decisions);
  if (log != nullptr) {
    append(resolved.warnings, log->warnings);
  }
}

// What is quick to find out, so that a wrong name is found before a scene is loaded.
void check_before_scene(const JobSettings& job, ResolveScope scope, const GazeLog* log, std::int64_t taken_off_ns) {
  check_frame_size(job);
  if (scope == ResolveScope::render) {
    check_frame_memory(job);
  }
  Decisions unused;
  check_screen(plan_settings(job, {1}, log, taken_off_ns, unused), log);
  if (scope == ResolveScope::render) {
    check_environment_file(job);
  }
}

void load_scene_of(const JobSettings& job, const ResolveOptions& options, ResolvedJob& resolved) {
  if (job.scene.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "name a .gltf or .glb file");
  }
  const auto begin = std::chrono::steady_clock::now();
  SceneReadOptions reading = scene_read_options(job);
  reading.progress = options.progress;
  resolved.scene = std::make_unique<Scene>(load_scene(job.scene, reading));
  if (options.scope == ResolveScope::render) {
    check_scene_shows(*resolved.scene);
    resolved.decisions.emplace_back("environment", set_environment(job, *resolved.scene));
  }
  resolved.load_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  append(resolved.warnings, resolved.scene->warnings);
  append(resolved.warnings, resolved.scene->environment.warnings);
}

// Whether the scene's animation may decide how many frames are wanted, how many are judged, or whether they join.
bool length_needs_scene(const JobSettings& job, const CameraPath& camera, const GazeLog* log) {
  const bool is_whole = judges_sequence(job) || job.accumulate.mode == AccumulateMode::automatic;
  return may_follow_scene(job, camera, log, is_whole);
}

const Scene* scene_of(const ResolveOptions& options, const ResolvedJob& resolved) {
  return options.loaded != nullptr ? options.loaded : resolved.scene.get();
}

// The scene is loaded as late as can be: a camera that is not in it is read first.
CameraPath load_camera_and_scene(const ResolveOptions& options, const GazeLog* log, std::int64_t taken_off_ns,
                                 ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  const bool needs_scene = camera_needs_scene(job);
  CameraPath camera;
  std::string decision;
  if (!needs_scene) {
    camera = choose_camera(job, nullptr, log, taken_off_ns, decision);
  }
  const bool asks_scene = !job.scene.empty() && (needs_scene || length_needs_scene(job, camera, log));
  if (options.loaded == nullptr && (options.scope == ResolveScope::render || asks_scene)) {
    load_scene_of(job, options, resolved);
  }
  if (needs_scene) {
    camera = choose_camera(job, scene_of(options, resolved), log, taken_off_ns, decision);
  }
  resolved.decisions.emplace_back("camera", decision);
  return camera;
}

std::string sampling_without_gaze(const FoveationSettings& foveation) {
  const std::string rate = fmt::format("{} samples a pixel", foveation.spp.value_or(kUsualSpp));
  return rate + " everywhere: there is no gaze";
}

void choose_wanted_frames(const ViewInputs& inputs, ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  std::string decision;
  resolved.frames = choose_frames(job, inputs, decision);
  resolved.decisions.emplace_back("frames", decision);
  settle_accumulation(inputs, resolved.frames, resolved.job, resolved.decisions);
  settle_rate(inputs.log, resolved.job.settings);
  if (inputs.log == nullptr && !follows_picture(job.foveation.sampling)) {
    resolved.decisions.emplace_back("sampling", sampling_without_gaze(job.foveation));
  }
  if (job.chunk && job.chunk->count > 1) {  // one of one divides nothing
    keep_to_chunk(job, inputs.camera, inputs.taken_off_ns, resolved);
  }
}

void check_eccentricity(const JobSettings& job, const GazeLog* log) {
  const auto& aovs = job.exr.aovs;
  if (log == nullptr && std::find(aovs.begin(), aovs.end(), "eccentricity") != aovs.end()) {
    throw Error(ErrorKind::usage, "`aov`", "there is no eccentricity without gaze", "give `gaze` or `gaze-at`");
  }
}

// A single picture is the same for every frame.
void check_density_pictures(const FoveationSettings& foveation, const FramePlan& plan) {
  const std::string files = picture_files_of(foveation.sampling);
  for (const std::vector<FrameRequest>* frames : {&plan.frames, &plan.around}) {
    for (const FrameRequest& request : *frames) {
      read_density_picture(foveation, request.frame);
      if (!has_frame_number(files)) {
        return;
      }
    }
  }
}

void warn_of_filter(const JobSettings& job, Warnings& warnings) {
  if (job.trace.filter != PixelFilter::box && Reconstruction({job.filter}).needs().guides) {
    warnings.push_back(
        fmt::format("`filter` {} takes edges, texture and emission from a box of one pixel: `pixel-filter` "
                    "blackman-harris is missing there, `filter` linear keeps it",
                    job.filter));
  }
}

// Of a setting whose meaning changed in this version, and which was not given by its former name. What it is for a
// density stands in the line on sampling.
void warn_of_mean_rate(const Job& job, Warnings& warnings) {
  const FoveationSettings& foveation = job.settings.foveation;
  const auto source = job.sources.find("spp");
  const OptionSource given = source == job.sources.end() ? OptionSource() : source->second;
  if (foveation.spp && given.former.empty() && regions_of(foveation.sampling) != nullptr &&
      given.origin == Origin::file) {
    warnings.push_back(
        fmt::format("`spp` {} of {} is the mean of a frame, to which the counts of regions are scaled; "
                    "it meant nothing to regions before",
                    *foveation.spp, to_string(given)));
  }
}

void warn_of_inputs(const CameraPath& camera, const GazeLog* log, ResolveScope scope, ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  append(resolved.warnings, camera.warnings);
  warn_of_filter(job, resolved.warnings);
  if (log != nullptr) {
    warn_of_mean_rate(resolved.job, resolved.warnings);
    append(resolved.warnings, log->warnings);
  }
  append(resolved.warnings, resolved.plan.warnings);
  if (scope != ResolveScope::digests) {
    const SamplingNotes notes = sampling_notes(resolved.job, resolved.plan);
    append(resolved.warnings, notes.warnings);
    // The choice of a sampling for a stated quality has a line of its own.
    const bool is_told = job.foveation.target.is_given() && !resolved.job.sources.contains("sampling");
    if (!notes.decision.empty() && !is_told) {
      resolved.decisions.emplace_back("sampling", notes.decision);
    }
  }
}

// Inputs that are quick to read come first; the plan follows from all of them.
void load_and_plan(const ResolveOptions& options, ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  std::int64_t taken_off_ns = 0;
  resolved.gaze = gaze_of_job(job, taken_off_ns);
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  follow_screen_shape(log, taken_off_ns, resolved.job, resolved.decisions);
  check_before_scene(job, options.scope, log, taken_off_ns);
  const CameraPath camera = load_camera_and_scene(options, log, taken_off_ns, resolved);
  ViewInputs inputs{camera, log, taken_off_ns, scene_of(options, resolved)};
  choose_wanted_frames(inputs, resolved);
  make_plan(job, camera, taken_off_ns, resolved);
  if (judges_sequence(job)) {
    inputs.steering = resolved.steering ? &*resolved.steering : nullptr;
    resolved.plan.judged = plan_judged_frames(job, inputs, resolved.plan_settings, resolved.decisions);
  }
  check_eccentricity(job, log);
  if (options.scope == ResolveScope::render) {
    resolved.exposure_probe = plan_exposure_probe(job, inputs, resolved.plan_settings);
    check_density_pictures(job.foveation, resolved.plan);
  }
  warn_of_inputs(camera, log, options.scope, resolved);
}

void set_pipeline(ResolveScope scope, ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  resolved.pipeline = pipeline_settings(job);
  if (resolved.pipeline.foveation.max_block_px != job.foveation.max_block_px) {
    resolved.decisions.emplace_back("max-block", "1, so that the samples of frames at rest can be added up");
  }
  if (scope == ResolveScope::render) {
    check_frame_memory(job);
    check_output_settings(resolved.pipeline.output, resolved.frames.size() > 1);
  }
}

// The digest of what a picture is an estimate of.
std::string digest_of_mean(const JobSettings& job, const std::map<std::string, std::string>& files) {
  JobSettings same = job;
  same.trace.seed = 0;
  if (is_uniform(job.foveation.sampling) && job.filter == "none") {
    same.foveation.spp.reset();
  }
  return digest_job(same, files);
}

void set_digests(ResolvedJob& resolved) {
  resolved.input_digests = digest_job_files(resolved.job.settings);
  resolved.pipeline.settings_digest = digest_job(resolved.job.settings, resolved.input_digests);
  resolved.pipeline.mean_digest = digest_of_mean(resolved.job.settings, resolved.input_digests);
  // The same options choose other rates where a view at rest is judged as a still, and not as a clip.
  if (const JudgedFrames& judged = resolved.plan.judged; !judged.runs.empty()) {
    resolved.pipeline.settings_digest =
        digest_settings({{"settings", resolved.pipeline.settings_digest},
                         {"frames of what is judged", fmt::format("{}", judged.sequence_frames)}});
  }
}

}  // namespace

ResolvedJob resolve(const Job& job, const ResolveOptions& options) {
  ResolvedJob resolved;
  resolved.job = job;
  resolved.decisions = job.decisions;
  if (options.scope == ResolveScope::viewing) {
    load_viewing(resolved);
    return resolved;
  }
  resolved.job = with_default_sampling(job, &resolved.decisions);
  check_job(resolved.job);
  if (options.tell_idle) {
    resolved.warnings = idle_option_warnings(resolved.job);
  }
  append(resolved.warnings, job.warnings);
  const FilterChoice filter = filter_of(resolved.job.settings);
  resolved.job.settings.filter = filter.name;
  load_and_plan(options, resolved);
  if (!filter.reason.empty()) {
    resolved.decisions.emplace_back("filter", filter.name + ", because " + filter.reason);
  }
  set_pipeline(options.scope, resolved);
  if (options.scope != ResolveScope::plan) {
    set_digests(resolved);
  }
  return resolved;
}

TracerOptions tracer_options(const JobSettings& job) {
  TracerOptions options;
  options.threads = job.threads;
  return options;
}

}  // namespace gazetrace
