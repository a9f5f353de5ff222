// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/interruption.hpp"
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
  std::optional<Chunk> chunk;
  std::vector<std::string> folders;  // of merge
  DurationNs grace{25'000'000'000};
  std::optional<DurationNs> max_time;
  bool confine = false, dry_run = false, restart = false, trust_files = false, quiet = false;
  JsonOutput json, merge_json;

  [[nodiscard]] std::optional<SweepTask> task() const {
    return chunk ? std::optional(SweepTask{chunk->number, chunk->count}) : std::nullopt;
  }
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

std::string shares_text(const SweepPlan& plan, std::uint32_t count) {
  std::string text = fmt::format("{:>6}{:>16}  {}\n", "chunk", "samples", "rows");
  const std::vector<SweepShare> shares = divide_sweep(plan, count);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    text += fmt::format("{:>6}{:>16.0f}  {}\n", i + 1, shares[i].samples, fmt::join(shares[i].rows, " "));
  }
  return text;
}

std::string shares_json(const SweepPlan& plan, std::uint32_t count) {
  nlohmann::ordered_json chunks = nlohmann::ordered_json::array();
  for (const SweepShare& share : divide_sweep(plan, count)) {
    chunks.push_back({{"samples", share.samples}, {"rows", share.rows}});
  }
  return chunks.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

// Student's factor for few repeats is so large that no interval says anything.
void warn_of_repeats(int repeats) {
  constexpr int kFew = 3;
  if (repeats < 2) {
    print_warnings({"one repeat gives no interval; give repeats = 3 or more in [measure]"});
  } else if (repeats < kFew) {
    print_warnings(
        {fmt::format("two repeats give no interval that tells anything: its half is {:.1f} standard errors; "
                     "three have {:.1f}, five {:.1f}",
                     student_t_quantile(0.975, 1), student_t_quantile(0.975, 2), student_t_quantile(0.975, 4))});
  }
}

SweepPlan load_plan(const SweepArguments& arguments) {
  if (arguments.plan.empty()) {
    throw Error(ErrorKind::usage, "", "no plan was given", "gazetrace sweep PLAN.toml -o FOLDER");
  }
  LoadedSweepPlan jobs =
      load_sweep_plan(arguments.plan, arguments.frames, arguments.threads, job_schema(), arguments.confine);
  SweepPlan& plan = jobs.plan;
  plan.directory =
      arguments.output.empty() ? std::filesystem::path(arguments.plan).stem().string() + ".sweep" : arguments.output;
  plan.restart = arguments.restart;
  plan.trust_files = arguments.trust_files;
  if (!arguments.quiet) {
    print_warnings(jobs.warnings);
  }
  return std::move(plan);
}

void write_and_print(const SweepPlan& plan, const Results& results, const JsonOutput& json) {
  write_results(plan.directory, results);
  json.print(results_table(results), [&] { return results_json(results); });
}

// Work that is lost and done again is told of in any case.
SweepObserver warning_observer() {
  SweepObserver observer;
  observer.warn = [](const std::string& line) { print_warnings({line}); };
  return observer;
}

int run_sweep_command(const SweepArguments& arguments) {
  Interruption interruption(
      std::chrono::nanoseconds(arguments.grace.ns),
      arguments.max_time ? std::optional(std::chrono::nanoseconds(arguments.max_time->ns)) : std::nullopt);
  const SweepPlan plan = load_plan(arguments);
  arguments.json.check({}, plan.files);
  if (arguments.dry_run && arguments.chunk) {
    arguments.json.print(shares_text(plan, arguments.chunk->count),
                         [&] { return shares_json(plan, arguments.chunk->count); });
    return exit_done;
  }
  if (arguments.dry_run) {
    warn_of_repeats(plan.measure.repeats);
    const int given = plan.tests.front().pipeline.threads;
    const int threads = given > 0 ? given : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const SweepEstimate estimate = estimate_sweep(plan);
    arguments.json.print(estimate_text(estimate, threads), [&] { return estimate_json(estimate); });
    return exit_done;
  }
  SweepObserver observer = warning_observer();
  observer.stop_before_frame = [&](double frame_ms) { return interruption.stop_before_frame(frame_ms); };
  observer.stop_now = [&] { return interruption.stop_now(); };
  if (!arguments.quiet) {
    observer.tell = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  }
  const SweepDirectory directory = prepare_sweep(plan, arguments.task(), observer);
  interruption.frames_begin();
  keep_freed_memory();
  try {
    if (const std::optional<SweepTask> task = arguments.task()) {
      run_sweep_task(plan, *task, observer);
    } else {
      write_and_print(plan, run_sweep(plan, observer), arguments.json);
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) {
      throw;
    }
    std::fprintf(stderr, "gazetrace: interrupted by %s; finished measurements are kept, and the same call continues\n",
                 interruption.reason().c_str());
    return exit_interrupted;
  }
  return exit_done;
}

int run_sweep_merge(const SweepArguments& arguments) {
  let_signals_go();
  const SweepPlan plan = load_plan(arguments);
  arguments.merge_json.check({}, plan.files);
  write_and_print(plan, merge_sweep(plan, arguments.folders, warning_observer()), arguments.merge_json);
  return exit_done;
}

}  // namespace

