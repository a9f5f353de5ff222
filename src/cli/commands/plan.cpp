// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/job_help.hpp"
#include "cli/json_output.hpp"
#include "cli/model_gain_text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct PlanArguments {
  Job job;
  std::string save_camera;
  std::string sample_maps;
  std::uint32_t chunks = 0;
  std::string rate_from;
  bool counts = false;
  bool model_gain = false;
  JsonOutput json;
};

struct FrameCounts {
  std::int32_t frame = 0;
  std::vector<MapRegion> regions;
  double uniform_spp = 0;  // the rate where the eye looks
  double uniform_samples = 0, nominal_samples = 0;
  std::uint64_t traced_samples = 0;

  [[nodiscard]] double nominal_ratio() const { return nominal_samples > 0 ? uniform_samples / nominal_samples : 0; }
  [[nodiscard]] double traced_ratio() const {
    return traced_samples > 0 ? uniform_samples / static_cast<double>(traced_samples) : 0;
  }
};

FrameCounts count_samples(const FrameRequest& request, const JobSettings& job) {
  const FoveationSettings& settings = job.foveation;
  const SamplingMap map = planned_sampling_map(settings, request, job.trace.seed, job.threads);
  FrameCounts counts;
  counts.frame = request.frame;
  counts.regions = map.regions;
  counts.traced_samples = map.samples();
  counts.uniform_spp = planned_rates(settings, request, job.trace.seed, job.threads).most_spp;
  for (const MapRegion& region : map.regions) {
    counts.uniform_samples += static_cast<double>(region.pixels) * counts.uniform_spp;
    counts.nominal_samples += region.nominal_samples;
  }
  return counts;
}

std::string counts_as_table(const std::vector<FrameCounts>& frames) {
  std::string text;
  for (const FrameCounts& counts : frames) {
    text += fmt::format("frame {}\n  {:<14}{:>12}{:>12}{:>16}{:>14}\n", counts.frame, "region", "pixels", "sites",
                        "nominal", "traced");
    for (const MapRegion& region : counts.regions) {
      text += fmt::format("  {:<14}{:>12}{:>12}{:>16.2f}{:>14}\n", region.name, region.pixels, region.sites,
                          region.nominal_samples, region.samples);
    }
    text += fmt::format("  {:<14}{:>12}{:>12}{:>16.2f}{:>14}\n", "all", "", "", counts.nominal_samples,
                        counts.traced_samples);
    text += fmt::format("  {:<38}{:>16.2f}{:>14.2f}\n", fmt::format("ratio to uniform {:.4g} spp", counts.uniform_spp),
                        counts.nominal_ratio(), counts.traced_ratio());
  }
  return text +
         "nominal: samples of a block divided by its size, for every pixel of the region; traced: samples that the "
         "blocks really get,\nwith those that straddle a border or an edge having one site for each region in "
         "them\n";
}

std::string counts_as_json(const std::vector<FrameCounts>& frames) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const FrameCounts& counts : frames) {
    nlohmann::ordered_json regions = nlohmann::ordered_json::array();
    for (const MapRegion& region : counts.regions) {
      regions.push_back({{"name", region.name},
                         {"block_px", region.block_px},
                         {"pixels", region.pixels},
                         {"sites", region.sites},
                         {"nominal_samples", region.nominal_samples},
                         {"traced_samples", region.samples}});
    }
    json.push_back({{"frame", counts.frame},
                    {"uniform_spp", counts.uniform_spp},
                    {"uniform_samples", counts.uniform_samples},
                    {"nominal_samples", counts.nominal_samples},
                    {"traced_samples", counts.traced_samples},
                    {"nominal_ratio", counts.nominal_ratio()},
                    {"traced_ratio", counts.traced_ratio()},
                    {"regions", regions}});
  }
  return json.dump(2) + "\n";
}

// Minutes at the rate of an earlier run of the job, by its timing.csv: of its rows whose times are known.
std::optional<double> minutes_a_sample(const std::string& timing_path) {
  double ms = 0;
  double samples = 0;
  for (const TimingRow& row : read_timing_csv(timing_path)) {
    if (std::isfinite(row.total_ms) && row.samples > 0) {
      ms += row.total_ms;
      samples += static_cast<double>(row.samples);
    }
  }
  return samples > 0 ? std::optional(ms / 60000.0 / samples) : std::nullopt;
}

