// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/interruption.hpp"
#include "cli/job_help.hpp"
#include "cli/json_output.hpp"
#include "cli/keep_memory.hpp"
#include "cli/progress.hpp"
#include "cli/run_events.hpp"
#include "cli/run_record_file.hpp"
#include "cli/summary.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output_lock.hpp"
#include "gazetrace/resolve.hpp"

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

void say_decisions(const ResolvedJob& resolved, const ColorPipeline& color, const PathTracer& tracer) {
  std::fprintf(stderr, "scene: %s, loaded in %.2f s\n", resolved.scene->source.c_str(), resolved.load_s);
  for (const auto& [name, text] : resolved.decisions) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), with_flags(text).c_str());
  }
  std::fprintf(stderr, "view: %s\n", color.description().c_str());
  std::fprintf(stderr, "rays: %s, tree of %.0f MiB built in %.2f s\n", tracer.ray_library().c_str(),
               static_cast<double>(tracer.memory().bvh_bytes) / 1048576.0, tracer.memory().build_s);
}

void tell_beginning(const ResolvedJob& resolved, const ColorPipeline& color, const PathTracer& tracer,
                    RunEvents& events) {
  const JobSettings& job = resolved.job.settings;
  if (!events.on_stderr()) {
    print_warnings(resolved.warnings);
  }
  events.begin(job.scene, format_frame_list(resolved.frames), resolved.frames.size(),
               resolved.pipeline.settings_digest);
  events.warnings(resolved.warnings);
  if (!is_quiet(job, events)) {
    say_decisions(resolved, color, tracer);
  }
}

std::string pixel_report(const FrameRequest& request, const Frame& frame, const PixelIndex& pixel) {
  const Vec3f radiance = frame.radiance(pixel.x, pixel.y);
  return fmt::format("frame {} pixel {},{}: radiance {} {} {}, samples {}, variance {}\n", request.frame, pixel.x,
                     pixel.y, radiance.x, radiance.y, radiance.z, frame.sample_count(pixel.x, pixel.y),
                     frame.variance(pixel.x, pixel.y));
}

// What became known of frames while they were rendered.
struct FramesSeen {
  bool any_done = false;
  std::string pixels;  // the reports on `only-pixel`
};

// All that it is given must outlive it.
PipelineObserver observer_of(const JobSettings& job, Interruption& interruption, Progress& progress, RunEvents& events,
                             FramesSeen& seen) {
  PipelineObserver observer;
  observer.frame_done = [&](const TimingRow& row, bool skipped) {
    seen.any_done = true;
    progress.frame_done(row.frame, row.total_ms, skipped);
    events.frame_done(row.frame, row.total_ms, skipped);
  };
  if (job.only_pixel) {
    observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
      seen.pixels += pixel_report(request, frame, *job.only_pixel);
    };
  }
  observer.stop_before_frame = [&](double frame_ms) { return interruption.stop_before_frame(frame_ms); };
  return observer;
}

// The record of a run that begins now, written where there are outputs.
RunRecord begin_record(ResolvedJob& resolved, const PathTracer& tracer, const ColorPipeline& color,
                       const Invocation& invocation, const RunRecordFile& file) {
  RunRecord record = start_run_record(resolved, tracer, color, invocation.arguments);
  if (resolved.job.settings.resume) {
    file.warn_of_other_machine(record, resolved.warnings);
    record.warnings = resolved.warnings;
  }
  file.write(record);
  return record;
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
  check_asked_for_something(job);
  check_job(arguments.job);
  arguments.json.check();
  Interruption interruption(std::chrono::nanoseconds(job.grace.ns),
                            job.max_time ? std::optional(std::chrono::nanoseconds(job.max_time->ns)) : std::nullopt);
  const ColorPipeline color(job.color);
  auto loading = std::make_unique<LoadProgress>(progress_style(job.progress, quiet));
  ResolveOptions resolving;
  resolving.progress = [&](std::size_t done, std::size_t total) { loading->parts_done(done, total); };
  ResolvedJob resolved = resolve(arguments.job, resolving);
  prepare_outputs(resolved);
  const std::vector<std::string> files = output_files(resolved.pipeline, resolved.frames);
  const OutputLock lock = lock_outputs(resolved.pipeline, resolved.frames);
  prepare_outputs(resolved);  // another run may have made frames until then
  resolved.warnings.insert(resolved.warnings.end(), lock.warnings().begin(), lock.warnings().end());

  loading->building_tree();
  PathTracer tracer(*resolved.scene, tracer_options(job));
  loading.reset();
  interruption.frames_begin();
  const RunRecordFile record_file(files.empty() ? std::string() : files.front());
  RunRecord record = begin_record(resolved, tracer, color, invocation, record_file);
  tell_beginning(resolved, color, tracer, events);

  const auto begin = std::chrono::steady_clock::now();
  Progress progress(progress_style(job.progress, quiet), resolved.plan.frames.size());
  FramesSeen seen;
  const PipelineObserver observer = observer_of(job, interruption, progress, events, seen);
  resolved.pipeline.trace.stop = [&] { return interruption.stop_now(); };
  keep_freed_memory();
  const SequenceResult result = [&] {
    try {
      return render_sequence(tracer, resolved.plan, color, resolved.pipeline, observer, std::move(resolved.history));
    } catch (const Error& error) {
      // A stated quality may turn out to be out of reach before any picture was begun: then the folder is left as it
      // was, so that the same command can be given again with what the message advises.
      if (error.kind() == ErrorKind::usage && !seen.any_done) {
        record_file.put_back();
      }
      throw;
    }
  }();
  progress.finish();
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  if (!files.empty()) {
    finish_run_record(record, result, resolved.plan, wall_s);
    record_file.write(record);
    finish_files(files.front());
  }
  tell_warnings(result_warnings(result, resolved.plan), events);
  if (!quiet) {
    std::fputs(summary_text(result, wall_s).c_str(), stderr);
  }
  arguments.json.print(seen.pixels, [&] { return summary_json(result, resolved, wall_s); });
  const int code = result.interrupted ? exit_interrupted : exit_done;
  events.end(code, result);
  if (result.interrupted) {
    say_interrupted(resolved, result, interruption.reason(), events);
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
  return {run, [arguments](const std::string& path) { read_job_config(arguments->job, "render", path); }};
}

}  // namespace gazetrace
