// SPDX-License-Identifier: Apache-2.0
// The files that a run writes: their names, their folders, and what must not be in their place.
#include "job/outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

#include "core/atomic_file.hpp"
#include "core/picture_module.hpp"
#include "gazetrace/error.hpp"
#include "job/changed_inputs.hpp"
#include "job/chunks.hpp"
#include "output/aovs.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Stops at the first parent folder that exists, so that a mistyped path is reported before a scene is loaded.
void check_folder(const fs::path& folder) {
  fs::path existing = fs::absolute(folder).lexically_normal();
  std::error_code ignored;
  while (!fs::exists(existing, ignored) && existing.has_relative_path()) {
    existing = existing.parent_path();
  }
  if (!fs::is_directory(existing, ignored)) {
    throw Error(ErrorKind::input, folder.string(), fmt::format("'{}' is not a folder", existing.string()),
                "choose another output folder");
  }
  if (access(existing.c_str(), W_OK | X_OK) != 0) {
    throw Error(ErrorKind::input, folder.string(), fmt::format("'{}' is not writable", existing.string()),
                "choose another output folder");
  }
}

// Permissions are not reliable on network and read-only file systems: only creating a file proves anything.
void prove_writable(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code && !fs::is_directory(folder)) {
    throw Error(ErrorKind::input, folder.string(), "the folder cannot be made: " + code.message(),
                "choose another output folder");
  }
  std::string probe = (folder / ".gazetrace.XXXXXX").string();
  const int file = mkstemp(probe.data());
  if (file < 0) {
    throw Error(ErrorKind::input, folder.string(), std::string("no file can be made in it: ") + std::strerror(errno),
                "choose another output folder");
  }
  close(file);
  unlink(probe.c_str());
}

std::set<fs::path> output_folders(const OutputSettings& output) {
  std::set<fs::path> folders;
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern}) {
    if (!pattern.empty()) {
      folders.insert(folder_of_frames(pattern));
    }
  }
  return folders;
}

// Until the next version: a run of the version before, whose files had the names of no sequence, goes on under the
// names of today.
void take_former_names(const OutputSettings& output, const std::vector<std::string>& files) {
  const std::string folder = folder_of_run(output.run_name) + "/";
  const std::size_t name = fs::path(output.run_name).filename().string().size();
  const auto former = [&](const std::string& path) {
    return folder + fs::path(path).filename().string().substr(name > 0 ? name + 1 : 0);
  };
  std::error_code ignored;
  if (files.size() < 2 || name == 0 || fs::exists(files[0], ignored) || !fs::exists(former(files[0]), ignored)) {
    return;
  }
  WrittenFiles written = read_file_journal(file_journal_name(former(files[0])));
  try {
    written.merge(read_run_record(former(files[0])).files);
  } catch (const Error&) {
    return;
  }
  // Whose record it is: another sequence may have left it there.
  const bool is_ours = std::any_of(files.begin() + 2, files.end(), [&](const std::string& path) {
    return written.contains(fs::path(path).lexically_relative(folder).string());
  });
  if (is_ours) {
    fs::rename(former(files[1]), files[1], ignored);
    fs::rename(file_journal_name(former(files[0])), file_journal_name(files[0]), ignored);
    fs::rename(former(files[0]), files[0], ignored);
  }
}

// A run that goes on must go on with all frames of the run so far.
void check_earlier_run(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  const std::vector<std::string> files = output_files(settings, frames);
  if (files.size() < 2) {
    return;
  }
  const std::string& record_path = files[0];
  std::vector<std::int32_t> before;
  try {
    if (fs::exists(record_path)) {
      before = parse_frame_list(read_run_record(record_path).frames);
    }
  } catch (const Error&) {
    return;  // a damaged record is made anew
  }
  for (const std::int32_t frame : before) {
    if (std::find(frames.begin(), frames.end(), frame) == frames.end()) {
      throw Error(ErrorKind::usage, "`resume`",
                  fmt::format("{} is of a run over frames {}, and frame {} is not asked for now", record_path,
                              format_frame_list(before), frame),
                  "give frames that include those, or another folder");
    }
  }
}

}  // namespace

