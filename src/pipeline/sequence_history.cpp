// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sequence_history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include "gazetrace/checkpoint.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code missing;
  return !a.empty() && !b.empty() && std::filesystem::equivalent(a, b, missing);
}

// Of a history that an interrupted run has carried on beyond its own first frame, what that frame found is gone. Which
// frames had gone into it is known still, and that is enough where the run goes on behind them.
void take_back(std::int32_t first, TemporalHistory& history) {
  if (history.passed.empty() || history.passed.back() < first) {
    return;
  }
  std::vector<std::int32_t> before = std::move(history.passed);
  std::erase_if(before, [&](std::int32_t frame) { return frame >= first; });
  history = {};
  history.passed = std::move(before);
}

bool is_hollow(const TemporalHistory& history) {
  return !history.passed.empty() && !history.smoothed_ev;
}

}  // namespace

bool needs_history(const PipelineSettings& settings) {
  return settings.stage != SequenceStage::trace && uses_history(settings);
}

TemporalHistory starting_history(const FramePlan& plan, const PipelineSettings& settings, Warnings& warnings) {
  if (plan.frames.empty()) {
    return {};
  }
  const std::int32_t first = plan.frames.front().frame;
  if (settings.resume_from.empty()) {
    if (settings.is_part && first > 1 && settings.preroll == 0 && needs_history(settings)) {
      warnings.push_back(
          fmt::format("`chunk`: frame {} begins without the history of those before it; where the sequence begins "
                      "earlier, this part differs from one run: give `resume-from`, or `preroll`",
                      first));
    }
    return {};
  }
  if (settings.settings_digest.empty()) {
    throw Error(ErrorKind::usage, "`resume-from`", "no digest tells a history of these settings from others",
                "resolve the job, or set PipelineSettings::settings_digest");
  }
  TemporalHistory history = load_checkpoint(settings.resume_from, settings.settings_digest);
  if (settings.output.resume && is_same_file(settings.resume_from, settings.checkpoint)) {
    take_back(first, history);
  }
  const std::int32_t last = history.passed.empty() ? 0 : history.passed.back();
  if (last >= first) {
    throw Error(ErrorKind::usage, "`resume-from`",
                fmt::format("{} holds the history after frame {}, the run begins with frame {}", settings.resume_from,
                            last, first),
                fmt::format("begin with frame {}", last + 1));
  }
  if (last + 1 != first) {
    warnings.push_back(
        fmt::format("{} holds the history after frame {}, the run begins with frame {}: those between "
                    "are missing in it",
                    settings.resume_from, last, first));
  }
  return history;
}

void check_history_for(const std::vector<std::int32_t>& frames, const PipelineSettings& settings,
                       const TemporalHistory& history) {
  if (frames.empty() || !is_hollow(history)) {
    return;
  }
  throw Error(ErrorKind::input, settings.resume_from,
              fmt::format("frame {} must be made again, and the history after frame {} is gone: this run's own "
                          "checkpoint has taken its place",
                          frames.front(), history.passed.back()),
              "begin from an earlier checkpoint; different names for `checkpoint` and `resume-from` keep both");
}

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

}  // namespace gazetrace