Command add_sweep_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<SweepArguments>();
  // What a sweep and its merge have in common: the merge must know the plan as the chunks knew it.
  const auto shared_schema = [] {
    OptionSchema<SweepArguments> schema;
    schema.value("plan", &SweepArguments::plan, "PLAN.toml", "Scenes, gazes, settings, reference and measurements");
    schema.value(
        "-o,--output", &SweepArguments::output, "FOLDER",
        "Results, pictures and the state for continuing after an interruption; default: the plan's name with .sweep");
    schema.value("--frames", &SweepArguments::frames, "LIST", "In place of the plan's");
    schema.flag("--confine", &SweepArguments::confine,
                "Refuses a plan that names files outside of its folder or data set; for plans of others");
    schema.flag("--trust-files", &SweepArguments::trust_files,
                "Does not compare finished pictures in the folder with their digests, which reads them once");
    return schema;
  };
  OptionSchema<SweepArguments> schema = shared_schema();
  schema.value("--threads", &SweepArguments::threads, "N", "In place of the plan's; 0: as many as the machine has");
  schema.value("--chunk", &SweepArguments::chunk, "K/N",
               "Measures only the K-th of N parts of the rows, of about equal cost; 'sweep merge' makes the tables");
  schema.flag("--dry-run", &SweepArguments::dry_run,
              "Checks the plan, prints its rows and how much there is to do; with --chunk 1/N, how they are divided");
  schema.value(
      "--grace", &SweepArguments::grace, "DURATION",
      "After a signal to end (TERM, INT, HUP, USR1, XCPU), the time to finish the frame in hand; the row that it is "
      "of is measured again by the next call");
  schema.value("--max-time", &SweepArguments::max_time, "DURATION",
               "Ends as if by a signal so long after its beginning, --grace included; scenes that are loaded and "
               "pictures that are scored then are finished before");
  schema.flag("--restart", &SweepArguments::restart, "Deletes an earlier sweep in the folder");
  schema.flag("--quiet", &SweepArguments::quiet, "Tells nothing but the table");
  const auto options = std::make_shared<CommandOptions<SweepArguments>>(std::move(schema));
  options->bind(app, *arguments);
  add_json_option(app, arguments->json);
  app.footer(kExitCodesHelp);

  CLI::App* const merge = app.add_subcommand("merge", "Make the tables of a sweep that was measured in chunks");
  merge->footer(kExitCodesHelp);
  const auto merge_options = std::make_shared<CommandOptions<SweepArguments>>(shared_schema());
  merge_options->bind(*merge, *arguments);
  merge
      ->add_option("folders", arguments->folders,
                   "Folders of chunks that were written apart; their results are taken into --output")
      ->type_name("DIR");
  add_json_option(*merge, arguments->merge_json);
  app.require_subcommand(0, 1);
  return {[arguments, options, merge_options, merge] {
            return merge->parsed() ? run_sweep_merge(*arguments) : run_sweep_command(*arguments);
          },
          {},
          true};
}

}  // namespace gazetrace
