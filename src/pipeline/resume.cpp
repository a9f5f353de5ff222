// SPDX-License-Identifier: Apache-2.0
#include "pipeline/resume.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/file_digest.hpp"
#include "core/png_file.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "output/exr_seal.hpp"
#include "output/written_file.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/sample_sums_file.hpp"
#include "pipeline/sealed_file.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/traced_file.hpp"

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

// Looks at the files of finished frames.
class FinishedFrames {
 public:
  FinishedFrames(const PipelineSettings& settings, const WrittenFiles& known) : settings_(settings), known_(known) {
    if (settings.output.trust_files) {
      return;
    }
    for (const BadFile& file :
         find_bad_files(settings.output.run_directory, known, settings.settings_digest, settings.threads)) {
      bad_.insert(file.path);
    }
  }

  [[nodiscard]] bool is_complete(std::int32_t frame, const std::string& history) const {
    const OutputSettings& output = settings_.output;
    if (settings_.trace.samples) {
      const std::string path = samples_file_name(output.run_directory, frame, *settings_.trace.samples);
      return is_as_written(path) && read_samples_digest(path) == settings_.settings_digest && vouches(path, is_sealed);
    }
    if (settings_.stage == SequenceStage::trace) {
      const std::string path = traced_file_name(output.run_directory, frame);
      return is_as_written(path) && read_traced_digest(path) == settings_.settings_digest && vouches(path, is_sealed);
    }
    for (const std::string& pattern : {output.exr.pattern, output.display.pattern}) {
      if (!pattern.empty()) {
        const std::string path = frame_file_name(pattern, frame);
        if (!fs::exists(path) || !is_as_written(path)) {
          return false;
        }
        const FrameStamp stamp = read_frame_stamp(path);
        if (stamp.settings_digest != settings_.settings_digest || stamp.history != history ||
            stamp.frame.value_or(frame) != frame || !vouches(path, is_whole_picture)) {
          return false;
        }
      }
    }
    if (output.map_pattern.empty()) {
      return true;
    }
    // A sampling map says nothing of itself; it appears before the frame's other files and only when complete.
    const std::string map = frame_file_name(output.map_pattern, frame);
    return fs::exists(map) && is_as_written(map) && vouches(map, is_whole_picture);
  }

  // The files of a complete frame. What the run so far does not list is listed as it is now.
  void add_files(std::int32_t frame, WrittenFiles& files) const {
    for (const std::string& path : files_of(frame)) {
      const std::string name = name_in_record(settings_.output.run_directory, path);
      const auto known = known_.find(name);
      files[name] = known != known_.end() ? known->second : WrittenFile{frame, fs::file_size(path), digest_file(path)};
    }
  }

 private:
  [[nodiscard]] std::vector<std::string> files_of(std::int32_t frame) const {
    std::vector<std::string> files = output_files(settings_, {frame});
    return {files.begin() + std::min<std::ptrdiff_t>(2, static_cast<std::ptrdiff_t>(files.size())), files.end()};
  }
  // Of a file that the run so far does not list nobody says that it is whole but itself.
  [[nodiscard]] bool vouches(const std::string& path, bool (*is_whole)(const std::string&)) const {
    return settings_.output.trust_files || known_.contains(name_in_record(settings_.output.run_directory, path)) ||
           is_whole(path);
  }
  [[nodiscard]] bool is_as_written(const std::string& path) const {
    return !bad_.contains(
        path_in_record(settings_.output.run_directory, name_in_record(settings_.output.run_directory, path)));
  }

  const PipelineSettings& settings_;
  const WrittenFiles& known_;
  std::set<std::string> bad_;
};