void print_chunks(const std::vector<FrameChunk>& chunks, const std::optional<double>& minutes,
                  const JsonOutput& output) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text = fmt::format("{:>6}{:>8}{:>16}{:>10}  {}\n", "chunk", "frames", "samples", "minutes", "which");
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const FrameChunk& chunk = chunks[i];
    const std::string list = chunk.frames.empty() ? "none" : format_frame_list(chunk.frames);
    const bool known = minutes && chunk.samples > 0;
    text += fmt::format("{:>6}{:>8}{:>16}{:>10}  {}\n", i + 1, chunk.frames.size(),
                        chunk.samples > 0 ? fmt::format("{:.0f}", chunk.samples) : "not known",
                        known ? fmt::format("{:.2f}", chunk.samples * *minutes) : "-", list);
    json.push_back({{"chunk", i + 1}, {"frames", list}, {"count", chunk.frames.size()}});
    if (chunk.samples > 0) {
      json.back()["samples"] = chunk.samples;
    }
    if (known) {
      json.back()["minutes"] = chunk.samples * *minutes;
    }
  }
  output.print(text, [&] { return json.dump(2) + "\n"; });
}

/// Before anything is loaded or warned of, so that a refusal is the only line.
void check_counts_are_known(const FoveationSettings& foveation, const char* option) {
  if (looks_first(foveation.sampling)) {
    throw Error(ErrorKind::usage, "`sampling`", "counts that a pilot decides are known once it is rendered",
                "give another one, or render and read timing.csv");
  }
  if (foveation.target.is_given()) {
    throw Error(ErrorKind::usage, fmt::format("`{}`", option),
                "counts that follow from a target are known once it is rendered",
                "give `spp`, or render and read timing.csv");
  }
}

std::vector<std::string> sample_map_files(const std::string& pattern, const FramePlan& plan) {
  std::vector<std::string> files;
  for (const FrameRequest& request : pattern.empty() ? std::vector<FrameRequest>() : plan.frames) {
    files.push_back(frame_file_name(pattern, request.frame, plan.frames.size() > 1));
  }
  return files;
}

