// SPDX-License-Identifier: Apache-2.0
// Output settings, folders, and the digest that says whether a finished frame is still the one that is wanted.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

#include "cli/inputs.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

template <class Infos>
void check_registry_name(const char* option, const char* what, const std::string& name, const Infos& infos) {
  std::vector<std::string> known;
  known.reserve(infos.size());
  for (const auto& info : infos) {
    known.push_back(info.name);
  }
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw Error(ErrorKind::usage, option, unknown_name_message(what, name, known));
  }
}

OutputSettings output_settings(const JobSettings& job) {
  OutputSettings output;
  output.exr = job.exr;
  output.display = job.picture;
  output.map_pattern = job.map_pattern;
  output.overwrite = job.overwrite;
  output.resume = job.resume;
  for (const std::string& pattern : job.outputs) {
    std::string& place = pattern.ends_with(".exr") ? output.exr.pattern : output.display.pattern;
    if (!place.empty()) {
      throw Error(ErrorKind::usage, "--output", fmt::format("'{}' and '{}' are of one kind", place, pattern),
                  "give one linear picture (.exr) and one display picture (.png .jpg .tif .dpx)");
    }
    place = pattern;
  }
  const std::string& first = !job.outputs.empty() ? job.outputs.front() : job.map_pattern;
  output.run_directory = first.empty() ? std::string() : fs::path(first).parent_path().string();
  if (!first.empty() && output.run_directory.empty()) {
    output.run_directory = ".";
  }
  return output;
}

// Stops at the first folder above that exists, so that a mistyped place is said before a scene is loaded.
void check_folder(const fs::path& folder) {
  fs::path existing = fs::absolute(folder).lexically_normal();
  std::error_code ignored;
  while (!fs::exists(existing, ignored) && existing.has_relative_path()) {
    existing = existing.parent_path();
  }
  if (!fs::is_directory(existing, ignored)) {
    throw Error(ErrorKind::input, folder.string(), fmt::format("'{}' is not a folder", existing.string()),
                "choose another output folder");
  }
  if (access(existing.c_str(), W_OK | X_OK) != 0) {
    throw Error(ErrorKind::input, folder.string(), fmt::format("'{}' is not writable", existing.string()),
                "choose another output folder");
  }
}

// Permissions lie on network and read-only file systems: only a file that was made proves anything.
void prove_writable(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code && !fs::is_directory(folder)) {
    throw Error(ErrorKind::input, folder.string(), "the folder cannot be made: " + code.message(),
                "choose another output folder");
  }
  std::string probe = (folder / ".gazetrace.XXXXXX").string();
  const int file = mkstemp(probe.data());
  if (file < 0) {
    throw Error(ErrorKind::input, folder.string(), std::string("no file can be made in it: ") + std::strerror(errno),
                "choose another output folder");
  }
  close(file);
  unlink(probe.c_str());
}

std::set<fs::path> output_folders(const OutputSettings& output, const std::string& checkpoint) {
  std::set<fs::path> folders;
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern, checkpoint}) {
    if (!pattern.empty()) {
      const fs::path parent = fs::path(pattern).parent_path();
      folders.insert(parent.empty() ? fs::path(".") : parent);
    }
  }
  return folders;
}

std::string ocio_file(const JobSettings& job) {
  if (!job.color.config.empty()) {
    return job.color.config;
  }
  const char* variable = std::getenv("OCIO");
  return variable == nullptr ? std::string() : variable;
}

std::vector<std::string> existing(const std::vector<std::string>& paths) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const std::string& path : paths) {
    if (!path.empty() && fs::is_regular_file(path, ignored)) {
      found.push_back(path);
    }
  }
  return found;
}

// Beyond this no picture has a meaning, and 2^stops times a bright light still fits a float.
constexpr double kMaxStops = 64;
constexpr int kMaxThreads = 1024;
// So many screens away the eye looks along the screen, and squares of pixels are still numbers.
constexpr double kMaxGazeScreens = 1000;

