// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "cli/keep_memory.hpp"
#include "cli/progress.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/sweep_plan.hpp"

namespace gazetrace {
namespace {

struct SweepArguments {
  std::string plan, output;
  std::optional<FrameList> frames;
  std::optional<int> threads;
  bool dry_run = false, restart = false, quiet = false;
  JsonOutput json;
};

// A guess to tell minutes from days: a core traces about this many camera samples a second in a scene like Sponza.
constexpr double kSamplesPerCoreSecond = 2.5e5;

std::string estimate_json(const SweepEstimate& estimate) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const SweepEstimate::Row& row : estimate.rows) {
    rows.push_back({{"id", row.id},
                    {"role", row.role},
                    {"samples", row.samples},
                    {"repeats", row.repeats},
                    {"setting", row.label}});
  }
  const nlohmann::ordered_json json{{"rows", std::move(rows)}, {"samples", estimate.samples}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string estimate_text(const SweepEstimate& estimate, int threads) {
  std::string text = fmt::format("{:<34} {:<24}{:>16}{:>9}  {}\n", "id", "role", "samples", "repeats", "setting");
  for (const SweepEstimate::Row& row : estimate.rows) {
    text += fmt::format("{:<34} {:<24}{:>16.0f}{:>9}  {}\n", row.id, row.role, row.samples, row.repeats, row.label);
  }
  const double seconds = estimate.samples / kSamplesPerCoreSecond / threads;
  return text + fmt::format(
                    "{} rows, {:.3g} samples; about {} at {:g} samples a second on each of {} threads, metrics "
                    "apart\n",
                    estimate.rows.size(), estimate.samples, duration_text(seconds), kSamplesPerCoreSecond, threads);
}

int run_sweep_command(const SweepArguments& arguments) {
  if (arguments.plan.empty()) {
    throw Error(ErrorKind::usage, "", "no plan was given", "gazetrace sweep PLAN.toml -o FOLDER");
  }
  LoadedSweepPlan jobs = load_sweep_plan(arguments.plan, arguments.frames, arguments.threads);
  SweepPlan& plan = jobs.plan;
  plan.directory =
      arguments.output.empty() ? std::filesystem::path(arguments.plan).stem().string() + ".sweep" : arguments.output;
  plan.restart = arguments.restart;
  if (!arguments.quiet) {
    print_warnings(jobs.warnings);
  }
  arguments.json.check();
  if (arguments.dry_run) {
    const int given = plan.tests.front().pipeline.threads;
    const int threads = given > 0 ? given : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const SweepEstimate estimate = estimate_sweep(plan);
    arguments.json.print(estimate_text(estimate, threads), [&] { return estimate_json(estimate); });
    return exit_done;
  }
  const SweepDirectory directory = prepare_sweep(plan);
  SweepObserver observer;
  if (!arguments.quiet) {
    observer.tell = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  }
  keep_freed_memory();
  const Results results = run_sweep(plan, observer);
  write_text_atomically(plan.directory + "/results.csv", results_csv(results));
  write_text_atomically(plan.directory + "/methods.txt", results_methods(results));
  write_text_atomically(plan.directory + "/results.json", results_json(results));
  arguments.json.print(results_table(results), [&] { return results_json(results); });
  return exit_done;
}

}  // namespace

Command add_sweep_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<SweepArguments>();
  OptionSchema<SweepArguments> schema;
  schema.value("plan", &SweepArguments::plan, "PLAN.toml", "Scenes, gazes, settings, reference and what to measure");
  schema.value(
      "-o,--output", &SweepArguments::output, "FOLDER",
      "Results, pictures and what is needed to go on after an interruption; default: the plan's name with .sweep");
  schema.value("--frames", &SweepArguments::frames, "LIST", "In place of the plan's");
  schema.value("--threads", &SweepArguments::threads, "N", "In place of the plan's; 0: as many as the machine has");
  schema.flag("--dry-run", &SweepArguments::dry_run, "Checks the plan, prints its rows and how much there is to do");
  schema.flag("--restart", &SweepArguments::restart, "Throws away what the folder holds of an earlier sweep");
  schema.flag("--quiet", &SweepArguments::quiet, "Tells nothing but the table");
  const auto options = std::make_shared<CommandOptions<SweepArguments>>(std::move(schema));
  options->bind(app, *arguments);
  add_json_option(app, arguments->json);
  app.footer(kExitCodesHelp);
  return {[arguments, options] { return run_sweep_command(*arguments); }, {}};
}

}  // namespace gazetrace
