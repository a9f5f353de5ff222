// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/recorded_run.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::vector<std::int32_t> frames_of(const std::vector<RunPart>& parts) {
  std::set<std::int32_t> frames;
  for (const RunPart& part : parts) {
    const std::vector<std::int32_t> listed = parse_frame_list(part.record.frames);
    frames.insert(listed.begin(), listed.end());
  }
  return {frames.begin(), frames.end()};
}

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

}  // namespace

std::optional<RecordedRun> find_recorded_run(const std::string& pattern, const std::string& settings_digest) {
  const std::string path = (fs::path(folder_of_frames(pattern)) / "run.json").string();
  if (!fs::is_regular_file(path)) {
    return std::nullopt;
  }
  const RunRecord record = read_run_record(path);
  const auto& parts = record.part_digests;
  if (record.settings_digest != settings_digest &&
      std::find(parts.begin(), parts.end(), settings_digest) == parts.end()) {
    return std::nullopt;
  }
  const auto view = record.facts.find("view");
  return RecordedRun{resolve_for_viewing(job_of_record(record, path)),
                     view == record.facts.end() ? std::string() : view->second};
}

ResolvedJob resolve_whole_of_parts(const std::vector<RunPart>& parts, bool overwrite) {
  const RunPart& first = parts.front();
  Job job = job_of_record(first.record, first.timing_path);
  job.settings.frames = FrameList{frames_of(parts)};
  job.settings.trace.samples.reset();
  job.settings.part = job.settings.resume = false;
  job.settings.chunk.reset();
  job.settings.chunk_frames = 0;
  job.settings.overwrite = overwrite;
  ResolveOptions options;
  options.scope = ResolveScope::digests;
  ResolvedJob resolved = resolve(job, options);
  if (resolved.pipeline.settings_digest != first.record.settings_digest) {
    throw Error(ErrorKind::input, first.timing_path, "was rendered from other files, or by another version",
                "start the merge where the parts were started, with the same files in place");
  }
  return resolved;
}

}  // namespace gazetrace
