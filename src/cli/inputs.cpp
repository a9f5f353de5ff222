// SPDX-License-Identifier: Apache-2.0
#include "cli/inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_inspect.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void usage(const std::string& place, const std::string& problem, const std::string& remedy = {}) {
  throw Error(ErrorKind::usage, place, problem, remedy);
}

void append(Warnings& to, const Warnings& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// A gaze that never moves is a log of one sample that never grows old.
GazeLog fixed_gaze(const Vec2d& at) {
  GazeLog log;
  log.source = "--gaze-at";
  log.format = "fixed";
  GazeSample sample;
  sample.u = at.x;
  sample.v = at.y;
  log.samples.push_back(sample);
  return log;
}

// More than four days at 24 a second: a wrong unit, not a wish.
constexpr double kMostFrames = 1e7;

std::int64_t frames_until(double end_ns, const JobSettings& job) {
  // The last frame whose middle, start + (n - 1/2) / fps, is not after the end.
  const double span_s = (end_ns - static_cast<double>(job.start.ns)) * 1e-9;
  const double frames = span_s * static_cast<double>(job.fps.numerator) / static_cast<double>(job.fps.denominator);
  if (!(frames < kMostFrames)) {
    usage("--frames", fmt::format("camera path or gaze log stand for {:.3g} frames", frames),
          "name the frames to render, or check --gaze-scale, --gaze-offset and --fps");
  }
  return static_cast<std::int64_t>(std::max(std::floor(frames + 0.5), 1.0));
}

std::int64_t last_motion_ns(const Scene* scene) {
  std::int64_t last = 0;
  if (scene != nullptr) {
    for (const Motion& motion : scene->motions) {
      last = std::max(last, motion.end_ns);
    }
    for (const Deformation& deformation : scene->deformations) {
      last = std::max(last, deformation.end_ns);
    }
  }
  return last;
}

// As long as the camera's path; without one, the gaze log; without one, the scene's bodies.
std::vector<std::int32_t> choose_frames(const JobSettings& job, const CameraPath& camera, const GazeLog* log,
                                        const Scene* scene, std::string& decision) {
  if (job.frames) {
    decision = format_frame_list(job.frames->frames);
    return job.frames->frames;
  }
  std::int64_t count = 1;
  std::string reason = "nothing moves";
  if (!camera.is_static) {
    count = frames_until(static_cast<double>(camera.end_ns), job);
    reason = "as long as the camera's path";
  } else if (log != nullptr && log->samples.size() > 1) {
    const GazeMapping mapping = gaze_mapping(job, log);
    const std::int64_t begin_ns = mapping.event_ns.value_or(log->samples.front().t_ns);
    const double span_ns = static_cast<double>(log->samples.back().t_ns) - static_cast<double>(begin_ns);
    count = frames_until(span_ns * mapping.scale + static_cast<double>(mapping.offset_ns), job);
    reason = "as long as the gaze log";
  } else if (const std::int64_t end_ns = last_motion_ns(scene); end_ns > 0) {
    count = frames_until(static_cast<double>(end_ns), job);
    reason = "as long as the scene's animation";
  }
  std::vector<std::int32_t> frames(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = static_cast<std::int32_t>(i) + 1;
  }
  decision = fmt::format("{} ({}; --frames changes it)", format_frame_list(frames), reason);
  return frames;
}

// Up to `count` frames before the first, as far apart as the first two; none before frame 1.
std::vector<std::int32_t> frames_before(const std::vector<std::int32_t>& frames, std::int32_t count) {
  const std::int64_t step = frames.size() > 1 ? std::int64_t{frames[1]} - frames[0] : 1;
  std::vector<std::int32_t> before;
  for (std::int64_t k = count; k > 0; --k) {
    const std::int64_t frame = frames.front() - k * step;
    if (frame >= 1) {
      before.push_back(static_cast<std::int32_t>(frame));
    }
  }
  return before;
}

// With the size that the log's pixels per degree mean where it does not state one: only its ratio to the distance
// matters.
DisplayGeometry recording_display(const GazeLog& log, std::vector<std::pair<std::string, std::string>>& decisions) {
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
                           std::vector<std::pair<std::string, std::string>>& decisions) {
  PlanSettings settings;
  settings.frames = frames;
  settings.fps = job.fps;
  settings.start_ns = job.start.ns;
  settings.shutter = job.shutter;
  settings.camera_extrapolation = job.camera_extrapolation;
  std::string clock;
  settings.gaze = gaze_mapping(job, log, &clock);
  if (!clock.empty()) {
    decisions.emplace_back("gaze clock", clock);
  }
  settings.gaze_latency_ns = job.gaze_at ? 0 : job.gaze_latency.ns;
  settings.width_px = job.size.width;
  settings.height_px = job.size.height;
  settings.display = screen_geometry(job.screen);
  if (settings.display && (log == nullptr || log->kind == GazeKind::direction)) {
    check_display(*settings.display);
  }
  if (settings.display) {
    decisions.emplace_back("screen", job.screen.name.empty() ? "as given" : job.screen.name);
  } else if (log != nullptr && log->recording_geometry && log->kind == GazeKind::screen) {
    settings.display = recording_display(*log, decisions);
  }
  settings.transfer = job.gaze_transfer;
  if (job.frame_rect) {
    settings.frame_rect = *job.frame_rect;
  }
  if (log != nullptr && log->kind == GazeKind::screen) {
    if (!settings.display) {
      throw Error(ErrorKind::input, log->source, "gaze on a screen needs the screen's size and distance",
                  "give --screen NAME, or --screen-px, --screen-cm and --screen-distance-cm");
    }
    check_display(*settings.display);
  }
  return settings;
}

// Gaze is biometric, and a time of day tells whose it is: nothing that is written shall carry it.
void hide_times_of_day(GazeLog& log, JobSettings& job) {
  for (std::string& warning : log.warnings) {
    warning = without_dates(warning);
  }
  if (is_wall_clock(log)) {
    const std::int64_t taken_off_ns = count_from_first_sample(log);
    job.gaze_taken_off_ns = taken_off_ns;
    if (job.gaze_start) {
      if (__builtin_sub_overflow(job.gaze_start->ns, taken_off_ns, &job.gaze_start->ns)) {
        usage("--gaze-start", "lies ages away from the log");
      }
    }
  }
}

// Of first hits, which filters with guides see through a pinhole in the middle of the frame's time.
std::string blur_lost_by_filter(const JobSettings& job, const CameraPath& camera, const Scene* scene) {
  if (!needs_of_filter(job).guides) {
    return {};
  }
  const bool moves =
      !camera.is_static || (scene != nullptr && !(scene->motions.empty() && scene->deformations.empty()));
  const bool motion = job.shutter.blurs() && moves;
  if (camera.lens.radius_m > 0) {
    return motion ? "blur of lens and shutter" : "blur of the lens";
  }
  return motion ? "blur of the shutter" : "";
}

}  // namespace

