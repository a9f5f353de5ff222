// SPDX-License-Identifier: Apache-2.0
// Reads what the runs over parts left in a directory, and joins their records.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "core/list_folder.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

bool is_part_name(const std::string& name) {
  return name.starts_with("timing.") && name.ends_with(".csv") && name != "timing.csv";
}

RunPart read_part(const std::filesystem::path& timing) {
  RunPart part;
  part.timing_path = timing.string();
  const std::string name = timing.filename().string();
  const std::string middle = name.substr(7, name.size() - 7 - 4);
  const std::string record_path = (timing.parent_path() / ("run." + middle + ".json")).string();
  std::error_code ignored;
  if (!std::filesystem::exists(record_path, ignored)) {
    throw Error(ErrorKind::input, part.timing_path, "its run record " + record_path + " is missing",
                "finish or remove this part");
  }
  part.record_path = record_path;
  part.record = read_run_record(record_path);
  for (const auto& [listed, file] : read_file_journal(file_journal_name(record_path))) {
    part.record.files.insert_or_assign(listed, file);
  }
  for (TimingRow& row : read_timing_csv(part.timing_path)) {
    part.rows.insert_or_assign(row.frame, std::move(row));  // a resumed run may have written a frame twice
  }
  return part;
}

// Parts whose frames depend on those before them have different digests, but share the digest of everything else.
bool of_one_job(const RunRecord& a, const RunRecord& b) {
  const bool shared = !a.history.settings_digest.empty() && !b.history.settings_digest.empty();
  return shared ? a.history.settings_digest == b.history.settings_digest : a.settings_digest == b.settings_digest;
}

void check_same_settings(const std::vector<RunPart>& parts) {
  const RunPart& first = parts.front();
  for (const RunPart& part : parts) {
    if (!of_one_job(part.record, first.record)) {
      throw Error(ErrorKind::input, part.timing_path, "was rendered with other settings than " + first.timing_path,
                  "keep parts of one job in a folder");
    }
    for (const auto& [path, digest] : part.record.input_digests) {
      const auto other = first.record.input_digests.find(path);
      if (path == part.record.history.checkpoint || path == first.record.history.checkpoint) {
        continue;  // successive runs may pass the history on in one file
      }
      if (other != first.record.input_digests.end() && other->second != digest) {
        throw Error(ErrorKind::input, part.timing_path,
                    "was rendered from another version of " + path + " than " + first.timing_path,
                    "render the older part again");
      }
    }
  }
}

void append_new(Warnings& to, const Warnings& from) {
  for (const std::string& text : from) {
    if (std::find(to.begin(), to.end(), text) == to.end()) {
      to.push_back(text);
    }
  }
}

}  // namespace

std::vector<RunPart> read_run_parts(const std::string& directory) {
  std::vector<std::filesystem::path> paths, without_rows;
  for (const std::filesystem::path& path : list_folder(directory)) {
    const std::string name = path.filename().string();
    if (is_part_name(name)) {
      paths.push_back(path);
    } else if (name.starts_with("run.") && name.ends_with(".json") && name != "run.json") {
      // The record of a part that was ended before its table began is all that tells of its frames.
      const auto timing = path.parent_path() / ("timing." + name.substr(4, name.size() - 4 - 5) + ".csv");
      std::error_code ignored;
      if (!std::filesystem::exists(timing, ignored)) {
        without_rows.push_back(path);
      }
    }
  }
  if (paths.empty()) {
    throw Error(ErrorKind::input, directory, "contains no parts of a run (timing.<part>.csv)",
                "give the folder that the parts were rendered into");
  }
  std::vector<RunPart> parts;
  for (const auto& path : paths) {
    parts.push_back(read_part(path));
  }
  for (const auto& path : without_rows) {
    const std::string name = path.filename().string();
    RunPart& part = parts.emplace_back();
    part.record_path = path.string();
    part.timing_path = (path.parent_path() / ("timing." + name.substr(4, name.size() - 4 - 5) + ".csv")).string();
    part.record = read_run_record(part.record_path);
  }
  check_same_settings(parts);
  return parts;
}

RunRecord join_records(const std::vector<RunPart>& parts, const std::string& frames, Warnings& warnings) {
  RunRecord whole = parts.front().record;
  whole.is_part = false;
  whole.chunk_file.clear();
  whole.frames = frames;
  whole.facts.clear();
  whole.warnings.clear();
  whole.bad_samples.clear();
  whole.part_digests.clear();
  whole.input_digests.clear();
  whole.files.clear();
  for (const RunPart& part : parts) {
    const RunRecord& record = part.record;
    append_new(whole.warnings, record.warnings);
    whole.part_digests.push_back(record.settings_digest);
    whole.files.insert(record.files.begin(), record.files.end());
    whole.bad_samples.insert(whole.bad_samples.end(), record.bad_samples.begin(), record.bad_samples.end());
    for (const auto& [path, digest] : record.input_digests) {
      if (path != record.history.checkpoint) {
        whole.input_digests.emplace(path, digest);
      }
    }
    const auto same = [&](const char* what, const std::string& a, const std::string& b) {
      if (a != b) {
        append_new(warnings, {fmt::format("parts differ in {}: '{}' and '{}'", what, a, b)});
      }
    };
    same("version", whole.version, record.version);
    same("build", whole.build, record.build);
    same("instruction set", whole.instruction_set, record.instruction_set);
    same("ray library", whole.ray_library, record.ray_library);
    for (const auto& [key, value] : record.facts) {
      const bool shared = std::all_of(parts.begin(), parts.end(), [&, k = key, v = value](const RunPart& other) {
        const auto it = other.record.facts.find(k);
        return it != other.record.facts.end() && it->second == v;
      });
      whole.facts[shared ? key : fmt::format("{} of {}", key, record.frames)] = value;
    }
  }
  append_new(whole.warnings, warnings);
  const std::vector<std::string>& digests = whole.part_digests;
  if (std::all_of(digests.begin(), digests.end(), [&](const std::string& d) { return d == digests.front(); })) {
    whole.part_digests.clear();
  }
  std::stable_sort(whole.bad_samples.begin(), whole.bad_samples.end(),
                   [](const BadSample& a, const BadSample& b) { return a.frame < b.frame; });
  return whole;
}

}  // namespace gazetrace
