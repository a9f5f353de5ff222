// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/interruption.hpp"
#include "cli/json_output.hpp"
#include "cli/keep_memory.hpp"
#include "cli/progress.hpp"
#include "cli/run_events.hpp"
#include "cli/summary.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
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

RunRecord record_with_flags(RunRecord record) {
  record.warnings = with_flags(std::move(record.warnings));
  for (auto& [name, text] : record.facts) {
    text = with_flags(text);
  }
  return record;
}

// Embree and libm choose kernels by the machine: frames of two kinds of machine may differ in their last bits.
void warn_of_other_machine(const std::string& record_path, const RunRecord& now, Warnings& warnings) {
  if (!std::filesystem::exists(record_path)) {
    return;
  }
  RunRecord before;
  try {
    before = read_run_record(record_path);
  } catch (const Error& error) {
    warnings.push_back(error.what());
    return;
  }
  if (before.instruction_set != now.instruction_set || before.build != now.build ||
      before.ray_library != now.ray_library) {
    warnings.push_back(
        fmt::format("{}: the run so far was made by '{}, {}, {}', this one is '{}, {}, {}'; frames may "
                    "differ in their last bits",
                    record_path, before.build, before.instruction_set, before.ray_library, now.build,
                    now.instruction_set, now.ray_library));
  }
}

// The folder of a pattern's files, or of the folders that it makes for each frame.
std::filesystem::path folder_of_pattern(const std::string& pattern) {
  std::filesystem::path one = std::filesystem::path(frame_file_name(pattern, 1)).parent_path();
  std::filesystem::path other = std::filesystem::path(frame_file_name(pattern, 2)).parent_path();
  while (one != other) {
    one = one.parent_path();
    other = other.parent_path();
  }
  return one;
}

// Of the record, and of the pictures where they go: another run may write pictures of the same names beside a record
// that lies elsewhere.
std::vector<std::unique_ptr<RunLock>> lock_outputs(ResolvedJob& resolved, const std::vector<std::string>& files) {
  if (files.empty()) {
    return {};
  }
  RunRecord claim;
  claim.frames = format_frame_list(resolved.frames);
  if (resolved.pipeline.trace.samples) {
    claim.samples = format_value(*resolved.pipeline.trace.samples);
  }
  const auto tell = [](const std::string& text) { print_warnings({text}); };
  std::vector<std::unique_ptr<RunLock>> locks;
  locks.push_back(std::make_unique<RunLock>(claim, files.front(), tell));
  const std::string record_name = std::filesystem::path(files.front()).filename().string();
  const OutputSettings& output = resolved.pipeline.output;
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern}) {
    const bool has_pictures = claim.samples.empty() && resolved.pipeline.stage != SequenceStage::trace;
    if (!pattern.empty() && has_pictures) {
      const std::filesystem::path folder = folder_of_pattern(pattern);
      const std::string name =
          std::filesystem::path(pattern).lexically_relative(folder.empty() ? "." : folder).string();
      const std::string family = "pictures." + digest_settings({{"pattern", name}}).substr(0, 8) + ".";
      locks.push_back(std::make_unique<RunLock>(claim, (folder / record_name).string(), tell, family));
    }
  }
  for (const std::unique_ptr<RunLock>& lock : locks) {
    // Said to the person who waits, and not kept in the record, which may be published: it names a host.
    print_warnings(lock->taken_over());
  }
  // Another run may have made frames while this one checked or waited.
  prepare_outputs(resolved);
  return locks;
}

std::string pixel_report(const FrameRequest& request, const Frame& frame, const PixelIndex& pixel) {
  const Vec3f radiance = frame.radiance(pixel.x, pixel.y);
  return fmt::format("frame {} pixel {},{}: radiance {} {} {}, samples {}, variance {}\n", request.frame, pixel.x,
                     pixel.y, radiance.x, radiance.y, radiance.z, frame.sample_count(pixel.x, pixel.y),
                     frame.variance(pixel.x, pixel.y));
}

