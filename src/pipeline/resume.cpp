// SPDX-License-Identifier: Apache-2.0
#include "pipeline/resume.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/sample_sums_file.hpp"
#include "pipeline/timing_log.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

bool files_are_complete(const PipelineSettings& settings, std::int32_t frame) {
  const OutputSettings& output = settings.output;
  const std::string& digest = settings.settings_digest;
  if (settings.trace.samples) {
    return read_samples_digest(samples_file_name(output.run_directory, frame, *settings.trace.samples)) == digest;
  }
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern}) {
    if (!pattern.empty()) {
      const std::string path = frame_file_name(pattern, frame);
      if (!fs::exists(path) || read_settings_digest(path) != digest) {
        return false;
      }
    }
  }
  // A sampling map has no digest of its own; it appears before the frame's other files and only when complete.
  return output.map_pattern.empty() || fs::exists(frame_file_name(output.map_pattern, frame));
}

// Whether the checkpoint that is asked for holds the history after the plan's last frame, under the same settings.
bool checkpoint_is_there(const FramePlan& plan, const PipelineSettings& settings, const TemporalHistory& history) {
  if (!fs::exists(settings.checkpoint)) {
    return false;
  }
  std::vector<std::int32_t> passed = history.passed;
  for (const FrameRequest& request : plan.frames) {
    passed.push_back(request.frame);
  }
  try {
    return load_checkpoint(settings.checkpoint, settings.history_digest).passed == passed;
  } catch (const Error&) {
    return false;  // damaged, or of other settings: it will be replaced
  }
}

}  // namespace

RecordedHistory recorded_history(const FramePlan& plan, const PipelineSettings& settings,
                                 const TemporalHistory& history) {
  RecordedHistory recorded;
  if (!uses_history(settings)) {
    return recorded;
  }
  std::vector<std::int32_t> passed = history.passed;
  for (std::size_t i = 0; i < std::min(static_cast<std::size_t>(settings.preroll), plan.frames.size()); ++i) {
    passed.push_back(plan.frames[i].frame);
  }
  recorded.settings_digest = settings.history_digest;
  recorded.frames = passed.empty() ? std::string() : format_frame_list(passed);
  recorded.checkpoint = settings.resume_from;
  return recorded;
}

ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const std::string& timing_path,
                       const TemporalHistory& history) {
  ResumePlan resume;
  resume.writes_checkpoint = !settings.checkpoint.empty();
  resume.work.assign(plan.frames.size(), FrameWork::render);
  const auto first_wanted = std::min(static_cast<std::size_t>(settings.preroll), plan.frames.size());
  std::fill(resume.work.begin(), resume.work.begin() + static_cast<std::ptrdiff_t>(first_wanted), FrameWork::replay);
  const OutputSettings& output = settings.output;
  if (!output.resume || (output.exr.pattern.empty() && output.display.pattern.empty())) {
    return resume;
  }
  // Every file that is not of ours has an empty digest, too.
  if (settings.settings_digest.empty()) {
    throw Error(ErrorKind::usage, "`resume`", "no settings digest tells frames of these settings from others",
                "resolve the job, or set PipelineSettings::settings_digest");
  }
  const bool has_timing = fs::exists(timing_path);
  resume.kept_rows = read_earlier_rows(timing_path);
  std::size_t last_to_render = plan.frames.size();
  std::size_t without_row = 0;
  for (std::size_t i = first_wanted; i < plan.frames.size(); ++i) {
    const std::int32_t frame = plan.frames[i].frame;
    const bool has_row = resume.kept_rows.contains(frame);
    // A run that was killed between the last file and the row of timing.csv renders the frame once more, so that the
    // row does not stay missing.
    if (files_are_complete(settings, frame) && (has_row || !has_timing)) {
      resume.work[i] = FrameWork::skip;
      without_row += has_row ? 0 : 1;
    } else {
      resume.kept_rows.erase(frame);
      last_to_render = i;
    }
  }
  resume.writes_checkpoint = resume.writes_checkpoint && !checkpoint_is_there(plan, settings, history);
  const std::size_t end = resume.writes_checkpoint               ? plan.frames.size()
                          : last_to_render == plan.frames.size() ? 0
                                                                 : last_to_render + 1;
  if (end == 0) {
    std::fill(resume.work.begin(), resume.work.begin() + static_cast<std::ptrdiff_t>(first_wanted), FrameWork::skip);
  }
  if (uses_history(settings) || resume.writes_checkpoint) {
    for (std::size_t i = 0; i < end; ++i) {
      if (resume.work[i] == FrameWork::skip) {
        resume.work[i] = FrameWork::replay;
      }
    }
  }
  if (without_row > 0) {
    resume.warnings.push_back(std::to_string(without_row) + " complete frames have no row in " + timing_path +
                              "; they are skipped and stay without timing");
  }
  return resume;
}

}  // namespace gazetrace
