// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/idle_options.hpp"
#include "cli/inputs.hpp"
#include "cli/keep_memory.hpp"
#include "cli/progress.hpp"
#include "cli/summary.hpp"
#include "cli/toml_config.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

struct RenderArguments {
  JobSettings job;
  OptionTable table;
  bool print_config = false;
  bool json = false;
};

void check_asked_for_something(const JobSettings& job) {
  if (job.scene.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "gazetrace render SCENE.gltf -o frame.####.exr");
  }
  if (job.outputs.empty() && job.map_pattern.empty() && !job.only_pixel) {
    throw Error(ErrorKind::usage, "", "no output was given", "add -o frame.####.exr and/or -o frame.####.png");
  }
}

RunRecord start_record(const RenderArguments& arguments, const Invocation& invocation, const Inputs& inputs,
                       const PipelineSettings& settings, const TemporalHistory& history, const PathTracer& tracer,
                       const ColorPipeline& color) {
  RunRecord record;
  record.version = kVersion;
  record.build = build_description();
  record.instruction_set = instruction_set();
  record.ray_library = tracer.ray_library();
  record.command_line = invocation.arguments;
  record.config_toml = settings_as_toml(arguments.table, "gazetrace render");
  record.settings_digest = settings.settings_digest;
  record.history = recorded_history(inputs.plan, settings, history);
  record.frames = format_frame_list(inputs.frames);
  record.is_part = settings.is_part || settings.trace.samples.has_value();
  record.samples = settings.trace.samples ? format_value(*settings.trace.samples) : "";
  record.warnings = with_flags(inputs.warnings);
  for (const auto& [name, text] : inputs.decisions) {
    record.facts[name] = text;
  }
  record.facts["working_space"] = "linear Rec.709, D65";
  record.facts["view"] = color.description();
  record.facts["load_s"] = fmt::format("{:.3f}", inputs.load_s);
  record.facts["bvh_build_s"] = fmt::format("{:.3f}", tracer.memory().build_s);
  record.facts["bvh_mib"] = fmt::format("{:.1f}", static_cast<double>(tracer.memory().bvh_bytes) / 1048576.0);
  record.facts["state"] = "running";
  return record;
}

// Embree and libm choose kernels by the machine: frames of two kinds of machine may differ in their last bits.
void warn_of_other_machine(const std::string& record_path, const RunRecord& now, Warnings& warnings) {
  if (!std::filesystem::exists(record_path)) {
    return;
  }
  const RunRecord before = read_run_record(record_path);
  if (before.instruction_set != now.instruction_set || before.build != now.build ||
      before.ray_library != now.ray_library) {
    warnings.push_back(
        fmt::format("{}: the run so far was made by '{}, {}, {}', this one is '{}, {}, {}'; frames may "
                    "differ in their last bits",
                    record_path, before.build, before.instruction_set, before.ray_library, now.build,
                    now.instruction_set, now.ray_library));
  }
}

std::string pixel_report(const FrameRequest& request, const Frame& frame, const PixelIndex& pixel) {
  const Vec3f radiance = frame.radiance(pixel.x, pixel.y);
  return fmt::format("frame {} pixel {},{}: radiance {} {} {}, samples {}, variance {}\n", request.frame, pixel.x,
                     pixel.y, radiance.x, radiance.y, radiance.z, frame.sample_count(pixel.x, pixel.y),
                     frame.variance(pixel.x, pixel.y));
}

void say_decisions(const Inputs& inputs, const ColorPipeline& color, const PathTracer& tracer) {
  std::fprintf(stderr, "scene: %s, loaded in %.2f s\n", inputs.scene->source.c_str(), inputs.load_s);
  for (const auto& [name, text] : inputs.decisions) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), text.c_str());
  }
  std::fprintf(stderr, "view: %s\n", color.description().c_str());
  std::fprintf(stderr, "rays: %s, tree of %.0f MiB built in %.2f s\n", tracer.ray_library().c_str(),
               static_cast<double>(tracer.memory().bvh_bytes) / 1048576.0, tracer.memory().build_s);
}

