// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/recorded_run.hpp"
#include "gazetrace/sample_parts.hpp"

namespace gazetrace {
namespace {

struct MergeArguments {
  std::string directory;
  bool allow_missing = false;
  bool overwrite = false;
  bool trust_files = false;
  int threads = 0;
  JsonOutput json;
};

// The error names a few bad files; of more, every one has a line of its own before.
void check_files(const std::vector<RunPart>& parts, const MergeArguments& arguments) {
  constexpr std::size_t kNamedByError = 4;
  const std::vector<BadFile> bad = find_bad_files(parts, arguments.threads);
  for (const BadFile& file : bad.size() > kNamedByError ? bad : std::vector<BadFile>()) {
    std::fprintf(stderr, "gazetrace: bad file: %s: %s\n", bounded(file.path).c_str(), bounded(file.problem).c_str());
  }
  refuse_bad_files(arguments.directory, bad);
}

MergeResult run_merge_samples(const std::vector<RunPart>& parts, const MergeArguments& arguments) {
  const ResolvedJob resolved = resolve_whole_of_parts(parts, arguments.overwrite);
  const ColorPipeline color(resolved.job.settings.color);
  prepare_outputs(resolved);
  return merge_samples(parts, resolved.plan, color, resolved.pipeline);
}

int run_merge(const MergeArguments& arguments) {
  arguments.json.check();
  const std::vector<RunPart> parts = read_run_parts(arguments.directory);
  const bool of_samples = are_parts_of_samples(parts);
  MergeOptions options{arguments.allow_missing, arguments.overwrite, arguments.trust_files, arguments.threads};
  if (!options.trust_files && (of_samples || !options.allow_missing)) {
    check_files(parts, arguments);
    options.trust_files = true;
  }
  const MergeResult result =
      of_samples ? run_merge_samples(parts, arguments) : merge_runs(arguments.directory, options);
  print_warnings(result.warnings);
  arguments.json.print(fmt::format("{} parts joined, frames {}\n", result.parts.size(), result.frames), [&] {
    const nlohmann::ordered_json json{
        {"parts", result.parts}, {"frames", result.frames}, {"warnings", with_flags(result.warnings)}};
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  });
  return exit_done;
}

}  // namespace

Command add_merge_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<MergeArguments>();
  app.add_option("folder", arguments->directory, "Where the parts were rendered into")->required()->type_name("DIR");
  app.add_flag("--allow-missing", arguments->allow_missing,
               "Joins what is there though frames are missing, or their files bad");
  app.add_flag("--trust-files", arguments->trust_files,
               "Does not compare the files of the parts with what their records say was written");
  app.add_option("--threads", arguments->threads, "For comparing files; 0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces timing.csv, run.json and, of parts of samples, pictures");
  add_json_option(app, arguments->json);
  return {[arguments] { return run_merge(*arguments); }, {}};
}

}  // namespace gazetrace
