// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct MergeArguments {
  std::string directory;
  bool allow_missing = false;
  bool overwrite = false;
};

std::vector<std::int32_t> frames_of(const std::vector<RunPart>& parts) {
  std::set<std::int32_t> frames;
  for (const RunPart& part : parts) {
    const std::vector<std::int32_t> listed = parse_frame_list(part.record.frames);
    frames.insert(listed.begin(), listed.end());
  }
  return {frames.begin(), frames.end()};
}

// The settings of the parts, as their records keep them, over the same files.
MergeResult run_merge_samples(const std::vector<RunPart>& parts, const MergeArguments& arguments) {
  const RunPart& first = parts.front();
  Job job = job_of_record(first.record, first.timing_path);
  job.settings.frames = FrameList{frames_of(parts)};
  job.settings.trace.samples.reset();
  job.settings.part = job.settings.resume = false;
  job.settings.overwrite = arguments.overwrite;
  check_job(job);
  const ColorPipeline color(job.settings.color);
  ResolveOptions resolving;
  resolving.scope = ResolveScope::digests;
  const ResolvedJob resolved = resolve(job, resolving);
  if (resolved.pipeline.settings_digest != first.record.settings_digest) {
    throw Error(ErrorKind::input, first.timing_path, "was rendered from other files, or by another version",
                "start the merge where the parts were started, with the same files in place");
  }
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
