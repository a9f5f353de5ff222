// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/resolve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

#include "gazetrace/error.hpp"
#include "job/choose_frames.hpp"
#include "job/chunks.hpp"
#include "job/gaze_inputs.hpp"
#include "job/judged_plan.hpp"
#include "job/outputs.hpp"
#include "job/quality_defaults.hpp"
#include "job/saving.hpp"
#include "job/scene.hpp"
#include "job/scene_camera.hpp"

namespace gazetrace {
namespace {

void append(Warnings& to, const Warnings& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Where the log states no size, the size follows from its pixels per degree, as only the ratio to the distance matters.
DisplayGeometry recording_display(const GazeLog& log, Decisions& decisions) {
  const DisplayGeometry& stated = *log.recording_geometry;
  const bool no_angles = !(stated.width_cm > 0) || !(stated.height_cm > 0) || !(stated.distance_cm > 0);
  const auto& ppd = log.pixels_per_degree;
  if (no_angles && stated.width_px > 0 && stated.height_px > 0 && ppd && ppd->x > 0 && ppd->y > 0) {
    decisions.emplace_back(
        "screen", fmt::format("that of the recording, by the log's {:.4g} x {:.4g} pixels a degree", ppd->x, ppd->y));
    return display_of_pixels_per_degree(stated.width_px, stated.height_px, *ppd);
  }
  decisions.emplace_back("screen", "that of the recording, as the gaze log states it");
  return stated;
}

PlanSettings plan_settings(const JobSettings& job, const std::vector<std::int32_t>& frames, const GazeLog* log,
                           std::int64_t taken_off_ns, Decisions& decisions) {
  PlanSettings settings;
  settings.frames = frames;
  settings.fps = job.fps;
  settings.start_ns = job.start.ns;
  settings.shutter = job.shutter;
  settings.camera_extrapolation = job.camera_extrapolation;
  std::string clock;
  settings.gaze = gaze_mapping(job, log, taken_off_ns, &clock);
  if (!clock.empty()) {
    decisions.emplace_back("gaze clock", clock);
  }
  settings.gaze_latency_ns = job.gaze_at ? 0 : job.gaze_latency.ns;
  settings.most_frames_without_gaze = job.gaze_max_missing_frames;
  settings.width_px = job.size.width;
  settings.height_px = job.size.height;
  settings.display = screen_geometry(job.screen);
  if (settings.display) {
    decisions.emplace_back("screen", job.screen.name.empty() ? "as given" : job.screen.name);
  } else if (log != nullptr && log->recording_geometry && log->kind == GazeKind::screen) {
    settings.display = recording_display(*log, decisions);
  }
  settings.transfer = job.gaze_transfer;
  if (job.frame_rect) {
    settings.frame_rect = *job.frame_rect;
  }
  return settings;
}

void check_screen(const PlanSettings& settings, const GazeLog* log) {
  if (log != nullptr && log->kind == GazeKind::screen && !settings.display) {
    throw Error(ErrorKind::input, log->source, "gaze on a screen needs the screen's size and distance",
                "give `screen` NAME, or `screen-px`, `screen-cm` and `screen-distance-cm`");
  }
  if (settings.display) {
    check_display(*settings.display);
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
  if (job.accumulate.mode == AccumulateMode::running && moves(*resolved.scene)) {
    resolved.warnings.emplace_back(
        "`accumulate` running looks at the camera alone: what moves in the scene is smeared");
  }
}

std::string sampling_without_gaze(const FoveationSettings& foveation) {
  const QualityTarget& target = foveation.target;
  const std::string rate = target.time_s              ? "as many samples as `time-budget` allows"
                           : target.is_given()        ? "as many samples as the stated quality takes"
                           : foveation.budget_spp     ? fmt::format("{} samples a pixel", *foveation.budget_spp)
                           : foveation.budget_samples ? fmt::format("{} samples in all", *foveation.budget_samples)
                                                      : fmt::format("{} samples", foveation.uniform_spp);
  return rate + " everywhere: there is no gaze";
}

// Whether there are rates for a frame that nobody asked for.
bool has_density_map(const FoveationSettings& foveation, std::int64_t frame) {
  return foveation.falloff != "map" || !has_frame_number(foveation.density_map) ||
         std::filesystem::exists(frame_file_name(foveation.density_map, static_cast<std::int32_t>(frame)));
}

// For accumulation from both sides: the frames that those of the plan read beside each other. They exist from frame 1
// on and as far as the camera's path goes, whether or not they are rendered, so that a frame is the same in every run.
void add_frames_around(const JobSettings& job, const CameraPath& camera, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  PlanSettings settings = resolved.plan_settings;
  const std::set<std::int32_t> asked(settings.frames.begin(), settings.frames.end());
  std::set<std::int32_t> all = asked;
  for (const std::int32_t frame : asked) {
    for (std::int32_t apart = -job.accumulate.window; apart <= job.accumulate.window; ++apart) {
      const std::int64_t near = std::int64_t{frame} + apart;
      if (has_frame(camera, settings, near) && has_density_map(job.foveation, near)) {
        all.insert(frame + apart);
      }
    }
  }
  settings.frames.assign(all.begin(), all.end());
  // What the eye did since the frame before is asked of neighbours, so that it is that of this plan.
  FramePlan whole = plan_frames(camera, log, settings, resolved.steering ? &*resolved.steering : nullptr);
  resolved.plan.frames.clear();
  for (FrameRequest& request : whole.frames) {
    (asked.contains(request.frame) ? resolved.plan.frames : resolved.plan.around).push_back(std::move(request));
  }
}

void make_plan(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  std::vector<std::int32_t> planned = frames_before(resolved.frames, job.preroll);
  planned.insert(planned.end(), resolved.frames.begin(), resolved.frames.end());
  PlanSettings settings = plan_settings(job, planned, log, taken_off_ns, resolved.decisions);
  if (log != nullptr) {
    settings.uncertainty = gaze_uncertainty(job, *log);
  }
  if (log != nullptr && !job.gaze_at) {
    settings.find_speed = job.foveation.retinal_velocity;
    if (!job.gaze_process.empty()) {
      resolved.steering = process_gaze(*log, gaze_steps_of(job.gaze_process));
      resolved.decisions.emplace_back("gaze processing",
                                      fmt::format("{}", fmt::join(resolved.steering->reports, "; ")));
    }
  }
  resolved.plan = plan_frames(camera, log, settings, resolved.steering ? &*resolved.steering : nullptr);
  resolved.plan_settings = std::move(settings);
  if (job.accumulate.mode == AccumulateMode::two_sided && job.accumulate.window > 0) {
    add_frames_around(job, camera, resolved);
  }
  if (resolved.plan.ages && !job.gaze_at) {
    resolved.decisions.emplace_back("effective gaze age", gaze_ages_text(*resolved.plan.ages));
  }
}

// Takes the frames of the job's chunk out of those of the whole sequence.
void keep_to_chunk(const JobSettings& job, const CameraPath& camera, std::int64_t taken_off_ns, ResolvedJob& resolved) {
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  Decisions unused;
  const FramePlan whole =
      plan_frames(camera, log, plan_settings(job, resolved.frames, log, taken_off_ns, unused), nullptr);
  ChosenChunk chosen = choose_chunk(job, whole);
  resolved.frames = std::move(chosen.frames);
  resolved.chunk_borders = std::move(chosen.borders);
  resolved.decisions.emplace_back("chunk", chosen.decision);
}

void warn_of_filter(const JobSettings& job, Warnings& warnings) {
  if (job.trace.filter != PixelFilter::box && Reconstruction({job.filter, {}}).needs().guides) {
    warnings.push_back(
        fmt::format("`filter` {} takes edges, texture and what shines from a box of one pixel: `pixel-filter` "
                    "blackman-harris is missing there, `filter` linear or tent keep it",
                    job.filter));
  }
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

// Sums, picture and map of a frame take at least so much. More than the machine has is found out before a scene is
// loaded, and not by what the system then does.
void check_frame_memory(const JobSettings& job) {
  constexpr double kLeastBytesOfAPixel = 40;
  const double bytes = kLeastBytesOfAPixel * job.size.width * job.size.height;
  if (const auto most = static_cast<double>(most_memory_bytes()); bytes > most) {
    throw Error(ErrorKind::usage, "`size`",
                fmt::format("a frame of {}x{} pixels takes more than {:.0f} GiB of memory, and there are {:.1f}",
                            job.size.width, job.size.height, bytes / 1073741824.0, most / 1073741824.0),
                "give a smaller one");
  }
}

void check_frame_size(const JobSettings& job) {
  if (job.only_pixel && (job.only_pixel->x >= job.size.width || job.only_pixel->y >= job.size.height)) {
    throw Error(
        ErrorKind::usage, "`only-pixel`",
        fmt::format("{},{} lies outside {}x{}", job.only_pixel->x, job.only_pixel->y, job.size.width, job.size.height),
        "pixels count from 0 at the top left");
  }
  check_display_image_size(output_settings(job).display, job.size.width, job.size.height);
}

// A single picture is the same for every frame.
void check_density_maps(const FoveationSettings& foveation, const FramePlan& plan) {
  for (const std::vector<FrameRequest>* frames : {&plan.frames, &plan.around}) {
    for (const FrameRequest& request : *frames) {
      read_density_map(foveation, request.frame);
      if (!has_frame_number(foveation.density_map)) {
        return;
      }
    }
  }
}

// A frame of which nobody said the size has the shape of the screen that it fills.
void follow_screen_shape(const GazeLog* log, std::int64_t taken_off_ns, ResolvedJob& resolved) {
  JobSettings& job = resolved.job.settings;
  const SizePx usual = JobSettings{}.size;
  const bool is_usual = job.size.width == usual.width && job.size.height == usual.height;
  if (resolved.job.sources.contains("size") || !is_usual || job.frame_rect) {
    return;
  }
  Decisions unused;
  const std::optional<DisplayGeometry> screen = plan_settings(job, {1}, log, taken_off_ns, unused).display;
  if (!screen || screen->width_px < 1 || screen->height_px < 1) {
    return;
  }
  const double height = std::round(static_cast<double>(usual.width) * screen->height_px / screen->width_px);
  if (height >= 1 && height != usual.height) {
    job.size.height = static_cast<int>(height);
    resolved.decisions.emplace_back(
        "size", fmt::format("{}x{}, which has the shape of the screen (`size` chooses another)", job.size.width,
                            job.size.height));
  }
}

// Inputs that are quick to read come first, so that a wrong name is found before a scene is loaded.
void load_and_plan(const ResolveOptions& options, ResolvedJob& resolved) {
  const JobSettings& job = resolved.job.settings;
  std::int64_t taken_off_ns = 0;
  resolved.gaze = gaze_of_job(job, taken_off_ns);
  const GazeLog* log = resolved.gaze ? &*resolved.gaze : nullptr;
  follow_screen_shape(log, taken_off_ns, resolved);
  check_frame_size(job);
  if (options.scope == ResolveScope::render) {
    check_frame_memory(job);
  }
  {
    Decisions unused;
    check_screen(plan_settings(job, {1}, log, taken_off_ns, unused), log);
  }
  if (options.scope == ResolveScope::render) {
    check_environment_file(job);
  }
  CameraPath camera;
  std::string decision;
  const bool needs_scene = camera_needs_scene(job);
  bool length_needs_scene = false;
  if (!needs_scene) {
    camera = choose_camera(job, nullptr, log, taken_off_ns, decision);
    length_needs_scene = may_follow_scene(job, camera, log);
    if (job.foveation.target.jod || job.foveation.target.flip) {
      // The whole sequence is judged, whichever of its frames are wanted.
      JobSettings whole = job;
      whole.frames.reset();
      length_needs_scene = length_needs_scene || may_follow_scene(whole, camera, log);
    }
  }
  const bool asks_scene = (needs_scene || length_needs_scene) && !job.scene.empty();
  if (options.loaded == nullptr && (options.scope == ResolveScope::render || asks_scene)) {
    load_scene_of(job, options, resolved);
  }
  const Scene* scene = options.loaded != nullptr ? options.loaded : resolved.scene.get();
  if (needs_scene) {
    camera = choose_camera(job, scene, log, taken_off_ns, decision);
  }
  resolved.decisions.emplace_back("camera", decision);
  resolved.frames = choose_frames(job, camera, log, taken_off_ns, scene, decision);
  resolved.decisions.emplace_back("frames", decision);
  if (log == nullptr && !follows_picture(job.foveation)) {
    resolved.decisions.emplace_back("sampling", sampling_without_gaze(job.foveation));
  }
  if (job.chunk) {
    keep_to_chunk(job, camera, taken_off_ns, resolved);
  }
  make_plan(job, camera, taken_off_ns, resolved);
  if (job.foveation.target.jod || job.foveation.target.flip) {
    const ProcessedGaze* steering = resolved.steering ? &*resolved.steering : nullptr;
    resolved.plan.judged = plan_judged_frames(job, {camera, log, taken_off_ns, scene, steering}, resolved.plan_settings,
                                              resolved.decisions);
  }
  const auto& aovs = job.exr.aovs;
  if (log == nullptr && std::find(aovs.begin(), aovs.end(), "eccentricity") != aovs.end()) {
    throw Error(ErrorKind::usage, "`aov`", "there is no eccentricity without gaze", "give `gaze` or `gaze-at`");
  }
  if (job.foveation.falloff == "map" && options.scope == ResolveScope::render) {
    check_density_maps(job.foveation, resolved.plan);
  }
  append(resolved.warnings, camera.warnings);
  warn_of_filter(job, resolved.warnings);
  if (log != nullptr) {
    append(resolved.warnings, log->warnings);
  }
  append(resolved.warnings, resolved.plan.warnings);
  if (options.scope != ResolveScope::digests) {
    append(resolved.warnings, saving_warnings(job, resolved.plan));
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
  resolved.job = with_quality_defaults(job, &resolved.decisions);
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
  const JobSettings& settings = resolved.job.settings;
  if (settings.foveation.target.time_s) {
    resolved.warnings.emplace_back(
        "`time-budget`: how many samples frames have depends on the machine and on what else it does; another run "
        "makes "
        "other pictures");
  }
  resolved.pipeline = pipeline_settings(settings);
  if (resolved.pipeline.foveation.max_block_px != settings.foveation.max_block_px) {
    resolved.decisions.emplace_back("max-block", "1, so that the samples of frames at rest can be added up");
  }
  if (options.scope == ResolveScope::render) {
    check_output_settings(resolved.pipeline.output, resolved.frames.size() > 1);
  }
  resolved.pipeline.preroll = static_cast<std::int32_t>(resolved.plan.frames.size() - resolved.frames.size());
  if (options.scope != ResolveScope::plan) {
    resolved.input_digests = digest_job_files(settings);
    resolved.pipeline.settings_digest = digest_job(settings, resolved.input_digests);
    // The same options choose other rates where a view at rest is judged as a still, and not as a clip.
    if (const JudgedFrames& judged = resolved.plan.judged; !judged.runs.empty()) {
      resolved.pipeline.settings_digest =
          digest_settings({{"settings", resolved.pipeline.settings_digest},
                           {"frames of what is judged", fmt::format("{}", judged.sequence_frames)}});
    }
  }
  if (options.scope == ResolveScope::render) {
    resolved.history = starting_history(resolved.plan, resolved.pipeline, resolved.warnings);
    if (resolved.gaze && !resolved.history.passed.empty()) {
      join_plan(resolved.plan, resolved.history.passed.back(), *resolved.gaze, resolved.plan_settings);
    }
  }
  return resolved;
}

TracerOptions tracer_options(const JobSettings& job) {
  TracerOptions options;
  options.threads = job.threads;
  options.bvh_quality = job.bvh;
  return options;
}

}  // namespace gazetrace
