// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct MergeArguments {
  std::string directory;
  bool allow_missing = false;
  bool overwrite = false;
};

int run_merge(const MergeArguments& arguments) {
  const MergeResult result = merge_runs(arguments.directory, arguments.allow_missing, arguments.overwrite);
  print_warnings(result.warnings);
  print_result(fmt::format("{} parts joined, frames {}\n", result.parts.size(), result.frames));
  return exit_done;
}

}  // namespace

Command add_merge_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<MergeArguments>();
  app.add_option("folder", arguments->directory, "Where the parts were rendered into")->required()->type_name("DIR");
  app.add_flag("--allow-missing", arguments->allow_missing, "Joins what is there though frames are missing");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces timing.csv and run.json");
  return {[arguments] { return run_merge(*arguments); }, nullptr};
}

}  // namespace gazetrace
