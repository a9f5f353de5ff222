// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/recorded_run.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/list_folder.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

ResolvedJob resolve_for_viewing(Job job) {
  JobSettings& settings = job.settings;
  if (screen_geometry(settings.screen) || !fs::is_regular_file(settings.gaze.path)) {
    settings.gaze.path.clear();
  }
  ResolveOptions options;
  options.scope = ResolveScope::viewing;
  if (!settings.gaze.path.empty()) {
    try {
      return resolve(job, options);
    } catch (const Error&) {
      settings.gaze.path.clear();  // another file has the log's name today: it says nothing of the screen
    }
  }
  return resolve(job, options);
}

// The records in the folder of the pictures: the one that is named after them, run.json of the version before and,
// since pictures of several names may be written together, those of others.
std::vector<std::string> records_beside(const std::string& pattern) {
  const fs::path folder(folder_of_frames(pattern));
  std::vector<std::string> records;
  const auto add = [&](const fs::path& path) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored) &&
        std::find(records.begin(), records.end(), path.string()) == records.end()) {
      records.push_back(path.string());
    }
  };
  add(run_record_file_name(run_name_of(pattern), "", false));
  add(folder / "run.json");
  std::error_code ignored;
  for (const fs::path& path : list_folder(folder, ignored)) {
    if (path.filename().string().ends_with(".run.json")) {
      add(path);
    }
  }
  return records;
}

}  // namespace

std::optional<RecordedRun> find_recorded_run(const std::string& pattern, const std::string& settings_digest) {
  for (const std::string& path : records_beside(pattern)) {
    RunRecord record;
    try {
      record = read_run_record(path);
    } catch (const Error&) {
      if (path == run_record_file_name(run_name_of(pattern), "", false)) {
        throw;
      }
      continue;  // damaged, and of other pictures by its name
    }
    const auto& parts = record.part_digests;
    if (record.settings_digest != settings_digest &&
        std::find(parts.begin(), parts.end(), settings_digest) == parts.end()) {
      continue;
    }
    const auto view = record.facts.find("view");
    return RecordedRun{resolve_for_viewing(job_of_record(record, path)),
                       view == record.facts.end() ? std::string() : view->second};
  }
  return std::nullopt;
}

}  // namespace gazetrace