int run_render(const RenderArguments& arguments, const Invocation& invocation) {
  const JobSettings& job = arguments.job;
  check_asked_for_something(job);
  check_settings(job);
  const ColorPipeline color(job.color);
  auto loading = std::make_unique<LoadProgress>(progress_style(job.progress, job.quiet));
  Inputs inputs = load_inputs(job, InputScope::render,
                              [&](std::size_t done, std::size_t total) { loading->parts_done(done, total); });
  const Warnings idle = idle_option_warnings(arguments.table, job);
  inputs.warnings.insert(inputs.warnings.begin(), idle.begin(), idle.end());
  PipelineSettings settings = pipeline_settings(job, inputs.frames);
  const std::map<std::string, std::string> digests = digest_job_files(job);
  settings.preroll = static_cast<std::int32_t>(inputs.plan.frames.size() - inputs.frames.size());
  digest_job(arguments.table, job, inputs.frames, digests, settings);
  TemporalHistory history = starting_history(inputs.plan, settings, inputs.warnings);
  if (inputs.gaze && !history.passed.empty()) {
    join_plan(inputs.plan, history.passed.back(), *inputs.gaze, inputs.plan_settings);
  }
  prepare_outputs(settings, inputs.frames, digests);

  TracerOptions options;
  options.threads = job.threads;
  options.bvh_quality = job.bvh;
  loading->building_tree();
  PathTracer tracer(*inputs.scene, options);
  loading.reset();
  RunRecord record = start_record(arguments, invocation, inputs, settings, history, tracer, color);
  record.input_digests = digests;
  const std::vector<std::string> files = output_files(settings, inputs.frames);
  if (!files.empty()) {
    if (job.resume) {
      warn_of_other_machine(files.front(), record, inputs.warnings);
      record.warnings = with_flags(inputs.warnings);
    }
    // Written now and at the end: a killed run has a record, too.
    write_text_atomically(files.front(), run_record_json(record));
  }
  print_warnings(inputs.warnings);
  if (!job.quiet) {
    say_decisions(inputs, color, tracer);
  }

  const auto begin = std::chrono::steady_clock::now();
  Progress progress(progress_style(job.progress, job.quiet), inputs.plan.frames.size());
  PipelineObserver observer;
  observer.frame_done = [&](const TimingRow& row, bool skipped) {
    progress.frame_done(row.frame, row.total_ms, skipped);
  };
  std::string pixels;
  if (job.only_pixel) {
    observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
      pixels += pixel_report(request, frame, *job.only_pixel);
    };
  }
  keep_freed_memory();
  const SequenceResult result = render_sequence(tracer, inputs.plan, color, settings, observer, std::move(history));
  progress.finish();
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  const Warnings late = with_flags(result_warnings(result, inputs.plan));
  if (!files.empty()) {
    record.facts["state"] = "done";
    record.facts["wall_s"] = fmt::format("{:.3f}", wall_s);
    record.facts["peak_memory_mib"] = fmt::format("{:.1f}", peak_memory_mib());
    record.warnings.insert(record.warnings.end(), late.begin(), late.end());
    record.bad_samples = result.bad_samples;
    write_text_atomically(files.front(), run_record_json(record));
  }
  print_warnings(late);
  if (!job.quiet) {
    std::fputs(summary_text(result, wall_s).c_str(), stderr);
  }
  if (arguments.json) {
    print_result(summary_json(result, inputs, settings, wall_s));
  } else {
    print_result(pixels);
  }
  return exit_done;
}

}  // namespace

Command add_render_command(CLI::App& app, const Invocation& invocation) {
  auto arguments = std::make_shared<RenderArguments>();
  add_job_options(arguments->table, arguments->job);
  bind_options(app, arguments->table);
  app.footer(std::string(kConfigHelp) + kExitCodesHelp);
  app.add_flag("--json", arguments->json, "Prints the closing summary as JSON on stdout");
  app.add_flag("--print-config", arguments->print_config, "Prints every option with its value as TOML, and stops");
  const auto run = [arguments, &invocation] {
    if (arguments->print_config) {
      print_result(settings_as_toml(arguments->table, "gazetrace render"));
      return static_cast<int>(exit_done);
    }
    // The record says what was done.
    arguments->job.filter = filter_of(arguments->job);
    return run_render(*arguments, invocation);
  };
  return {run, std::shared_ptr<const OptionTable>(arguments, &arguments->table)};
}

}  // namespace gazetrace