bool camera_needs_scene(const JobSettings& job) {
  return job.camera_path.empty() && !job.camera_from_gaze && !job.eye;
}

namespace {

DisplayGeometry known_screen(const std::string& name, const std::string& option) {
  if (name.ends_with(".json")) {
    return load_display(name);
  }
  std::vector<std::string> known;
  for (const NamedDisplay& display : named_displays()) {
    known.push_back(display.name);
  }
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    usage(option, unknown_name_message("screen", name, known));
  }
  return display_by_name(name);
}

void set_pixels_per_degree(const ScreenSettings& screen, DisplayGeometry& geometry) {
  const double ppd = *screen.pixels_per_degree;
  if (!(ppd > 0) || !std::isfinite(ppd)) {
    usage("--screen-ppd", fmt::format("{} pixels a degree are not a positive number", ppd));
  }
  if (screen.size_cm || screen.distance_cm) {
    usage("--screen-ppd", "it stands for the screen's size and distance",
          "leave out --screen-cm and --screen-distance-cm");
  }
  if (geometry.width_px <= 0 || geometry.height_px <= 0) {
    usage("--screen-ppd", "the screen's pixels are not known", "give --screen-px as well");
  }
  geometry = display_of_pixels_per_degree(geometry.width_px, geometry.height_px, {ppd, ppd});
}

}  // namespace