// The checkpoint that is asked for, if it is of these settings; empty where it is missing or damaged.
std::optional<TemporalHistory> earlier_checkpoint(const PipelineSettings& settings) {
  if (settings.checkpoint.empty() || !fs::exists(settings.checkpoint)) {
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

// Reads the rows of the run so far; whether there is a table that can be read.
bool read_rows(const std::string& path, ResumePlan& resume) {
  std::error_code missing;
  if (fs::file_size(path, missing) == 0 || missing) {
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

}  // namespace

std::vector<std::string> expected_histories(const FramePlan& plan, const PipelineSettings& settings,
                                            const TemporalHistory& history) {
  std::vector<std::string> texts(plan.frames.size());
  if (!needs_history(settings)) {
    return texts;
  }
  std::vector<std::int32_t> passed = history.passed;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    texts[i] = history_text(passed);
    passed.push_back(plan.frames[i].frame);
  }
  return texts;
}

std::vector<std::int32_t> frames_of_others(const FramePlan& plan, const PipelineSettings& settings,
                                           const TemporalHistory& history) {
  const OutputSettings& output = settings.output;
  const std::vector<std::string> histories = expected_histories(plan, settings, history);
  std::vector<std::int32_t> others;
  for (std::size_t i = static_cast<std::size_t>(settings.preroll); i < plan.frames.size(); ++i) {
    const std::int32_t frame = plan.frames[i].frame;
    bool is_other = false;
    // Damage may have changed the digest itself: a file that is not whole is nobody's finished work.
    const auto is_of_others = [&](const std::string& path, const std::string& digest) {
      return !digest.empty() && digest != settings.settings_digest && is_sealed(path);
    };
    if (settings.trace.samples) {
      const std::string path = samples_file_name(output.run_directory, frame, *settings.trace.samples);
      is_other = is_of_others(path, read_samples_digest(path));
    } else if (settings.stage == SequenceStage::trace) {
      const std::string path = traced_file_name(output.run_directory, frame);
      is_other = is_of_others(path, read_traced_digest(path));
    } else {
      for (const std::string& pattern : {output.exr.pattern, output.display.pattern}) {
        if (pattern.empty() || !fs::exists(frame_file_name(pattern, frame))) {
          continue;
        }
        const FrameStamp stamp = read_frame_stamp(frame_file_name(pattern, frame));
        is_other = is_other || (!stamp.settings_digest.empty() && stamp.frame.value_or(frame) == frame &&
                                (stamp.settings_digest != settings.settings_digest || stamp.history != histories[i]));
      }
    }
    if (is_other) {
      others.push_back(frame);
    }
  }
  return others;
}

RecordedHistory recorded_history(const FramePlan& plan, const PipelineSettings& settings,
                                 const TemporalHistory& history) {
  RecordedHistory recorded;
  if (!needs_history(settings)) {
    return recorded;
  }
  std::vector<std::int32_t> passed = history.passed;
  for (std::size_t i = 0; i < std::min(static_cast<std::size_t>(settings.preroll), plan.frames.size()); ++i) {
    passed.push_back(plan.frames[i].frame);
  }
  recorded.settings_digest = settings.settings_digest;
  recorded.frames = passed.empty() ? std::string() : format_frame_list(passed);
  recorded.checkpoint = settings.resume_from;
  return recorded;
}

ResumePlan plan_resume(const FramePlan& plan, const PipelineSettings& settings, const RunPaths& paths,
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
  const bool has_rows = read_rows(paths.timing, resume);
  const WrittenFiles known = read_earlier_files(paths.record);
  const FinishedFrames finished(settings, known);
  const std::vector<std::string> histories = expected_histories(plan, settings, history);
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
  // A run that was killed between the last file and its row renders that frame once more, so that its times do not stay
  // unknown. More rows than one are lost by damage alone, and then their frames are not; and where a frame depends on
  // those before it, these may be gone by now.
  if (without_row.size() == 1 && has_rows && !needs_history(settings)) {
    resume.work[without_row.front()] = FrameWork::render;
    without_row.clear();
  }
  for (const std::size_t i : without_row) {
    const std::int32_t frame = plan.frames[i].frame;
    const std::string& pattern = settings.output.exr.pattern.empty() ? settings.output.display.pattern  //
                                                                     : settings.output.exr.pattern;
    resume.kept_rows[frame] =
        lost_timing_row(plan.frames[i], settings.trace.samples || settings.stage == SequenceStage::trace
                                            ? std::nullopt
                                            : read_frame_stamp(frame_file_name(pattern, frame)).exposure_ev);
  }
  if (!without_row.empty()) {
    resume.warnings.push_back("complete frames without a row in " + paths.timing + ": " +
                              std::to_string(without_row.size()) +
                              "; they are kept, and rows are made anew without times");
  }
  std::size_t last_to_render = plan.frames.size();
  for (std::size_t i = first_wanted; i < plan.frames.size(); ++i) {
    if (resume.work[i] == FrameWork::skip) {
      finished.add_files(plan.frames[i].frame, resume.kept_files);
    } else {
      last_to_render = i;
    }
  }
  std::size_t begin = 0;  // the first frame whose history is needed and not there
  if (std::optional<TemporalHistory> checkpoint = earlier_checkpoint(settings)) {
    const std::size_t passed = frames_in(*checkpoint, plan, history);
    resume.writes_checkpoint = resume.writes_checkpoint && passed != plan.frames.size();
    const auto done = resume.work.begin() + static_cast<std::ptrdiff_t>(passed);
    if (passed > first_wanted && passed < plan.frames.size() &&
        std::find(resume.work.begin() + static_cast<std::ptrdiff_t>(first_wanted), done, FrameWork::render) == done) {
      std::fill(resume.work.begin(), done, FrameWork::skip);
      resume.taken_up = std::move(checkpoint);
      begin = passed;
    }
  }
  const std::size_t end = resume.writes_checkpoint               ? plan.frames.size()
                          : last_to_render == plan.frames.size() ? 0
                                                                 : last_to_render + 1;
  if (end == 0) {
    std::fill(resume.work.begin(), resume.work.begin() + static_cast<std::ptrdiff_t>(first_wanted), FrameWork::skip);
  }
  if (needs_history(settings) || resume.writes_checkpoint) {
    for (std::size_t i = begin; i < end; ++i) {
      if (resume.work[i] == FrameWork::skip) {
        resume.work[i] = FrameWork::replay;
      }
    }
  }
  return resume;
}

}  // namespace gazetrace
