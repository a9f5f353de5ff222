// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/merge_means.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct MergeArguments {
  std::vector<std::string> inputs;  // the folder of the parts, or the renders of a mean
  bool mean = false;
  std::string output;
  bool resume = false;
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
  refuse_bad_files(folder_of_run(parts.front().run_name), bad);
}

MergeResult run_merge_means(const MergeArguments& arguments, const std::vector<std::string>& command_line) {
  if (arguments.output.empty()) {
    throw Error(ErrorKind::usage, "--mean", "needs a name for the pictures", "add --output mean.####.exr");
  }
  if (arguments.threads > 0 || arguments.trust_files) {
    throw Error(ErrorKind::usage, "--mean", "reads one picture after the other, and compares none with a record",
                "leave out --threads and --trust-files");
  }
  return merge_means({arguments.inputs, arguments.output, command_line, arguments.allow_missing, arguments.overwrite,
                      arguments.resume});
}

MergeResult run_merge_parts(const MergeArguments& arguments) {
  if (arguments.inputs.size() > 1 || !arguments.output.empty() || arguments.resume) {
    throw Error(ErrorKind::usage, "merge", "joins the parts in one folder, and needs nothing else",
                "give --mean for the mean of renders");
  }
  const std::string& directory = arguments.inputs.front();
  const std::vector<RunPart> parts = read_run_parts(directory);
  std::vector<std::string> inputs;
  for (const RunPart& part : parts) {
    inputs.insert(inputs.end(), {part.timing_path, part.record_path});
    for (const auto& [name, file] : part.record.files) {
      inputs.push_back((std::filesystem::path(part.record_path).parent_path() / name).string());
    }
  }
  arguments.json.check({}, inputs);
  MergeOptions options{arguments.allow_missing, arguments.overwrite, arguments.trust_files, arguments.threads};
  if (!options.trust_files && !options.allow_missing) {
    check_files(parts, arguments);
    options.trust_files = true;
  }
  return merge_runs(directory, options);
}

int run_merge(const MergeArguments& arguments, const std::vector<std::string>& command_line) {
  arguments.json.check();
  const MergeResult result = arguments.mean ? run_merge_means(arguments, command_line) : run_merge_parts(arguments);
  print_warnings(result.warnings);
  const char* const done = arguments.mean ? "mean of {} renders, frames {}\n" : "{} parts joined, frames {}\n";
  const std::string text = fmt::format(fmt::runtime(done), result.parts.size(), result.frames);
  arguments.json.print(text, [&] {
    const nlohmann::ordered_json json{
        {"parts", result.parts}, {"frames", result.frames}, {"warnings", with_flags(result.warnings)}};
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  });
  return exit_done;
}

}  // namespace

Command add_merge_command(CLI::App& app, const Invocation& invocation) {
  auto arguments = std::make_shared<MergeArguments>();
  app.add_option(
         "input", arguments->inputs,
         "The folder that parts were rendered into or, where those of several sequences are there, the pictures "
         "of one, as out/frame.####.exr; with --mean, renders of one job with different seeds: frame.####.exr "
         "of each")
      ->required()
      ->type_name("INPUT");
  app.add_flag("--mean", arguments->mean,
               "Writes the mean of renders, weighted by the samples of each pixel; a mean can be one of them");
  app.add_option("-o,--output", arguments->output, "Of --mean: the pictures, mean.####.exr")->type_name("FILE");
  app.add_flag("--resume", arguments->resume,
               "Of --mean: adds to the pictures that are there the renders that are not in them yet");
  app.add_flag("--allow-missing", arguments->allow_missing,
               "Joins the good frames although others are missing, or their files bad");
  app.add_flag("--trust-files", arguments->trust_files, "Does not compare the files of the parts with their records");
  app.add_option("--threads", arguments->threads, "For comparing files; 0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces timing, record and pictures");
  add_json_option(app, arguments->json);
  return {[arguments, line = invocation.arguments] { return run_merge(*arguments, line); }, {}};
}

}  // namespace gazetrace