void check_stops(const char* option, double stops) {
  if (!(std::fabs(stops) <= kMaxStops)) {
    throw Error(ErrorKind::usage, option, fmt::format("{} stops are outside +-{}", stops, kMaxStops));
  }
}

void check_history_options(const JobSettings& job) {
  const AccumulateSettings& accumulate = job.accumulate;
  const auto within = [](const char* option, double value, double most) {
    if (!(value >= 0 && value <= most)) {
      throw Error(ErrorKind::usage, option, fmt::format("{} is outside 0..{}", value, most));
    }
  };
  within("--accumulate-frames", accumulate.frames, 1e9);
  within("--accumulate-blend", accumulate.blend, 1);
  if (accumulate.blend > 0 && accumulate.blend < kLeastBlend) {
    throw Error(ErrorKind::usage, "--accumulate-blend",
                fmt::format("a share of {} leaves nothing of the current frame", accumulate.blend),
                fmt::format("give {} or more, or 0 for weights by samples", kLeastBlend));
  }
  within("--accumulate-clip", accumulate.clip_sigmas, 1e6);
  within("--preroll", job.preroll, 1e6);
  within("--checkpoint-every", job.checkpoint_every, 1e9);
  PipelineSettings history;
  history.accumulate = accumulate;
  history.exposure = job.exposure;
  history.exposure.smoothing_s = static_cast<double>(job.exposure_smoothing.ns) * 1e-9;
  for (const auto& [option, given] :
       {std::pair("--checkpoint", !job.checkpoint.empty()), std::pair("--resume-from", !job.resume_from.empty()),
        std::pair("--preroll", job.preroll > 0)}) {
    if (given && !uses_history(history)) {
      throw Error(ErrorKind::usage, option, "frames do not depend on those before them",
                  "leave it out, or give --accumulate or --exposure-smoothing");
    }
  }
  if (accumulate.mode == AccumulateMode::reproject && accumulate.order == AccumulateOrder::before &&
      needs_of_filter(job).surfaces) {
    throw Error(ErrorKind::usage, "--accumulate-order",
                fmt::format("before the filter there are sites to accumulate, and '{}' works on surfaces", job.filter),
                "give after, or another --filter");
  }
  if (job.preroll > 0 && !job.resume_from.empty()) {
    throw Error(ErrorKind::usage, "--preroll", "the history comes from --resume-from", "give one of them");
  }
  if (job.checkpoint_every > 0 && job.checkpoint.empty()) {
    throw Error(ErrorKind::usage, "--checkpoint-every", "there is no file for it", "give --checkpoint");
  }
  std::error_code ignored;
  if (fs::is_directory(job.checkpoint, ignored)) {
    throw Error(ErrorKind::usage, "--checkpoint", fmt::format("'{}' is a folder", job.checkpoint), "name a file");
  }
}

void check_sample_range(const JobSettings& job) {
  if (!job.trace.samples) {
    return;
  }
  PipelineSettings settings;
  settings.foveation = job.foveation;
  settings.reconstruction.filter = filter_of(job);
  settings.accumulate = job.accumulate;
  settings.exposure = job.exposure;
  settings.exposure.smoothing_s = static_cast<double>(job.exposure_smoothing.ns) * 1e-9;
  settings.trace.only_pixel = job.only_pixel;
  if (const std::string reason = needs_all_samples(settings); !reason.empty()) {
    throw Error(ErrorKind::usage, "--sample-range", reason, "leave it out, or change that");
  }
  const FoveationSettings& foveation = job.foveation;
  if (foveation.falloff == "uniform" && !foveation.budget_spp && !foveation.budget_samples &&
      job.trace.samples->end > foveation.uniform_spp) {
    throw Error(
        ErrorKind::usage, "--sample-range",
        fmt::format("{} is beyond the {} samples of a pixel", format_value(*job.trace.samples), foveation.uniform_spp),
        "end it there, or raise --spp");
  }
}

}  // namespace

