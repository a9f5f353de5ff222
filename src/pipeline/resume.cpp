// SPDX-License-Identifier: Apache-2.0
#include "pipeline/resume.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "gazetrace/checkpoint.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/finished_frames.hpp"
#include "pipeline/sequence_history.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/unfinished_frames.hpp"

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

// Skips the complete ones of the wanted frames, and drops the rows of the others. Returns which complete ones have no
// row.
std::vector<std::size_t> skip_finished(const FramePlan& plan, std::size_t first_wanted, const FinishedFrames& finished,
                                       const std::vector<std::string>& histories, ResumePlan& resume) {
  std::vector<std::size_t> without_row;
  for (std::size_t i = first_wanted; i < plan.frames.size(); ++i) {
    const std::int32_t frame = plan.frames[i].frame;
    if (!finished.is_complete(frame, histories[i])) {
      resume.kept_rows.erase(frame);
      continue;
    }
    resume.work[i] = FrameWork::skip;
    if (!resume.kept_rows.contains(frame)) {
      without_row.push_back(i);
    }
  }
  return without_row;
}

// The row of a complete frame that has lost its own.
TimingRow row_made_anew(const FrameRequest& request, const PipelineSettings& settings) {
  if (leaves_unfinished(settings)) {
    return lost_timing_row(request, std::nullopt);
  }
  const OutputSettings& output = settings.output;
  const std::string& pattern = output.exr.pattern.empty() ? output.display.pattern : output.exr.pattern;
  return lost_timing_row(request, read_frame_stamp(frame_file_name(pattern, request.frame)).exposure_ev);
}

// The checkpoint that is asked for, if it is of these settings; empty where it is missing or damaged.
std::optional<TemporalHistory> earlier_checkpoint(const PipelineSettings& settings) {
  if (settings.checkpoint.empty() || !std::filesystem::exists(settings.checkpoint)) {
    return std::nullopt;
  }
  try {
    return load_checkpoint(settings.checkpoint, settings.settings_digest);
  } catch (const Error&) {
    return std::nullopt;  // it will be replaced
  }
}

// After how many frames of the plan this is the history; 0: after none of them.
std::size_t frames_in(const TemporalHistory& checkpoint, const FramePlan& plan, const TemporalHistory& start) {
  std::vector<std::int32_t> passed = start.passed;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    passed.push_back(plan.frames[i].frame);
    if (passed == checkpoint.passed) {
      return i + 1;
    }
  }
  return 0;
}

// Goes on from the checkpoint of the interrupted run where nothing before it is to be rendered, and finds out whether
// it is still to be written. Returns the first frame whose history is in no file.
std::size_t take_up_checkpoint(const FramePlan& plan, const PipelineSettings& settings, const TemporalHistory& history,
                               std::size_t first_wanted, ResumePlan& resume) {
  std::optional<TemporalHistory> checkpoint = earlier_checkpoint(settings);
  if (!checkpoint) {
    return 0;
  }
  const std::size_t passed = frames_in(*checkpoint, plan, history);
  resume.writes_checkpoint = resume.writes_checkpoint && passed != plan.frames.size();
  if (passed <= first_wanted || passed >= plan.frames.size()) {
    return 0;
  }
  const auto wanted = resume.work.begin() + static_cast<std::ptrdiff_t>(first_wanted);
  const auto done = resume.work.begin() + static_cast<std::ptrdiff_t>(passed);
  if (std::find(wanted, done, FrameWork::render) != done) {
    return 0;
  }
  std::fill(resume.work.begin(), done, FrameWork::skip);
  resume.taken_up = std::move(checkpoint);
  return passed;
}

// Traces complete frames again from `begin` on, as far as frames behind them or a checkpoint need their history.
// Without any such need those of `preroll` are skipped as well.
void replay_for_history(const PipelineSettings& settings, std::size_t first_wanted, std::size_t begin,
                        ResumePlan& resume) {
  std::vector<FrameWork>& work = resume.work;
  std::size_t end = resume.writes_checkpoint ? work.size() : 0;  // behind the last frame that is rendered
  for (std::size_t i = first_wanted; i < work.size(); ++i) {
    if (work[i] == FrameWork::render) {
      end = std::max(end, i + 1);
    }
  }
  if (end == 0) {
    std::fill_n(work.begin(), first_wanted, FrameWork::skip);
  }
  if (needs_history(settings) || resume.writes_checkpoint) {
    for (std::size_t i = begin; i < end; ++i) {
      if (work[i] == FrameWork::skip) {
        work[i] = FrameWork::replay;
      }
    }
  }
}

}  // namespace

ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const RunPaths& paths,
                       const TemporalHistory& history) {
  const auto first_wanted = std::min(static_cast<std::size_t>(settings.preroll), plan.frames.size());
  ResumePlan resume;
  resume.writes_checkpoint = !settings.checkpoint.empty();
  resume.work.assign(plan.frames.size(), FrameWork::render);
  std::fill_n(resume.work.begin(), first_wanted, FrameWork::replay);
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
  std::vector<std::size_t> without_row =
      skip_finished(plan, first_wanted, finished, expected_histories(plan, settings, history), resume);
  // A run that was killed between the last file and its row renders that frame once more, so that its times do not stay
  // unknown. More rows than one are lost by damage alone, and then their frames are not; and where a frame depends on
  // those before it, these may be gone by now.
  if (without_row.size() == 1 && has_rows && !needs_history(settings)) {
    resume.work[without_row.front()] = FrameWork::render;
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
  for (std::size_t i = first_wanted; i < plan.frames.size(); ++i) {
    if (resume.work[i] == FrameWork::skip) {
      finished.add_files(plan.frames[i].frame, resume.kept_files);
    }
  }
  const std::size_t begin = take_up_checkpoint(plan, settings, history, first_wanted, resume);
  replay_for_history(settings, first_wanted, begin, resume);
  return resume;
}

}  // namespace gazetrace