// The record of an earlier run, or none where there was none.
void put_back(const std::string& path, const std::string& record) {
  if (!record.empty()) {
    write_text_atomically(path, record);
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
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

int run_render(const RenderArguments& arguments, const Invocation& invocation, RunEvents& events) {
  const JobSettings& job = arguments.job.settings;
  const bool quiet = job.quiet || events.on_stderr();
  const auto warn = [&](const Warnings& warnings) { events.on_stderr() ? void() : print_warnings(warnings); };
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
  const std::vector<std::unique_ptr<RunLock>> locks = lock_outputs(resolved, files);

  loading->building_tree();
  PathTracer tracer(*resolved.scene, tracer_options(job));
  loading.reset();
  interruption.frames_begin();
  RunRecord record = start_run_record(resolved, tracer, color, invocation.arguments);
  std::string earlier_record;  // of the run whose outputs this one replaces
  if (!files.empty()) {
    if (std::filesystem::exists(files.front())) {
      earlier_record = read_text_file(files.front());
    }
    if (job.resume) {
      warn_of_other_machine(files.front(), record, resolved.warnings);
      record.warnings = resolved.warnings;
    }
    // Written now and at the end: a killed run has a record, too.
    write_text_atomically(files.front(), run_record_json(record_with_flags(record)));
  }
  warn(resolved.warnings);
  events.begin(job.scene, format_frame_list(resolved.frames), resolved.frames.size(),
               resolved.pipeline.settings_digest);
  events.warnings(resolved.warnings);
  if (!quiet) {
    say_decisions(resolved, color, tracer);
  }

  const auto begin = std::chrono::steady_clock::now();
  Progress progress(progress_style(job.progress, quiet), resolved.plan.frames.size());
  bool any_done = false;
  PipelineObserver observer;
  observer.frame_done = [&](const TimingRow& row, bool skipped) {
    any_done = true;
    progress.frame_done(row.frame, row.total_ms, skipped);
    events.frame_done(row.frame, row.total_ms, skipped);
  };
  std::string pixels;
  if (job.only_pixel) {
    observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
      pixels += pixel_report(request, frame, *job.only_pixel);
    };
  }
  observer.stop_before_frame = [&](double frame_ms) { return interruption.stop_before_frame(frame_ms); };
  resolved.pipeline.trace.stop = [&] { return interruption.stop_now(); };
  keep_freed_memory();
  const SequenceResult result = [&] {
    try {
      return render_sequence(tracer, resolved.plan, color, resolved.pipeline, observer, std::move(resolved.history));
    } catch (const Error& error) {
      // A stated quality may turn out to be out of reach before any picture was begun: then the folder is left as it
      // was, so that the same command can be given again with what the message advises.
      if (error.kind() == ErrorKind::usage && !any_done && !files.empty()) {
        put_back(files.front(), earlier_record);
      }
      throw;
    }
  }();
  progress.finish();
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  if (!files.empty()) {
    finish_run_record(record, result, resolved.plan, wall_s);
    write_text_atomically(files.front(), run_record_json(record_with_flags(record)));
    finish_files(files.front());
  }
  warn(result_warnings(result, resolved.plan));
  events.warnings(result_warnings(result, resolved.plan));
  if (!quiet) {
    std::fputs(summary_text(result, wall_s).c_str(), stderr);
  }
  arguments.json.print(pixels, [&] { return summary_json(result, resolved, wall_s); });
  events.end(result.interrupted ? exit_interrupted : exit_done, result);
  if (result.interrupted) {
    if (job.progress == "openjd") {
      std::printf("openjd_fail: interrupted by %s, %zu frames are left\n", interruption.reason().c_str(),
                  result.left.size());
      std::fflush(stdout);
    }
    if (!events.on_stderr()) {
      std::fprintf(stderr, "gazetrace: interrupted by %s: %zu of %zu frames are done, %s left; go on with --resume\n",
                   interruption.reason().c_str(), resolved.frames.size() - result.left.size(), resolved.frames.size(),
                   bounded(format_frame_list(result.left), 200).c_str());
    }
    return exit_interrupted;
  }
  return exit_done;
}

}  // namespace

Command add_render_command(CLI::App& app, const Invocation& invocation) {
  auto arguments = std::make_shared<RenderArguments>();
  bind_job_options(app, arguments->job);
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