void check_settings(const JobSettings& job) {
  check_registry_name("--falloff", "falloff", job.foveation.falloff, falloffs());
  check_foveation(job.foveation);
  check_registry_name("--filter", "filter", filter_of(job), reconstruction_filters());
  if (!(job.enhance_contrast >= 0 && job.enhance_contrast <= 1)) {
    throw Error(ErrorKind::usage, "--enhance-contrast", fmt::format("{} is outside 0..1", job.enhance_contrast));
  }
  if (job.enhance_contrast > 0 && !Reconstruction({filter_of(job), {}}).filter().blurs_blocks) {
    throw Error(ErrorKind::usage, "--enhance-contrast",
                fmt::format("filter '{}' does not blur blocks, there is no contrast to bring back", job.filter),
                "give --filter linear, push-pull or tent");
  }
  if (job.trace.max_bounces < 0 || job.trace.max_bounces > 1000) {
    throw Error(ErrorKind::usage, "--bounces", fmt::format("{} is outside 0..1000", job.trace.max_bounces));
  }
  if (!(job.trace.clamp_indirect >= 0) || !std::isfinite(job.trace.clamp_indirect)) {
    throw Error(ErrorKind::usage, "--clamp-indirect", fmt::format("{} is no radiance", job.trace.clamp_indirect),
                "give a positive number, or 0 for none");
  }
  const auto check_cone = [](const char* option, double value) {
    if (!(value >= 0 && value <= 1000)) {
      throw Error(ErrorKind::usage, option, fmt::format("{} is outside 0..1000", value));
    }
  };
  check_cone("--pixel-cone", job.trace.pixel_cone);
  check_cone("--bounce-cone", job.trace.bounce_cone_rad);
  if (job.threads < 0 || job.threads > kMaxThreads) {
    throw Error(ErrorKind::usage, "--threads", fmt::format("{} is outside 0..{}", job.threads, kMaxThreads),
                "0 takes all");
  }
  check_history_options(job);
  check_sample_range(job);
  check_stops("--env-ev", job.environment_ev);
  check_stops("--exposure", job.exposure.ev);
  if (job.exr.zip_level < 1 || job.exr.zip_level > 9) {
    throw Error(ErrorKind::usage, "--exr-zip-level", fmt::format("{} is outside 1..9", job.exr.zip_level));
  }
  if (!(job.exposure.key > 0)) {
    throw Error(ErrorKind::usage, "--exposure-key", "the key must be positive");
  }
  if (job.exposure_smoothing.ns < 0) {
    throw Error(ErrorKind::usage, "--exposure-smoothing", "a time constant cannot be negative");
  }
  if (job.gaze_max_age.ns < 0 || job.gaze_max_gap.ns < 0) {
    throw Error(ErrorKind::usage, job.gaze_max_age.ns < 0 ? "--gaze-max-age" : "--gaze-max-gap",
                "an age cannot be negative");
  }
  if (job.gaze_at && !(std::max(std::fabs(job.gaze_at->x), std::fabs(job.gaze_at->y)) <= kMaxGazeScreens)) {
    throw Error(ErrorKind::usage, "--gaze-at",
                fmt::format("{},{} is more than {} screens away", job.gaze_at->x, job.gaze_at->y, kMaxGazeScreens),
                "give fractions of the screen, 0..1 on it");
  }
  gaze_steps_of(job.gaze_process);  // names and values of the steps
  if (!(job.gaze_scale > 0)) {
    throw Error(ErrorKind::usage, "--gaze-scale", "the scale must be positive");
  }
  if (job.only_pixel && (job.only_pixel->x >= job.size.width || job.only_pixel->y >= job.size.height)) {
    throw Error(
        ErrorKind::usage, "--only-pixel",
        fmt::format("{},{} lies outside {}x{}", job.only_pixel->x, job.only_pixel->y, job.size.width, job.size.height));
  }
  if (job.progress != "auto" && job.progress != "always" && job.progress != "never") {
    throw Error(ErrorKind::usage, "--progress",
                unknown_name_message("progress mode", job.progress, {"auto", "always", "never"}));
  }
  const OutputSettings output = output_settings(job);
  check_output_settings(output, job.frames && job.frames->frames.size() > 1);
  check_display_image_size(output.display, job.size.width, job.size.height);
  if (job.overwrite && job.resume) {
    throw Error(ErrorKind::usage, "--resume", "--overwrite starts over and --resume goes on", "give one of them");
  }
  for (const fs::path& folder : output_folders(output, job.checkpoint)) {
    check_folder(folder);
  }
}