OutputSettings output_settings(const JobSettings& job) {
  OutputSettings output;
  output.exr = job.exr;
  output.display = job.picture;
  output.map_pattern = job.map_pattern;
  output.overwrite = job.overwrite;
  output.resume = job.resume;
  output.trust_files = job.trust_files;
  for (const std::string& pattern : job.outputs) {
    if (pattern.empty()) {
      throw Error(ErrorKind::usage, "`output`", "the name of a picture is empty",
                  "give a name such as out/frame.####.exr");
    }
    std::string& place = pattern.ends_with(".exr") ? output.exr.pattern : output.display.pattern;
    if (!place.empty()) {
      throw Error(ErrorKind::usage, "`output`", fmt::format("'{}' and '{}' are of one kind", place, pattern),
                  "give one linear picture (.exr) and one display picture (.png .jpg .tif .dpx)");
    }
    place = pattern;
  }
  const std::string& first = !job.outputs.empty() ? job.outputs.front() : job.map_pattern;
  output.run_name = first.empty() ? std::string() : run_name_of(first);
  return output;
}

void check_output_folders(const OutputSettings& output) {
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern}) {
    if (!pattern.empty()) {
      refuse_impossible_file(frame_file_name(pattern, 1, false));
    }
  }
  for (const fs::path& folder : output_folders(output)) {
    check_folder(folder);
  }
}

AccumulateSettings accumulate_of(const JobSettings& job) {
  AccumulateSettings settings = job.accumulate;
  // Times that are meant to be of whole frames may be rounded. No sequence has as many frames as the bound.
  const auto frames_in = [&](const DurationNs& time) {
    const double a_second = static_cast<double>(job.fps.numerator) / static_cast<double>(job.fps.denominator);
    return static_cast<std::int32_t>(
        std::min(std::floor(static_cast<double>(time.ns) * 1e-9 * a_second + 1e-3), 100'000.0));
  };
  const bool joins = settings.mode == AccumulateMode::window;
  settings.past_frames = joins ? frames_in(job.accumulate_past) : 0;
  settings.future_frames = joins ? frames_in(job.accumulate_future) : 0;
  return settings;
}

PipelineSettings pipeline_settings(const JobSettings& job) {
  PipelineSettings settings;
  settings.foveation = job.foveation;
  if (looks_first(job.foveation.sampling) && job.accumulate.mode == AccumulateMode::window &&
      job.foveation.max_block_px == kDefaultMaxBlockPx) {
    // Frames at rest share all their samples only where their sites are the same, and larger blocks follow from each
    // frame's own pilot.
    settings.foveation.max_block_px = 1;
  }
  settings.trace = job.trace;
  settings.trace.only_pixel = job.only_pixel;
  settings.trace.show_environment = !job.exr.alpha;
  settings.trace.guides = show_first_hits(job.exr.aovs);
  settings.layers = layer_settings(job.exr);
  settings.reconstruction = {filter_of(job).name};
  settings.accumulate = accumulate_of(job);
  settings.exposure = job.exposure;
  settings.output = output_settings(job);
  settings.fps = job.fps;
  settings.threads = job.threads;
  settings.is_part = job.chunk.has_value();
  return settings;
}

void make_output_folders(const ResolvedJob& resolved) {
  const PipelineSettings& settings = resolved.pipeline;
  std::vector<std::string> inputs;
  for (const auto& [path, digest] : resolved.input_digests) {
    inputs.push_back(path);
  }
  check_outputs(output_files(settings, resolved.frames), inputs, settings.output.overwrite || settings.output.resume,
                settings.is_part ? "give `overwrite`, `resume` or another name"
                                 : "give `overwrite`, `resume`, `chunk` for a part of a sequence, or another name");
  for (const fs::path& folder : output_folders(settings.output)) {
    prove_writable(folder);
  }
}

void prepare_outputs(const ResolvedJob& resolved) {
  const PipelineSettings& settings = resolved.pipeline;
  const std::vector<std::int32_t>& frames = resolved.frames;
  const std::vector<std::string> files = output_files(settings, frames);
  make_output_folders(resolved);
  if (!settings.output.display.pattern.empty()) {
    picture_module();  // where it is missing, before a frame is traced
  }
  if (settings.output.resume) {
    take_former_names(settings.output, files);
    check_earlier_run(settings, frames);
    if (!settings.output.overwrite && !files.empty()) {
      refuse_to_lose_frames(resolved, files.front());
    }
  }
  write_down(resolved.chunk_borders);
}

}  // namespace gazetrace
