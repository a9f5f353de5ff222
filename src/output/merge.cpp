// SPDX-License-Identifier: Apache-2.0
// Joins the tables and records of a sequence that was rendered in parts.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

struct Part {
  std::string timing_path;
  RunRecord record;
  std::map<std::int32_t, TimingRow> rows;
};

bool is_part_name(const std::string& name) {
  return name.starts_with("timing.") && name.ends_with(".csv") && name != "timing.csv";
}

Part read_part(const std::filesystem::path& timing) {
  Part part;
  part.timing_path = timing.string();
  const std::string name = timing.filename().string();
  const std::string middle = name.substr(7, name.size() - 7 - 4);
  const std::string record_path = (timing.parent_path() / ("run." + middle + ".json")).string();
  if (!std::filesystem::exists(record_path)) {
    throw Error(ErrorKind::input, part.timing_path, "its run record " + record_path + " is missing",
                "finish or remove this part");
  }
  part.record = read_run_record(record_path);
  for (TimingRow& row : read_timing_csv(part.timing_path)) {
    part.rows.insert_or_assign(row.frame, std::move(row));  // a resumed run may have written a frame twice
  }
  return part;
}

std::vector<Part> read_parts(const std::string& directory) {
  std::error_code error;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    if (is_part_name(entry.path().filename().string())) {
      paths.push_back(entry.path());
    }
  }
  if (error) {
    throw Error(ErrorKind::input, directory, "cannot be listed: " + error.message());
  }
  if (paths.empty()) {
    throw Error(ErrorKind::input, directory, "holds no parts of a run (timing.<frames>.csv)",
                "give the folder that the parts were rendered into");
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Part> parts;
  for (const auto& path : paths) {
    parts.push_back(read_part(path));
  }
  return parts;
}

void check_same_settings(const std::vector<Part>& parts) {
  const Part& first = parts.front();
  for (const Part& part : parts) {
    if (part.record.settings_digest != first.record.settings_digest) {
      throw Error(ErrorKind::input, part.timing_path, "was rendered with other settings than " + first.timing_path,
                  "keep parts of one job in a folder");
    }
    for (const auto& [path, digest] : part.record.input_digests) {
      const auto other = first.record.input_digests.find(path);
      if (other != first.record.input_digests.end() && other->second != digest) {
        throw Error(ErrorKind::input, part.timing_path,
                    "was rendered from another version of " + path + " than " + first.timing_path,
                    "render the older part again");
      }
    }
  }
}

std::vector<std::int32_t> frames_of(const std::map<std::int32_t, const Part*>& owners) {
  std::vector<std::int32_t> frames;
  for (const auto& [frame, part] : owners) {
    frames.push_back(frame);
  }
  return frames;
}

// Frames that a part promised and did not deliver, and holes between the frames of all parts: the step of the whole is
// the smallest distance between neighbours.
std::vector<std::int32_t> missing_frames(const std::vector<Part>& parts,
                                         const std::map<std::int32_t, const Part*>& owners) {
  std::set<std::int32_t> missing;
  for (const Part& part : parts) {
    for (const std::int32_t frame : parse_frame_list(part.record.frames)) {
      if (!owners.contains(frame)) {
        missing.insert(frame);
      }
    }
  }
  std::set<std::int32_t> known = missing;
  for (const auto& [frame, part] : owners) {
    known.insert(frame);
  }
  std::int32_t step = std::numeric_limits<std::int32_t>::max();
  const std::vector<std::int32_t> sorted(known.begin(), known.end());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    step = std::min(step, sorted[i] - sorted[i - 1]);
  }
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    for (std::int64_t frame = std::int64_t{sorted[i - 1]} + step; frame < sorted[i]; frame += step) {
      missing.insert(static_cast<std::int32_t>(frame));
    }
  }
  return {missing.begin(), missing.end()};
}

void append_new(Warnings& to, const Warnings& from) {
  for (const std::string& text : from) {
    if (std::find(to.begin(), to.end(), text) == to.end()) {
      to.push_back(text);
    }
  }
}

RunRecord join_records(const std::vector<Part>& parts, const std::string& frames, Warnings& warnings) {
  RunRecord whole = parts.front().record;
  whole.is_part = false;
  whole.frames = frames;
  whole.facts.clear();
  whole.warnings.clear();
  whole.bad_samples.clear();
  for (const Part& part : parts) {
    const RunRecord& record = part.record;
    append_new(whole.warnings, record.warnings);
    whole.bad_samples.insert(whole.bad_samples.end(), record.bad_samples.begin(), record.bad_samples.end());
    whole.input_digests.insert(record.input_digests.begin(), record.input_digests.end());
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
      const bool shared = std::all_of(parts.begin(), parts.end(), [&, k = key, v = value](const Part& other) {
        const auto it = other.record.facts.find(k);
        return it != other.record.facts.end() && it->second == v;
      });
      whole.facts[shared ? key : fmt::format("{} of {}", key, record.frames)] = value;
    }
  }
  append_new(whole.warnings, warnings);
  std::stable_sort(whole.bad_samples.begin(), whole.bad_samples.end(),
                   [](const BadSample& a, const BadSample& b) { return a.frame < b.frame; });
  return whole;
}

}  // namespace

MergeResult merge_runs(const std::string& directory, bool allow_missing, bool overwrite) {
  const std::string timing_path = timing_file_name(directory, "", false);
  const std::string record_path = run_record_file_name(directory, "", false);
  for (const std::string& path : {timing_path, record_path}) {
    if (!overwrite && std::filesystem::exists(path)) {
      throw Error(ErrorKind::usage, path, "exists already", "give --overwrite to replace it");
    }
  }
  const std::vector<Part> parts = read_parts(directory);
  check_same_settings(parts);

  std::map<std::int32_t, const Part*> owners;
  std::vector<TimingRow> rows;
  for (const Part& part : parts) {
    for (const auto& [frame, row] : part.rows) {
      const auto [it, inserted] = owners.emplace(frame, &part);
      if (!inserted) {
        throw Error(ErrorKind::input, part.timing_path,
                    fmt::format("frame {} is in {} as well", frame, it->second->timing_path),
                    "remove one of the parts");
      }
      rows.push_back(row);
    }
  }
  std::sort(rows.begin(), rows.end(), [](const TimingRow& a, const TimingRow& b) { return a.frame < b.frame; });

  MergeResult result;
  const std::vector<std::int32_t> missing = missing_frames(parts, owners);
  if (!missing.empty()) {
    const std::string problem = "frames are missing: " + format_frame_list(missing);
    if (!allow_missing) {
      throw Error(ErrorKind::input, directory, problem, "render them, or give --allow-missing");
    }
    result.warnings.push_back(problem);
  }
  for (const Part& part : parts) {
    result.parts.push_back(part.timing_path);
  }
  result.frames = format_frame_list(frames_of(owners));
  const RunRecord record = join_records(parts, result.frames, result.warnings);
  write_text_atomically(timing_path, timing_csv_text(rows));
  write_text_atomically(record_path, run_record_json(record));
  return result;
}

}  // namespace gazetrace
