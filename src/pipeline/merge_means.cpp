// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/merge_means.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <system_error>

#include "core/file_digest.hpp"
#include "core/text.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output_lock.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/version.hpp"
#include "output/exr_mean.hpp"
#include "output/written_file.hpp"
#include "pipeline/frame_files.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

bool is_there(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

OutputSettings output_of(const std::string& pattern) {
  OutputSettings output;
  output.exr.pattern = pattern;
  output.run_name = run_name_of(pattern);
  return output;
}

struct FrameMean {
  std::vector<std::string> inputs;
  std::string path;
  std::int32_t frame = 0;    // as the pictures state it
  bool is_finished = false;  // there is nothing to add to the mean that is there
};

std::vector<std::int32_t> find_frames_if_any(const std::string& pattern) {
  try {
    return find_frames(pattern);
  } catch (const Error&) {
    return {};
  }
}

// By the numbers in the names; of a single picture 0.
std::map<std::int32_t, FrameMean> frames_of(const MeanSettings& settings, Warnings& warnings) {
  std::map<std::int32_t, FrameMean> frames;
  if (settings.resume) {
    // All of a mean goes on, so that its frames stay alike.
    for (const std::int32_t frame : find_frames_if_any(settings.output)) {
      frames[frame].path = frame_file_name(settings.output, frame);
    }
  }
  for (const std::string& pattern : settings.renders) {
    for (const std::int32_t frame : find_frames(pattern)) {
      FrameMean& mean = frames[frame];
      mean.inputs.push_back(frame_file_name(pattern, frame));
      mean.path = frame_file_name(settings.output, frame, has_frame_number(pattern));
    }
  }
  std::vector<std::int32_t> missing;
  for (const auto& [number, mean] : frames) {
    if (mean.inputs.size() < settings.renders.size()) {
      missing.push_back(number);
    }
  }
  if (!missing.empty()) {
    const std::string problem = "some of the renders lack frames " + format_frame_list(missing);
    if (!settings.allow_missing) {
      throw Error(ErrorKind::input, "", problem, "render them, or give `allow-missing`");
    }
    warnings.push_back(problem);
  }
  return frames;
}

// Of two runs that add to the same means at once, one would lose what it adds.
OutputLock lock_means(const std::string& pattern, const std::map<std::int32_t, FrameMean>& frames, Warnings& warnings) {
  PipelineSettings settings;
  settings.output = output_of(pattern);
  std::vector<std::int32_t> numbers;
  for (const auto& [number, mean] : frames) {
    numbers.push_back(number);
  }
  OutputLock lock = lock_outputs(settings, numbers);
  warnings.insert(warnings.end(), lock.warnings().begin(), lock.warnings().end());
  return lock;
}

// Everything that the headers tell before a pixel is read. With `resume` the mean that is there becomes the first of
// the inputs, and those that are behind it already are left out.
void check_frame(const MeanSettings& settings, FrameMean& mean) {
  std::vector<std::string> taken;
  std::vector<MeanStamp> stamps;
  const bool goes_on = settings.resume && is_there(mean.path);
  if (goes_on) {
    taken.push_back(mean.path);
    stamps.push_back(read_mean_stamp(mean.path));
    if (!stamps.front().is_mean) {
      throw Error(ErrorKind::usage, mean.path, "is a render, which no mean takes the place of", "name another output");
    }
  }
  for (const std::string& path : mean.inputs) {
    const MeanStamp stamp = read_mean_stamp(path);
    const auto is_behind = [&](const auto& seed) { return stamps.front().seeds.contains(seed.first); };
    if (goes_on && stamps.front().mean_digest == stamp.mean_digest &&
        std::all_of(stamp.seeds.begin(), stamp.seeds.end(), is_behind)) {
      continue;
    }
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      check_mean(stamps[i], taken[i], stamp, path);
    }
    taken.push_back(path);
    stamps.push_back(stamp);
  }
  mean.frame = stamps.front().frame;
  mean.is_finished = goes_on && taken.size() == 1;
  mean.inputs = std::move(taken);
}

