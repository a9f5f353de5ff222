// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/interruption.hpp"
#include "cli/job_help.hpp"
#include "cli/json_output.hpp"
#include "cli/keep_memory.hpp"
#include "cli/progress.hpp"
#include "cli/run_events.hpp"
#include "cli/summary.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/farm.hpp"
#include "gazetrace/run_job.hpp"

namespace gazetrace {
namespace {

struct RenderArguments {
  Job job;
  bool print_config = false;
  JsonOutput json;
};

void check_asked_for_something(const JobSettings& job) {
  if (job.scene.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "gazetrace render SCENE.gltf -o frame.####.exr");
  }
  if (job.outputs.empty() && job.map_pattern.empty() && !job.only_pixel) {
    throw Error(ErrorKind::usage, "", "no output was given", "add -o frame.####.exr and/or -o frame.####.png");
  }
}

// Where lines of JSON go to stderr, people's text does not stand between them.
bool is_quiet(const JobSettings& job, const RunEvents& events) {
  return job.quiet || events.on_stderr();
}

void tell_warnings(const Warnings& warnings, RunEvents& events) {
  if (!events.on_stderr()) {
    print_warnings(warnings);
  }
  events.warnings(warnings);
}

void say_decisions(const StartedRun& run) {
  const ResolvedJob& resolved = run.resolved;
  const auto say = [&](bool of_sampling) {
    for (const auto& [name, text] : resolved.decisions) {
      if ((name == "sampling") == of_sampling) {
        std::fprintf(stderr, "%s: %s\n", name.c_str(), with_flags(text).c_str());
      }
    }
  };
  say(true);  // first, where a gaze that somebody forgot is seen
  std::fprintf(stderr, "scene: %s, loaded in %.2f s\n", resolved.scene->source.c_str(), resolved.load_s);
  say(false);
  std::fprintf(stderr, "view: %s\n", run.color->description().c_str());
  std::fprintf(stderr, "rays: %s, tree of %.0f MiB built in %.2f s\n", run.tracer.ray_library().c_str(),
               static_cast<double>(run.tracer.memory().bvh_bytes) / 1048576.0, run.tracer.memory().build_s);
}

void tell_beginning(const StartedRun& run, RunEvents& events) {
  const ResolvedJob& resolved = run.resolved;
  const JobSettings& job = resolved.job.settings;
  if (!events.on_stderr()) {
    print_warnings(resolved.warnings);
  }
  events.begin(job.scene, format_frame_list(resolved.frames), resolved.frames.size(),
               resolved.pipeline.settings_digest);
  events.warnings(resolved.warnings);
  if (!is_quiet(job, events)) {
    say_decisions(run);
  }
}

std::string pixel_report(const FrameRequest& request, const Frame& frame, const PixelIndex& pixel) {
  const Vec3f radiance = frame.radiance(pixel.x, pixel.y);
  return fmt::format("frame {} pixel {},{}: radiance {} {} {}, samples {}, variance {}\n", request.frame, pixel.x,
                     pixel.y, radiance.x, radiance.y, radiance.z, frame.sample_count(pixel.x, pixel.y),
                     frame.variance(pixel.x, pixel.y));
}

void say_interrupted(const ResolvedJob& resolved, const SequenceResult& result, const std::string& reason,
                     const RunEvents& events) {
  if (resolved.job.settings.progress == "openjd") {
    std::printf("openjd_fail: interrupted by %s, %zu frames are left\n", reason.c_str(), result.left.size());
    std::fflush(stdout);
  }
  if (!events.on_stderr()) {
    std::fprintf(stderr, "gazetrace: interrupted by %s: %zu of %zu frames are done, %s left; go on with --resume\n",
                 reason.c_str(), resolved.frames.size() - result.left.size(), resolved.frames.size(),
                 bounded(format_frame_list(result.left), 200).c_str());
  }
}

int run_render(const RenderArguments& arguments, const Invocation& invocation, RunEvents& events) {
  const JobSettings& job = arguments.job.settings;
  const bool quiet = is_quiet(job, events);
  Interruption interruption(std::chrono::nanoseconds(job.grace.ns),
                            job.max_time ? std::optional(std::chrono::nanoseconds(job.max_time->ns)) : std::nullopt);
  check_asked_for_something(job);
  check_job(arguments.job);
  arguments.json.check();
  auto loading = std::make_unique<LoadProgress>(progress_style(job.progress, quiet));
  std::optional<Progress> progress;
  std::string pixels;  // the reports on `only-pixel`
  RunObserver observer;
  observer.loading = [&](std::size_t done, std::size_t total) { loading->parts_done(done, total); };
  observer.building_tree = [&] { loading->building_tree(); };
  observer.begins = [&](const StartedRun& run) {
    std::vector<std::string> others = run.files;
    for (const auto& [path, digest] : run.resolved.input_digests) {
      others.push_back(path);
    }
    arguments.json.check({}, std::move(others));
    if (const std::filesystem::path name = run.resolved.pipeline.output.run_name; job.chunk && !name.empty()) {
      const JobSettings& settings = run.resolved.job.settings;
      check_farm_denoiser(folder_of_run(name.string()), name.filename().string(), settings.filter,
                          settings.filter == "oidn" ? denoiser_description() : std::string());
    }
    loading.reset();
    interruption.frames_begin();
    tell_beginning(run, events);
    progress.emplace(progress_style(job.progress, quiet), run.resolved.plan.frames.size());
    keep_freed_memory();
  };
  observer.frame_done = [&](const TimingRow& row, bool skipped) {
    progress->frame_done(row.frame, row.total_ms, skipped);
    events.frame_done(row.frame, row.total_ms, skipped);
  };
  if (job.only_pixel) {
    observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
      pixels += pixel_report(request, frame, *job.only_pixel);
    };
  }
  observer.stop_before_frame = [&](double frame_ms) { return interruption.stop_before_frame(frame_ms); };
  observer.stop_now = [&] { return interruption.stop_now(); };
  RunOptions options;
  options.command_line = invocation.arguments;
  options.words = [](const std::string& text) { return with_flags(text); };
  const FinishedRun run = run_job(arguments.job, observer, options);
  progress->finish();
  tell_warnings(run.warnings, events);
  if (!quiet) {
    std::fputs(summary_text(run.result, run.wall_s).c_str(), stderr);
  }
  arguments.json.print(pixels, [&] { return summary_json(run); });
  const int code = run.result.interrupted ? exit_interrupted : exit_done;
  events.end(code, run.result);
  if (run.result.interrupted) {
    say_interrupted(run.resolved, run.result, interruption.reason(), events);
  }
  return code;
}

}  // namespace

