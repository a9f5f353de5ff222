// SPDX-License-Identifier: Apache-2.0
#include "cli/output_locks.hpp"

#include <filesystem>

#include "cli/command.hpp"

namespace gazetrace {
namespace {

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

// What the locks say of the run.
RunRecord claim_of(const ResolvedJob& resolved) {
  RunRecord claim;
  claim.frames = format_frame_list(resolved.frames);
  if (resolved.pipeline.trace.samples) {
    claim.samples = format_value(*resolved.pipeline.trace.samples);
  }
  return claim;
}

}  // namespace

std::vector<std::unique_ptr<RunLock>> lock_outputs(const ResolvedJob& resolved, const std::vector<std::string>& files) {
  if (files.empty()) {
    return {};
  }
  const RunRecord claim = claim_of(resolved);
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

}  // namespace gazetrace
