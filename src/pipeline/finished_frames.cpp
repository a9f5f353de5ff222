// SPDX-License-Identifier: Apache-2.0
#include "pipeline/finished_frames.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>

#include "core/file_digest.hpp"
#include "core/png_file.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "output/exr_seal.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Whether a picture is as it was written, by what is in it: the seal of an EXR, the checksums of a PNG. Of other kinds
// nothing tells that.
bool is_whole_picture(const std::string& path) {
  if (path.ends_with(".exr")) {
    return has_whole_seal(path);
  }
  try {
    const std::string bytes = read_file_bytes(path);
    const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    return !essential_png({first, bytes.size()}, path).empty();
  } catch (const Error&) {
    return false;
  }
}

// Those of a frame's files that say which settings made them.
std::vector<std::string> stamped_pictures(const OutputSettings& output, std::int32_t frame) {
  std::vector<std::string> paths;
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern}) {
    if (!pattern.empty()) {
      paths.push_back(frame_file_name(pattern, frame));
    }
  }
  return paths;
}

// Whether another run has finished the frame, whose work would be replaced.
bool is_of_others(std::int32_t frame, const PipelineSettings& settings) {
  bool is_other = false;
  for (const std::string& path : stamped_pictures(settings.output, frame)) {
    if (!fs::exists(path)) {
      continue;
    }
    const FrameStamp stamp = read_frame_stamp(path);
    is_other = is_other || (!stamp.settings_digest.empty() && stamp.frame.value_or(frame) == frame &&
                            stamp.settings_digest != settings.settings_digest);
  }
  return is_other;
}

}  // namespace

FinishedFrames::FinishedFrames(const PipelineSettings& settings, const WrittenFiles& known)
    : settings_(settings), known_(known) {
  if (settings.output.trust_files) {
    return;
  }
  for (const BadFile& file :
       find_bad_files(folder_of_run(settings.output.run_name), known, settings.settings_digest, settings.threads)) {
    bad_.insert(file.path);
  }
}

bool FinishedFrames::is_complete(std::int32_t frame) const {
  for (const std::string& path : stamped_pictures(settings_.output, frame)) {
    if (!is_complete_picture(path, frame)) {
      return false;
    }
  }
  if (settings_.output.map_pattern.empty()) {
    return true;
  }
  // A sampling map says nothing of itself; it appears before the frame's other files and only when complete.
  const std::string map = frame_file_name(settings_.output.map_pattern, frame);
  return fs::exists(map) && is_as_written(map) && vouches(map);
}

bool FinishedFrames::is_complete_picture(const std::string& path, std::int32_t frame) const {
  if (!fs::exists(path) || !is_as_written(path)) {
    return false;
  }
  const FrameStamp stamp = read_frame_stamp(path);
  return stamp.settings_digest == settings_.settings_digest && stamp.frame.value_or(frame) == frame && vouches(path);
}

void FinishedFrames::add_files(std::int32_t frame, WrittenFiles& files) const {
  for (const std::string& path : files_of(frame)) {
    const std::string name = name_in_record(folder_of_run(settings_.output.run_name), path);
    const auto known = known_.find(name);
    files[name] = known != known_.end() ? known->second : WrittenFile{frame, fs::file_size(path), digest_file(path)};
  }
}

std::vector<std::string> FinishedFrames::files_of(std::int32_t frame) const {
  std::vector<std::string> files = output_files(settings_, {frame});
  return {files.begin() + std::min<std::ptrdiff_t>(2, static_cast<std::ptrdiff_t>(files.size())), files.end()};
}

bool FinishedFrames::vouches(const std::string& path) const {
  return settings_.output.trust_files ||
         known_.contains(name_in_record(folder_of_run(settings_.output.run_name), path)) || is_whole_picture(path);
}

bool FinishedFrames::is_as_written(const std::string& path) const {
  return !bad_.contains(path_in_record(folder_of_run(settings_.output.run_name),
                                       name_in_record(folder_of_run(settings_.output.run_name), path)));
}

std::vector<std::int32_t> frames_of_others(const FramePlan& plan, const PipelineSettings& settings) {
  std::vector<std::int32_t> others;
  for (const FrameRequest& request : plan.frames) {
    if (is_of_others(request.frame, settings)) {
      others.push_back(request.frame);
    }
  }
  return others;
}

}  // namespace gazetrace
