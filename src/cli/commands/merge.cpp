// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/recorded_run.hpp"

namespace gazetrace {
namespace {

struct MergeArguments {
  std::string directory;
  bool allow_missing = false;
  bool overwrite = false;
};

MergeResult run_merge_samples(const std::vector<RunPart>& parts, const MergeArguments& arguments) {
  const ResolvedJob resolved = resolve_whole_of_parts(parts, arguments.overwrite);
  const ColorPipeline color(resolved.job.settings.color);
  prepare_outputs(resolved);
  return merge_samples(parts, resolved.plan, color, resolved.pipeline);
}

int run_merge(const MergeArguments& arguments) {
  const std::vector<RunPart> parts = read_run_parts(arguments.directory);
  const MergeResult result = are_parts_of_samples(parts)
                                 ? run_merge_samples(parts, arguments)
                                 : merge_runs(arguments.directory, arguments.allow_missing, arguments.overwrite);
  print_warnings(result.warnings);
  print_result(fmt::format("{} parts joined, frames {}\n", result.parts.size(), result.frames));
  return exit_done;
}

}  // namespace

Command add_merge_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<MergeArguments>();
  app.add_option("folder", arguments->directory, "Where the parts were rendered into")->required()->type_name("DIR");
  app.add_flag("--allow-missing", arguments->allow_missing, "Joins what is there though frames are missing");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces timing.csv, run.json and, of parts of samples, pictures");
  return {[arguments] { return run_merge(*arguments); }, {}};
}

}  // namespace gazetrace