std::optional<DisplayGeometry> screen_geometry(const ScreenSettings& screen) {
  const bool any = screen.size_px || screen.size_cm || screen.distance_cm || screen.eye_cm || screen.pixels_per_degree;
  if (screen.name.empty() && !any) {
    return std::nullopt;
  }
  DisplayGeometry geometry;
  if (!screen.name.empty()) {
    geometry = known_screen(screen.name, "--screen");
  }
  if (screen.size_px) {
    const Vec2d& px = *screen.size_px;
    if (px.x != std::floor(px.x) || px.y != std::floor(px.y) || std::abs(px.x) > 1e6 || std::abs(px.y) > 1e6) {
      usage("--screen-px", "a resolution is two whole numbers, such as 3840,2160");
    }
    geometry.width_px = static_cast<int>(px.x);
    geometry.height_px = static_cast<int>(px.y);
  }
  if (screen.size_cm) {
    geometry.width_cm = screen.size_cm->x;
    geometry.height_cm = screen.size_cm->y;
  }
  geometry.distance_cm = screen.distance_cm.value_or(geometry.distance_cm);
  if (screen.pixels_per_degree) {
    set_pixels_per_degree(screen, geometry);
  }
  if (screen.eye_cm) {
    geometry.eye_x_cm = screen.eye_cm->x;
    geometry.eye_y_cm = screen.eye_cm->y;
  }
  const auto negative = [](double value) { return !(value >= 0) || !std::isfinite(value); };
  if (geometry.width_px < 0 || geometry.height_px < 0 || negative(geometry.width_cm) || negative(geometry.height_cm) ||
      negative(geometry.distance_cm)) {
    check_display(geometry);  // says which
  }
  return geometry;
}

GazeColumns merged_columns(const GazeFileSettings& gaze) {
  return gaze.columns_file.empty() ? gaze.read.columns
                                   : merge_gaze_columns(load_gaze_columns(gaze.columns_file), gaze.read.columns);
}

GazeReadOptions read_options(const GazeFileSettings& gaze, const ScreenSettings& screen) {
  GazeReadOptions options = gaze.read;
  options.columns = merged_columns(gaze);
  options.min_confidence = gaze.min_confidence.value_or(options.min_confidence);
  options.display = screen_geometry(screen);
  options.eye_cm = screen.eye_cm;
  options.unordered = gaze.sort ? UnorderedPolicy::sort : UnorderedPolicy::error;
  return options;
}

GazeLog read_gaze_file(const GazeFileSettings& gaze, const ScreenSettings& screen) {
  return load_gaze_log(gaze.path, read_options(gaze, screen));
}

namespace {

// --screen is where the pictures are watched; of the recording it says only what nobody else does.
GazeLog read_job_gaze(const JobSettings& job) {
  GazeReadOptions options = read_options(job.gaze, {});
  options.fallback_display = screen_geometry(job.screen);
  if (!job.recording_screen.empty()) {
    options.display = known_screen(job.recording_screen, "--recording-screen");
  }
  return load_gaze_log(job.gaze.path, options);
}

}  // namespace

