// SPDX-License-Identifier: Apache-2.0
// Trials: the parts of a recording that are looked at one by one. Those that its importer named, by messages or by a
// table, are events of the log; of a log without them each block is a trial.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// How an importer finds trials: by messages, or in a table.
struct TrialRules {
  // The message that begins a trial, and the one that ends it. A pattern with * or ? stands for the whole text; one
  // without for every text that contains it. Without `end` a trial ends where the next one begins, or its block ends.
  std::string begin, end;
  // Only the nth of the messages that fit begins a trial; 0: every one does. per_block: they are counted anew in each
  // block, so that there is one trial in each.
  std::int32_t nth = 0;
  bool per_block = false;
  // Tab- or comma-separated, with a header: `onset` and `duration` in seconds on the log's clock (as in BIDS), or
  // `onset_ns` and `offset_ns`; `name` or `trial_type` names the trials.
  std::string table;
};

// Makes the trials that the rules find events of the log, in place of those that it has; nothing without a rule. Only
// those that hold a sample count. Error(input) where there is none, with a list of other possible marks; Error(usage)
// for rules that contradict each other; Error(input) with file:line for a broken table.
void name_trials(GazeLog& log, const TrialRules& rules);
// The log's trials, or its blocks, in the order of time; only those that hold a sample. Error(input) where there is
// none.
std::vector<GazeTrial> find_trials(const GazeLog& log);
// The one that `which` names, by number or name. Error(usage) with a list of all.
const GazeTrial& trial_by_name(const std::vector<GazeTrial>& trials, std::string_view which);

// The log's data between begin and end of the trial: samples, messages and events, which are cut at the ends.
// Validations before it stay, since they say how good it is. Of the head's poses the nearest one on either side stays.
GazeLog cut_to_trial(GazeLog log, const GazeTrial& trial);
// The trial of it that `which` names; empty: the whole log.
GazeLog chosen_trial(GazeLog log, const std::string& which);

// Whether a message's text fits a pattern, as TrialRules::begin says.
bool fits_pattern(std::string_view text, std::string_view pattern);

}  // namespace gazetrace