Command add_render_command(CLI::App& app, const Invocation& invocation) {
  auto arguments = std::make_shared<RenderArguments>();
  bind_job_options(app, arguments->job);
  use_job_help(app,
               "gazetrace render scenes/courtyard/courtyard.gltf --gaze-at 0.4,0.5 --screen paper --size 480x270 -o "
               "out/frame.png");
  app.footer(std::string(kConfigHelp) + kExitCodesHelp);
  app.add_flag("--print-config", arguments->print_config, "Prints every option with its value as TOML, and stops");
  add_json_option(app, arguments->json, arguments->job.settings.overwrite);
  const auto run = [arguments, &invocation] {
    if (arguments->print_config) {
      print_warnings(arguments->job.warnings);
      print_result(job_as_toml(arguments->job));
      return static_cast<int>(exit_done);
    }
    RunEvents events(arguments->job.settings.progress);
    try {
      return run_render(*arguments, invocation, events);
    } catch (const Error& error) {
      events.end(exit_code_of(error), error.what());
      if (events.on_stderr()) {
        return exit_code_of(error);
      }
      if (arguments->job.settings.progress == "openjd" && error.kind() != ErrorKind::nothing_to_do) {
        std::printf("openjd_fail: %s\n", bounded(with_flags(error.what()), 500).c_str());
        std::fflush(stdout);
      }
      throw;
    }
  };
  return {run, [arguments](const std::string& path) { read_job_config(arguments->job, "render", path); }, true};
}

}  // namespace gazetrace
