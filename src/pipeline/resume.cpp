// SPDX-License-Identifier: Apache-2.0
#include "pipeline/resume.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/finished_frames.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"

namespace gazetrace {
namespace {

bool writes_pictures(const OutputSettings& output) {
  return !output.exr.pattern.empty() || !output.display.pattern.empty();
}

// Reads the rows of the run so far; whether there is a table that can be read.
bool read_rows(const std::string& path, ResumePlan& resume) {
  std::error_code missing;
  if (std::filesystem::file_size(path, missing) == 0 || missing) {
    return false;
  }
  try {
    resume.kept_rows = read_earlier_rows(path);
    return true;
  } catch (const Error& error) {
    resume.warnings.push_back(bounded(error.what(), 300) + "; it is made anew");
    return false;
  }
}

// Finds the complete frames, and drops the rows of the others. Returns which complete ones have no row.
std::vector<std::size_t> find_finished(const FramePlan& plan, const FinishedFrames& finished, ResumePlan& resume) {
  std::vector<std::size_t> without_row;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const std::int32_t frame = plan.frames[i].frame;
    if (!finished.is_complete(frame)) {
      resume.kept_rows.erase(frame);
      continue;
    }
    resume.is_done[i] = true;
    if (!resume.kept_rows.contains(frame)) {
      without_row.push_back(i);
    }
  }
  return without_row;
}

// The row of a complete frame that has lost its own.
TimingRow row_made_anew(const FrameRequest& request, const PipelineSettings& settings) {
  const OutputSettings& output = settings.output;
  const std::string& pattern = output.exr.pattern.empty() ? output.display.pattern : output.exr.pattern;
  return lost_timing_row(request, read_frame_stamp(frame_file_name(pattern, request.frame)).exposure_ev);
}

}  // namespace

ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const RunPaths& paths) {
  ResumePlan resume;
  resume.is_done.assign(plan.frames.size(), false);
  if (!settings.output.resume || !writes_pictures(settings.output)) {
    return resume;
  }
  // Every file that is not of ours has an empty digest, too.
  if (settings.settings_digest.empty()) {
    throw Error(ErrorKind::usage, "`resume`", "no settings digest tells frames of these settings from others",
                "resolve the job, or set PipelineSettings::settings_digest");
  }
  const bool has_rows = read_rows(paths.timing, resume);
  const WrittenFiles known = read_earlier_files(paths.record);
  const FinishedFrames finished(settings, known);
  std::vector<std::size_t> without_row = find_finished(plan, finished, resume);
  // A run that was killed between the last file and its row renders that frame once more, so that its times do not stay
  // unknown. More rows than one are lost by damage alone, and then their frames are not.
  if (without_row.size() == 1 && has_rows) {
    resume.is_done[without_row.front()] = false;
    without_row.clear();
  }
  for (const std::size_t i : without_row) {
    resume.kept_rows[plan.frames[i].frame] = row_made_anew(plan.frames[i], settings);
  }
  if (!without_row.empty()) {
    resume.warnings.push_back("complete frames without a row in " + paths.timing + ": " +
                              std::to_string(without_row.size()) +
                              "; they are kept, and rows are made anew without times");
  }
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    if (resume.is_done[i]) {
      finished.add_files(plan.frames[i].frame, resume.kept_files);
    }
  }
  return resume;
}

}  // namespace gazetrace