int run_plan(const PlanArguments& arguments) {
  const JobSettings& asked = arguments.job.settings;
  check_job(arguments.job);
  if (asked.scene.empty() && asked.camera_path.empty() && !asked.camera_from_gaze && !asked.eye && !arguments.counts &&
      !arguments.model_gain && arguments.chunks == 0 && arguments.sample_maps.empty()) {
    throw Error(ErrorKind::usage, "", "no scene and no camera were given",
                "name a scene, or give --camera-path or --eye and --target");
  }
  if (arguments.counts && arguments.chunks == 0) {
    check_counts_are_known(asked.foveation, "counts");
  }
  if (!arguments.sample_maps.empty()) {
    check_counts_are_known(asked.foveation, "write-sample-maps");
    if (!arguments.sample_maps.ends_with(".exr")) {
      throw Error(ErrorKind::usage, "`write-sample-maps`", "'" + arguments.sample_maps + "' is no name of an EXR",
                  "give one that ends with .exr");
    }
  }
  ResolveOptions resolving;
  resolving.scope = ResolveScope::plan;
  const ResolvedJob resolved = resolve(arguments.job, resolving);
  const JobSettings& job = resolved.job.settings;
  const std::vector<std::string> sample_maps = sample_map_files(arguments.sample_maps, resolved.plan);
  std::vector<std::string> outputs = sample_maps;
  outputs.push_back(arguments.save_camera);
  if (has_frame_number(arguments.sample_maps)) {
    outputs.push_back(arguments.sample_maps);  // by the name that asks for it, so that it is not taken for an input
  }
  arguments.json.check(outputs, job_files(job));
  if (!arguments.save_camera.empty()) {
    std::vector<FramePose> frames;
    for (const FrameRequest& request : resolved.plan.frames) {
      frames.push_back({request.frame, request.t_video_ns, request.camera});
    }
    write_camera_path(frames, job.camera_read.rotation_order, arguments.save_camera);
  }
  for (std::size_t i = 0; i < sample_maps.size(); ++i) {
    const FrameRequest& request = resolved.plan.frames[i];
    write_density_exr(sample_maps[i], planned_density(job.foveation, request, job.trace.seed, job.threads),
                      request.frame, request.window);
  }
  print_warnings(resolved.warnings);
  const bool are_of_fixations = job.frames && job.frames->frames.empty();
  for (const auto& [name, text] : resolved.decisions) {
    if (name.starts_with("replaced ") || name == "accumulate" || (name == "sampling" && resolved.gaze) ||
        (name == "frames" && are_of_fixations)) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), with_flags(text).c_str());
    }
  }
  if (!sample_maps.empty() && !arguments.counts && !arguments.model_gain && arguments.chunks == 0) {
    const std::string last = sample_maps.size() > 1 ? " to " + sample_maps.back() : "";
    arguments.json.print(fmt::format("{}{}: {} sample map{}\n", sample_maps.front(), last, sample_maps.size(),
                                     sample_maps.size() == 1 ? "" : "s"),
                         [&] {
                           return nlohmann::ordered_json{{"sample_maps", sample_maps}}.dump(2) + "\n";
                         });
    return exit_done;
  }
  if (arguments.model_gain) {
    const double fps = static_cast<double>(job.fps.numerator) / static_cast<double>(job.fps.denominator);
    const GainOfPlan gain = gain_of_plan(resolved.plan, fps, job.threads);
    arguments.json.print(gain_as_text(gain), [&] { return gain_as_json(gain); });
    return exit_done;
  }
  if (arguments.chunks > 0) {
    const std::vector<FrameChunk> chunks = balanced_chunks(job, resolved.plan, arguments.chunks);
    const std::optional<double> minutes =
        arguments.rate_from.empty() ? std::nullopt : minutes_a_sample(arguments.rate_from);
    print_chunks(chunks, minutes, arguments.json);
    return exit_done;
  }
  if (!arguments.counts && arguments.json.on_stdout()) {
    write_plan_json(resolved.plan, [](const std::string& text) { print_result(with_flags(text)); });
    return exit_done;
  }
  if (!arguments.counts) {
    arguments.json.print(with_flags(plan_as_table(resolved.plan)),
                         [&] { return with_flags(plan_as_json(resolved.plan)); });
    return exit_done;
  }
  std::vector<FrameCounts> counts;
  for (const FrameRequest& request : resolved.plan.frames) {
    counts.push_back(count_samples(request, job));
  }
  arguments.json.print(counts_as_table(counts), [&] { return counts_as_json(counts); });
  return exit_done;
}

}  // namespace

Command add_plan_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<PlanArguments>();
  bind_job_options(app, arguments->job);
  use_job_help(app, "gazetrace plan --counts --gaze-at 0.4,0.5 --screen paper --size 480x270");
  app.footer(std::string(kConfigHelp) + kExitCodesHelp);
  app.add_flag("--counts", arguments->counts,
               "Samples per region, nominal and traced, and their ratio to uniform frames of the rate where the eye "
               "looks; needs no scene");
  app.add_flag("--model-gain", arguments->model_gain,
               "The saving of eccentricity alone on this screen with this gaze, in samples at equal visible error, by "
               "FovVideoVDP's model; content and masking are left out; needs no scene")
      ->excludes("--counts");
  app.add_option("--chunks", arguments->chunks,
                 "How --chunk K/N divides the frames into N chunks: frames and samples of each; needs no scene")
      ->check(CLI::Range(1U, 1000000U).description(""))
      ->type_name("N");
  app.add_option("--rate-from", arguments->rate_from,
                 "A timing.csv of the same job on the same machine, for the minutes of --chunks")
      ->type_name("FILE");
  app.add_option(
         "--save-camera", arguments->save_camera,
         "Writes the camera of every frame: .chan for Nuke (--camera-rotation-order), .tum or .txt for TUM, whose "
         "stamps are the video times of the frames' middles: read it again with --camera-keep-time; replaces a file "
         "with --overwrite only")
      ->type_name("FILE");
  app.add_option(
         "--write-sample-maps", arguments->sample_maps,
         "Writes where the samples of every frame go, for other renderers: an EXR with one channel, 1 where the "
         "eye looks, named as -o names pictures; needs no scene; replaces files with --overwrite only")
      ->type_name("PATTERN");
  add_json_option(app, arguments->json, arguments->job.settings.overwrite);
  return {[arguments] { return run_plan(*arguments); },
          [arguments](const std::string& path) { read_job_config(arguments->job, "plan", path); }};
}

}  // namespace gazetrace