Inputs load_inputs(const JobSettings& given, InputScope scope,
                   const std::function<void(std::size_t, std::size_t)>& progress, const Scene* loaded) {
  Inputs inputs;
  JobSettings job = given;
  std::string decision;
  // What is quick to read first: a wrong name must not cost the loading of a scene.
  if (job.gaze_at) {
    if (!job.gaze.path.empty()) {
      usage("--gaze-at", "a fixed gaze and a gaze log exclude each other", "give one of --gaze and --gaze-at");
    }
    inputs.gaze = fixed_gaze(*job.gaze_at);
  } else if (!job.gaze.path.empty()) {
    inputs.gaze = read_job_gaze(job);
    if (!job.keep_ids) {
      hide_times_of_day(*inputs.gaze, job);
    }
    complete_recording_geometry(*inputs.gaze, job.screen);
  }
  const GazeLog* log = inputs.gaze ? &*inputs.gaze : nullptr;
  {
    std::vector<std::pair<std::string, std::string>> unused;
    plan_settings(job, {1}, log, unused);
  }
  CameraPath camera;
  if (!camera_needs_scene(job)) {
    camera = choose_camera(job, nullptr, log, decision);
  }
  if (loaded == nullptr && (scope == InputScope::render || (camera_needs_scene(job) && !job.scene.empty()))) {
    if (job.scene.empty()) {
      usage("", "no scene was given", "name a .gltf or .glb file");
    }
    const auto begin = std::chrono::steady_clock::now();
    SceneReadOptions options;
    options.animation = job.animation;
    options.threads = job.threads;
    options.progress = progress;
    inputs.scene = std::make_unique<Scene>(load_scene(job.scene, options));
    if (scope == InputScope::render) {
      inputs.decisions.emplace_back("environment", set_environment(job, *inputs.scene));
    }
    inputs.load_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    append(inputs.warnings, inputs.scene->warnings);
    append(inputs.warnings, inputs.scene->environment.warnings);
    if (job.accumulate.mode == AccumulateMode::running &&
        !(inputs.scene->motions.empty() && inputs.scene->deformations.empty())) {
      inputs.warnings.emplace_back(
          "--accumulate running looks at the camera alone: what moves in the scene is smeared");
    }
  }
  const Scene* scene = loaded != nullptr ? loaded : inputs.scene.get();
  if (camera_needs_scene(job)) {
    camera = choose_camera(job, scene, log, decision);
  }
  inputs.decisions.emplace_back("camera", decision);
  inputs.frames = choose_frames(job, camera, log, scene, decision);
  inputs.decisions.emplace_back("frames", decision);
  if (log == nullptr) {
    const FoveationSettings& fov = job.foveation;
    const std::string rate = fov.budget_spp       ? fmt::format("{} samples a pixel", *fov.budget_spp)
                             : fov.budget_samples ? fmt::format("{} samples in all", *fov.budget_samples)
                                                  : fmt::format("{} samples", fov.uniform_spp);
    inputs.decisions.emplace_back("sampling", rate + " everywhere: there is no gaze");
  }
  std::vector<std::int32_t> planned = frames_before(inputs.frames, job.preroll);
  planned.insert(planned.end(), inputs.frames.begin(), inputs.frames.end());
  PlanSettings settings = plan_settings(job, planned, log, inputs.decisions);
  if (log != nullptr) {
    settings.uncertainty = gaze_uncertainty(job, *log);
  }
  if (log != nullptr && !job.gaze_at) {
    settings.find_speed = job.foveation.retinal_velocity;
    if (!job.gaze_process.empty()) {
      inputs.steering = process_gaze(*log, gaze_steps_of(job.gaze_process));
      inputs.decisions.emplace_back("gaze processing", fmt::format("{}", fmt::join(inputs.steering->reports, "; ")));
    }
  }
  inputs.plan = plan_frames(camera, log, settings, inputs.steering ? &*inputs.steering : nullptr);
  inputs.plan_settings = std::move(settings);
  if (inputs.plan.ages && !job.gaze_at) {
    inputs.decisions.emplace_back("effective gaze age", gaze_ages_text(*inputs.plan.ages));
  }
  const auto& aovs = job.exr.aovs;
  if (log == nullptr && std::find(aovs.begin(), aovs.end(), "eccentricity") != aovs.end()) {
    usage("--aov", "there is no eccentricity without gaze", "give --gaze or --gaze-at");
  }

  append(inputs.warnings, camera.warnings);
  if (const std::string lost = blur_lost_by_filter(job, camera, scene); !lost.empty()) {
    inputs.warnings.push_back(fmt::format(
        "--filter {} takes edges, texture, what shines and the background from a pinhole at one instant: {} "
        "is missing there, --filter linear or tent keep it",
        job.filter, lost));
  }
  if (job.trace.filter != PixelFilter::box && needs_of_filter(job).guides) {
    inputs.warnings.push_back(
        fmt::format("--filter {} takes edges, texture and what shines from a box of one pixel: --pixel-filter "
                    "blackman-harris is missing there, --filter linear or tent keep it",
                    filter_of(job)));
  }
  if (log != nullptr) {
    append(inputs.warnings, log->warnings);
  }
  append(inputs.warnings, inputs.plan.warnings);
  return inputs;
}

}  // namespace gazetrace
