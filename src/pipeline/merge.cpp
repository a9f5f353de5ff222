// SPDX-License-Identifier: Apache-2.0
// Joins the tables and records of a sequence that was rendered in parts.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "gazetrace/output.hpp"
#include "gazetrace/output_lock.hpp"

namespace gazetrace {
namespace {

// Which part has made which frame.
using FrameOwners = std::map<std::int32_t, const RunPart*>;

std::vector<std::int32_t> frames_of(const FrameOwners& owners) {
  std::vector<std::int32_t> frames;
  for (const auto& [frame, part] : owners) {
    frames.push_back(frame);
  }
  return frames;
}

// Those of chunks of which no task has begun are known from what the first task wrote down. Without that, nobody knows
// whether the last chunks are there.
void add_divided_frames(const std::vector<RunPart>& parts, bool allow_missing, std::set<std::int32_t>& frames,
                        Warnings& warnings) {
  std::set<std::string> files;
  for (const RunPart& part : parts) {
    if (!part.record.chunk_file.empty()) {
      files.insert((std::filesystem::path(part.record_path).parent_path() / part.record.chunk_file).string());
    }
  }
  for (const std::string& path : files) {
    if (std::filesystem::exists(path)) {
      const std::vector<std::int32_t> all = parse_frame_list(read_chunk_file(path).frames);
      frames.insert(all.begin(), all.end());
      continue;
    }
    const char* const problem = "is gone, which says how the frames were divided; chunks may be missing";
    if (!allow_missing) {
      throw Error(ErrorKind::input, path, problem,
                  "start one of the chunks again with `resume`, which writes it down, or give `allow-missing`");
    }
    warnings.push_back(path + ": " + problem);
  }
}

// Frames that a part lists but did not render, frames of chunks that never began, and gaps between the frames of all
// parts, where the step of the sequence is the smallest distance between neighbours.
std::vector<std::int32_t> missing_frames(const std::vector<RunPart>& parts, const FrameOwners& owners,
                                         bool allow_missing, Warnings& warnings) {
  std::set<std::int32_t> missing;
  add_divided_frames(parts, allow_missing, missing, warnings);
  for (const RunPart& part : parts) {
    const std::vector<std::int32_t> listed = parse_frame_list(part.record.frames);
    missing.insert(listed.begin(), listed.end());
  }
  std::erase_if(missing, [&](std::int32_t frame) { return owners.contains(frame); });
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

// Frames of which a file is bad count as missing.
void leave_out(const std::vector<BadFile>& bad, std::vector<RunPart>& parts, Warnings& warnings) {
  for (const BadFile& file : bad) {
    warnings.push_back(fmt::format("{} {}; frame {} is left out", file.path, file.problem, file.frame));
    for (RunPart& part : parts) {
      part.rows.erase(file.frame);
      std::erase_if(part.record.files, [&](const auto& entry) { return entry.second.frame == file.frame; });
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

// The record of the whole run. Where the parts differ, the record lists what each says, or a warning is added.
RunRecord join_records(const std::vector<RunPart>& parts, const std::string& frames, Warnings& warnings) {
  RunRecord whole = parts.front().record;
  whole.is_part = false;
  whole.chunk_file.clear();
  whole.frames = frames;
  whole.facts.clear();
  whole.warnings.clear();
  whole.bad_samples.clear();
  whole.input_digests.clear();
  whole.files.clear();
  for (const RunPart& part : parts) {
    const RunRecord& record = part.record;
    append_new(whole.warnings, record.warnings);
    whole.files.insert(record.files.begin(), record.files.end());
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
    check_same_denoiser(whole, parts.front().record_path, record, part.record_path);
    for (const auto& [key, value] : record.facts) {
      const bool shared = std::all_of(parts.begin(), parts.end(), [&, k = key, v = value](const RunPart& other) {
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

MergeResult merge_runs(const std::string& where, const MergeOptions& options) {
  std::vector<RunPart> parts = read_run_parts(where);
  const std::string directory = folder_of_run(parts.front().run_name);
  const std::string timing_path = timing_file_name(parts.front().run_name, "", false);
  const std::string record_path = run_record_file_name(parts.front().run_name, "", false);
  const OutputLock lock = lock_files({{directory, {timing_path, record_path}}});
  check_outputs({timing_path, record_path}, {}, options.overwrite);
  MergeResult result;
  result.warnings = lock.warnings();
  if (!options.trust_files) {
    const std::vector<BadFile> bad = find_bad_files(parts, options.threads);
    if (!options.allow_missing) {
      refuse_bad_files(directory, bad);
    }
    leave_out(bad, parts, result.warnings);
  }

  FrameOwners owners;
  std::vector<TimingRow> rows;
  for (const RunPart& part : parts) {
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

  const std::vector<std::int32_t> missing = missing_frames(parts, owners, options.allow_missing, result.warnings);
  if (!missing.empty()) {
    const std::string problem = "frames are missing: " + format_frame_list(missing);
    if (!options.allow_missing) {
      throw Error(ErrorKind::input, directory, problem, "render them, or give `allow-missing`");
    }
    result.warnings.push_back(problem);
  }
  if (owners.empty()) {
    throw Error(ErrorKind::input, directory, "no frame is left to join", "render the parts again");
  }
  for (const RunPart& part : parts) {
    result.parts.push_back(part.timing_path);
  }
  result.frames = format_frame_list(frames_of(owners));
  const RunRecord record = join_records(parts, result.frames, result.warnings);
  write_text_atomically(timing_path, timing_csv_text(rows));
  write_text_atomically(record_path, run_record_json(record));
  return result;
}

}  // namespace gazetrace