std::string filter_of(const JobSettings& job) {
  if (job.filter != "auto") {
    return job.filter;
  }
  const bool has_gaze = !job.gaze.path.empty() || job.gaze_at;  // without any all frames are uniform
  const bool blurs = job.aperture.f_number > 0 || job.aperture.radius_m > 0 || job.shutter.blurs();
  const bool accumulates_sites =
      job.accumulate.mode == AccumulateMode::reproject && job.accumulate.order == AccumulateOrder::before;
  return choose_filter({.foveated = has_gaze && job.foveation.falloff != "uniform",
                        .blurs = blurs,
                        .accumulates_sites = accumulates_sites,
                        .enhances_contrast = job.enhance_contrast > 0,
                        .part_of_samples = job.trace.samples.has_value()})
      .name;
}

ReconstructionNeeds needs_of_filter(const JobSettings& job) {
  return Reconstruction({filter_of(job), {}}).needs();
}

PipelineSettings pipeline_settings(const JobSettings& job, const std::vector<std::int32_t>& frames) {
  PipelineSettings settings;
  settings.foveation = job.foveation;
  settings.trace = job.trace;
  settings.trace.only_pixel = job.only_pixel;
  settings.reconstruction = {filter_of(job), job.pass_through_samples};
  settings.enhance_contrast = job.enhance_contrast;
  settings.accumulate = job.accumulate;
  settings.checkpoint = job.checkpoint;
  settings.checkpoint_every = job.checkpoint_every;
  settings.resume_from = job.resume_from;
  settings.exposure = job.exposure;
  settings.exposure.smoothing_s = static_cast<double>(job.exposure_smoothing.ns) * 1e-9;
  settings.output = output_settings(job);
  settings.fps = job.fps;
  settings.threads = job.threads;
  settings.is_part = job.part;
  check_output_settings(settings.output, frames.size() > 1);
  return settings;
}

namespace {

// No output may take the place of another or of what is read.
void check_names_differ(const PipelineSettings& settings, std::vector<std::string> outputs,
                        std::map<std::string, std::string> inputs) {
  if (!settings.checkpoint.empty()) {
    outputs.push_back(settings.checkpoint);
    inputs.erase(settings.resume_from);  // one file may hand the history on from run to run
  }
  std::error_code ignored;
  for (const std::string& output : outputs) {
    if (!fs::exists(output, ignored)) {
      continue;
    }
    for (const auto& [input, digest] : inputs) {
      if (fs::equivalent(output, input, ignored)) {
        throw Error(ErrorKind::usage, output, "this output would replace an input", "give another name");
      }
    }
  }
  for (std::string& output : outputs) {
    output = fs::absolute(output).lexically_normal().string();
  }
  std::sort(outputs.begin(), outputs.end());
  if (const auto twice = std::adjacent_find(outputs.begin(), outputs.end()); twice != outputs.end()) {
    throw Error(ErrorKind::usage, *twice, "two outputs have this name", "give each its own");
  }
}

// What --resume will go on from, read before anything is rendered or written.
void check_earlier_run(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  const std::vector<std::string> files = output_files(settings, frames);
  if (files.size() < 2) {
    return;
  }
  const std::string& record_path = files[0];
  const std::string& timing_path = files[1];
  if (fs::exists(timing_path)) {
    read_timing_csv(timing_path);
  }
  if (!fs::exists(record_path)) {
    return;
  }
  const std::vector<std::int32_t> before = parse_frame_list(read_run_record(record_path).frames);
  for (const std::int32_t frame : before) {
    if (std::find(frames.begin(), frames.end(), frame) == frames.end()) {
      throw Error(ErrorKind::usage, "--resume",
                  fmt::format("{} is of a run over frames {}, and frame {} is not asked for now", record_path,
                              format_frame_list(before), frame),
                  "give frames that include those, --part, or another folder");
    }
  }
}

}  // namespace

