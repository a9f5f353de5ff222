// SPDX-License-Identifier: Apache-2.0
// What became of a run's inputs between it and its resumption.
#include "job/changed_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

using Digests = std::map<std::string, std::string>;

bool holds_content(const Digests& files, const std::string& digest) {
  return std::any_of(files.begin(), files.end(), [&](const auto& file) { return file.second == digest; });
}

// A file that is there under another name is no change.
void add_changed_files(const Digests& before, const Digests& now, std::vector<std::string>& changes) {
  for (const auto& [path, digest] : now) {
    const auto earlier = before.find(path);
    if (earlier == before.end() ? !holds_content(before, digest) : earlier->second != digest) {
      changes.push_back(path + (earlier == before.end() ? " was not read then" : " has changed"));
    }
  }
  for (const auto& [path, digest] : before) {
    if (!now.contains(path) && !holds_content(now, digest)) {
      changes.push_back(path + " is not read any more");
    }
  }
}

std::string text_of(const OptionOf<JobSettings>& option, const JobSettings& job) {
  const std::vector<std::string> values = option.values(job);
  return values.empty() ? "not given" : fmt::format("{}", fmt::join(values, " "));
}

void add_changed_options(const JobSettings& before, const JobSettings& now, std::vector<std::string>& changes) {
  std::error_code ignored;
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    const std::string then = text_of(option, before);
    const std::string given = text_of(option, now);
    const bool is_file = option.decides == Decides::file && std::filesystem::is_regular_file(given, ignored);
    if (option.decides != Decides::nothing && then != given && !is_file) {
      changes.push_back(fmt::format("`{}` was {} and is {}", option.name, bounded(then, 60), bounded(given, 60)));
    }
  }
}

}  // namespace

std::string changed_since(const std::string& record_path, const ResolvedJob& now) {
  std::vector<std::string> changes;
  try {
    const RunRecord before = read_run_record(record_path);
    add_changed_files(before.input_digests, now.input_digests, changes);
    add_changed_options(job_of_record(before, record_path).settings, now.job.settings, changes);
    if (before.version != kVersion) {
      changes.push_back(fmt::format("version {} made them, this is {}", before.version, kVersion));
    }
  } catch (const Error&) {
    changes.clear();
  }
  if (changes.empty()) {
    return "its inputs or settings, of which no record tells more";
  }
  constexpr std::size_t kNamed = 5;
  const std::size_t more = changes.size() - std::min(kNamed, changes.size());
  changes.resize(std::min(kNamed, changes.size()));
  return fmt::format("{}{}", fmt::join(changes, ", "), more == 0 ? "" : fmt::format(", and {} more changes", more));
}

void refuse_to_lose_frames(const ResolvedJob& resolved, const std::string& record_path) {
  const std::vector<std::int32_t> lost = frames_of_others(resolved.plan, resolved.pipeline);
  if (lost.empty()) {
    return;
  }
  throw Error(ErrorKind::usage, record_path,
              fmt::format("`resume` would render over {} finished frame{}, {}, since this has changed: {}", lost.size(),
                          lost.size() == 1 ? "" : "s", format_frame_list(lost), changed_since(record_path, resolved)),
              "put it back, choose another folder, or give `overwrite` with `resume` to lose these frames");
}

}  // namespace gazetrace