// The record of the first render that has one which is of its pictures; of a mean that goes on, its own. Error(input)
// where others are of another denoiser.
std::optional<RunRecord> record_of(const MeanSettings& settings, std::int32_t frame) {
  std::optional<RunRecord> first;
  std::string first_path;
  const auto take = [&](const std::string& path, RunRecord record) {
    if (first) {
      check_same_denoiser(*first, first_path, record, path);
    } else {
      first = std::move(record);
      first_path = path;
    }
  };
  const std::string own = run_record_file_name(run_name_of(settings.output), "", false);
  if (settings.resume && is_there(own)) {
    take(own, read_run_record(own));
  }
  for (const std::string& pattern : settings.renders) {
    const std::string path = run_record_file_name(run_name_of(pattern), "", false);
    const std::string picture = frame_file_name(pattern, frame);
    if (!is_there(path) || !is_there(picture)) {
      continue;
    }
    RunRecord record = read_run_record(path);
    const std::string digest = read_settings_digest(picture);
    const auto& parts = record.part_digests;
    if (record.settings_digest == digest || std::find(parts.begin(), parts.end(), digest) != parts.end()) {
      take(path, std::move(record));
    }
  }
  return first;
}

// A mean has the name of its sequence for its record, and a render beside it may have the same.
void check_record(const MeanSettings& settings) {
  const std::string path = run_record_file_name(run_name_of(settings.output), "", false);
  if (is_there(path) && !read_run_record(path).facts.contains("mean_of")) {
    throw Error(ErrorKind::usage, path, "is the record of a render, and would be replaced by that of the mean",
                "name another output");
  }
}

void write_record(RunRecord record, const MeanSettings& settings, const MergeResult& result,
                  const std::vector<std::string>& digests, WrittenFiles files) {
  record.version = kVersion;
  record.build = build_description();
  record.instruction_set = instruction_set();
  record.command_line = settings.command_line;
  record.settings_digest = digests.front();
  record.part_digests = digests;
  record.frames = result.frames;
  record.is_part = false;
  record.chunk_file.clear();
  std::string& mean_of = record.facts["mean_of"];
  mean_of = settings.resume ? mean_of : std::string();
  for (const std::string& pattern : settings.renders) {
    if ((", " + mean_of + ", ").find(", " + pattern + ", ") == std::string::npos) {
      mean_of += (mean_of.empty() ? "" : ", ") + pattern;
    }
  }
  record.warnings.insert(record.warnings.end(), result.warnings.begin(), result.warnings.end());
  record.files = std::move(files);
  write_text_atomically(run_record_file_name(run_name_of(settings.output), "", false), run_record_json(record));
}

}  // namespace

MergeResult merge_means(const MeanSettings& settings) {
  if (!settings.output.ends_with(".exr")) {
    throw Error(ErrorKind::usage, settings.output, "a mean is a linear picture", "end its name in .exr");
  }
  MergeResult result;
  std::map<std::int32_t, FrameMean> frames = frames_of(settings, result.warnings);
  std::vector<std::string> outputs;
  for (const auto& [number, mean] : frames) {
    outputs.push_back(mean.path);
  }
  check_outputs(outputs, settings.renders, settings.overwrite || settings.resume,
                "give `resume` to add to it, or `overwrite`");
  const OutputLock lock = lock_means(settings.output, frames, result.warnings);
  std::vector<std::int32_t> numbers;
  std::size_t most = 0;
  for (auto& [number, mean] : frames) {
    check_frame(settings, mean);
    numbers.push_back(mean.frame);
    most = std::max(most, mean.inputs.size());
  }
  check_record(settings);
  if (most < 2 && !settings.resume) {
    throw Error(ErrorKind::usage, "", "a mean is of two renders or more", "name renders with different seeds");
  }
  const std::optional<RunRecord> record = record_of(settings, frames.begin()->first);
  WrittenFiles files;
  std::vector<std::string> digests;
  for (const auto& [number, mean] : frames) {
    WrittenMean written;
    if (mean.is_finished) {
      const std::string bytes = read_file_bytes(mean.path);
      written = {read_settings_digest(mean.path),
                 {mean.frame, bytes.size(), digest_bytes(std::as_bytes(std::span(bytes)))}};
    } else {
      written = write_mean_exr(mean.inputs, mean.path);
    }
    files[name_in_record(folder_of_frames(settings.output), mean.path)] = written.file;
    if (std::find(digests.begin(), digests.end(), written.settings_digest) == digests.end()) {
      digests.push_back(written.settings_digest);
    }
  }
  result.parts = settings.renders;
  result.frames = format_frame_list(numbers);
  if (record) {
    write_record(*record, settings, result, digests, std::move(files));
  } else {
    result.warnings.push_back("no record of the renders was found beside their pictures, so that the mean has none");
  }
  return result;
}

}  // namespace gazetrace