void prepare_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames,
                     const std::map<std::string, std::string>& input_digests) {
  check_names_differ(settings, output_files(settings, frames), input_digests);
  if (settings.output.resume) {
    check_earlier_run(settings, frames);
  }
  if (!settings.output.overwrite && !settings.output.resume) {
    for (const std::string& path : output_files(settings, frames)) {
      if (fs::exists(path)) {
        const bool is_record = path.ends_with(".json") || path.ends_with(".csv");
        throw Error(ErrorKind::input, path, "this output exists already",
                    is_record && !settings.is_part && !settings.trace.samples
                        ? "give --overwrite, --resume, --part for one part of a sequence, or another folder"
                        : "give --overwrite, --resume or another name");
      }
    }
  }
  for (const fs::path& folder : output_folders(settings.output, settings.checkpoint)) {
    prove_writable(folder);
  }
}

std::map<std::string, std::string> digest_job_files(const JobSettings& job) {
  const fs::path camera_path(job.camera_path);
  // COLMAP's lenses stand beside its pictures.
  const fs::path lenses = camera_path.filename() == "images.txt" ? camera_path.parent_path() / "cameras.txt" : "";
  std::vector<std::string> files = existing({job.environment, job.camera_path, lenses.string(), job.gaze.path,
                                             job.gaze.columns_file, job.screen.name, job.recording_screen,
                                             ocio_file(job), job.foveation.parameters.table.path, job.resume_from});
  if (!job.scene.empty()) {
    const std::vector<std::string> scene = scene_files(job.scene);
    files.insert(files.end(), scene.begin(), scene.end());
  }
  return digest_files(files, job.threads);
}

void digest_job(const OptionTable& table, const JobSettings& job, const std::vector<std::int32_t>& frames,
                const std::map<std::string, std::string>& files, PipelineSettings& settings) {
  std::vector<std::pair<std::string, std::string>> parts{{"version", kVersion}};
  const auto digest_of = [&](const std::string& path) {
    const auto found = files.find(path);
    return found == files.end() ? std::string("missing") : found->second;
  };
  for (const OptionEntry& entry : table.entries()) {
    const std::vector<std::string> values = entry.values();
    const std::string text = values.empty() ? std::string() : fmt::format("{}", fmt::join(values, "\n"));
    if (entry.influence == Influence::file && files.contains(text)) {
      parts.emplace_back(entry.name, digest_of(text));
    } else if (entry.influence != Influence::none) {
      parts.emplace_back(entry.name, text);
    }
  }
  for (const std::string& path : job.scene.empty() ? std::vector<std::string>() : scene_files(job.scene)) {
    parts.emplace_back("scene file", digest_of(path));
  }
  parts.emplace_back("ocio file", existing({ocio_file(job)}).empty() ? ocio_file(job) : digest_of(ocio_file(job)));
  settings.history_digest = digest_settings(parts);
  settings.settings_digest = uses_history(settings)
                                 ? digest_of_sequence(settings.history_digest, format_frame_list(frames), job.preroll,
                                                      job.resume_from.empty() ? "" : digest_of(job.resume_from))
                                 : settings.history_digest;
}

}  // namespace gazetrace
