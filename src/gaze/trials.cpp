// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/gaze_trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "core/text.hpp"
#include "gaze/angles.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {
namespace {

// Those that events of a type state, in the order of time.
std::vector<GazeTrial> stated_by(const GazeLog& log, GazeEventType type) {
  std::vector<GazeTrial> trials;
  for (const GazeEvent& event : log.events) {
    if (event.type == type) {
      trials.push_back({0, type == GazeEventType::trial ? event.text : std::string(), event.begin_ns, event.end_ns, 0});
    }
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const GazeTrial& a, const GazeTrial& b) { return a.begin_ns < b.begin_ns; });
  return trials;
}

// The blocks of the recording.
std::vector<GazeTrial> blocks_of(const GazeLog& log) {
  std::vector<GazeTrial> blocks = stated_by(log, GazeEventType::segment);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].block = static_cast<std::int32_t>(i) + 1;
  }
  return blocks;
}

// The block that a time lies in; null where it lies in none.
const GazeTrial* block_at(const std::vector<GazeTrial>& blocks, std::int64_t t_ns) {
  const auto after = std::upper_bound(blocks.begin(), blocks.end(), t_ns,
                                      [](std::int64_t t, const GazeTrial& block) { return t < block.begin_ns; });
  return after != blocks.begin() && t_ns <= std::prev(after)->end_ns ? &*std::prev(after) : nullptr;
}

std::vector<const GazeEvent*> messages_of(const GazeLog& log, const std::string& pattern) {
  return events_in_time(log, [&](const GazeEvent& event) {
    return event.type == GazeEventType::message && fits_pattern(event.text, pattern);
  });
}

std::vector<GazeTrial> trials_by_messages(const GazeLog& log, const TrialRules& rules,
                                          const std::vector<GazeTrial>& blocks) {
  std::map<std::int32_t, std::int32_t> counts;
  std::vector<GazeTrial> trials;
  for (const GazeEvent* message : messages_of(log, rules.begin)) {
    const GazeTrial* const block = block_at(blocks, message->begin_ns);
    const std::int32_t in_block = block != nullptr ? block->block : 0;
    const std::int32_t count = ++counts[rules.per_block ? in_block : 0];
    if (rules.nth == 0 || count == rules.nth) {
      const std::int64_t end_ns = block != nullptr ? block->end_ns : log.samples.back().t_ns;
      trials.push_back({0, message->text, message->begin_ns, std::max(end_ns, message->begin_ns), in_block});
    }
  }
  for (std::size_t i = 0; i + 1 < trials.size(); ++i) {
    trials[i].end_ns = std::max(std::min(trials[i].end_ns, trials[i + 1].begin_ns - 1), trials[i].begin_ns);
  }
  if (rules.end.empty()) {
    return trials;
  }
  const std::vector<const GazeEvent*> ends = messages_of(log, rules.end);
  for (GazeTrial& trial : trials) {
    const auto end = std::upper_bound(ends.begin(), ends.end(), trial.begin_ns,
                                      [](std::int64_t t, const GazeEvent* message) { return t < message->begin_ns; });
    if (end != ends.end()) {
      trial.end_ns = std::min(trial.end_ns, (*end)->begin_ns);
    }
  }
  return trials;
}

// The rows of a table of trials in the order of time, see TrialRules::table; numbers and blocks are not filled in.
std::vector<GazeTrial> read_trial_table(const std::string& path) {
  const GazeFile file{path, read_text_file(path)};
  const DelimitedTable table = open_table(file);
  const auto fail_header = [&](const std::string& problem) {
    throw Error(ErrorKind::input, place_of(file, std::max<std::int64_t>(table.header_line, 1)), problem,
                "name its columns onset and duration (seconds), or onset_ns and offset_ns, on the clock of the log");
  };
  if (table.headings.empty()) {
    fail_header("is empty");
  }
  const auto name = table.find_any({"name", "trial_type"});
  const auto onset = table.find("onset");  // or onset_ns, as their units tell
  const auto offset = table.find("offset");
  const auto duration = table.find("duration");
  if (!onset || (!offset && !duration)) {
    fail_header("names no columns onset and duration (seconds), nor onset_ns and offset_ns");
  }
  std::vector<GazeTrial> trials;
  TableRows rows(file, table, table.headings.size());
  const auto time = [&](std::size_t column) {
    return rows.time_ns(column, {time_exponent(table.headings[column].unit).value_or(9), 0});
  };
  while (rows.next()) {
    GazeTrial trial;
    trial.name = rows.cell(name);
    trial.begin_ns = time(*onset);
    const bool fits = offset || !__builtin_add_overflow(trial.begin_ns, time(*duration), &trial.end_ns);
    trial.end_ns = offset ? time(*offset) : trial.end_ns;
    if (fits && trial.end_ns < trial.begin_ns) {
      rows.fail("the trial ends before it begins", "mend the row");
    }
    // As of a log: durations are taken everywhere, and half of what an int64 holds leaves room for their sums.
    std::int64_t duration_ns = 0;
    if (!fits || __builtin_sub_overflow(trial.end_ns, trial.begin_ns, &duration_ns) ||
        duration_ns > std::numeric_limits<std::int64_t>::max() / 2) {
      rows.fail("the trial lasts more than a hundred years",
                "give onset and duration in seconds, or onset_ns and offset_ns");
    }
    trials.push_back(std::move(trial));
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const GazeTrial& a, const GazeTrial& b) { return a.begin_ns < b.begin_ns; });
  return trials;
}

// Whether there is any rule; Error(usage) where they contradict each other.
bool has_rule(const TrialRules& rules) {
  const auto needs_start = [&](bool is_given, const char* option) {
    if (is_given && rules.begin.empty()) {
      throw Error(ErrorKind::usage, option, "says nothing without a message that begins a trial", "give `trial-start`");
    }
  };
  needs_start(!rules.end.empty(), "`trial-end`");
  needs_start(rules.nth != 0, "`trial-nth`");
  needs_start(rules.per_block, "`trial-per-block`");
  if (!rules.table.empty() && !rules.begin.empty()) {
    throw Error(ErrorKind::usage, "`trial-table`", "messages divide the log, too", "give it or `trial-start`");
  }
  if (rules.per_block && rules.nth == 0) {
    throw Error(ErrorKind::usage, "`trial-per-block`", "counts messages, and every one begins a trial",
                "give `trial-nth`");
  }
  return !rules.table.empty() || !rules.begin.empty();
}

std::string what_it_has(const GazeLog& log, const std::vector<GazeTrial>& blocks) {
  const auto messages = std::count_if(log.events.begin(), log.events.end(),
                                      [](const GazeEvent& e) { return e.type == GazeEventType::message; });
  return fmt::format("the log has {} blocks and {} messages", blocks.size(), messages);
}

// Those that hold a sample, with their numbers and blocks.
std::vector<GazeTrial> numbered(const GazeLog& log, std::vector<GazeTrial> trials,
                                const std::vector<GazeTrial>& blocks) {
  std::erase_if(trials, [&](const GazeTrial& trial) {
    const auto first = std::lower_bound(log.samples.begin(), log.samples.end(), trial.begin_ns,
                                        [](const GazeSample& s, std::int64_t t) { return s.t_ns < t; });
    return first == log.samples.end() || first->t_ns > trial.end_ns;
  });
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].number = static_cast<std::int32_t>(i) + 1;
    if (trials[i].block == 0) {
      const GazeTrial* const block = block_at(blocks, trials[i].begin_ns);
      trials[i].block = block != nullptr ? block->block : 0;
    }
  }
  return trials;
}

}  // namespace

bool fits_pattern(std::string_view text, std::string_view pattern) {
  text = trim(text);
  if (pattern.find_first_of("*?") == std::string_view::npos) {
    return text.find(pattern) != std::string_view::npos;
  }
  // Where a star fits too little, it takes one character more: only the last star is ever tried again.
  std::size_t t = 0;
  std::size_t p = 0;
  std::size_t star = std::string_view::npos;
  std::size_t tried = 0;
  while (t < text.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] != '*' && pattern[p] == text[t]))) {
      ++t;
      ++p;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      tried = t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++tried;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

void name_trials(GazeLog& log, const TrialRules& rules) {
  if (!has_rule(rules)) {
    return;
  }
  if (log.samples.empty()) {
    throw Error(ErrorKind::input, log.source, "has no samples to divide into trials");
  }
  const bool is_table = !rules.table.empty();
  const std::vector<GazeTrial> blocks = blocks_of(log);
  const std::vector<GazeTrial> trials =
      numbered(log, is_table ? read_trial_table(rules.table) : trials_by_messages(log, rules, blocks), blocks);
  if (trials.empty()) {
    throw Error(ErrorKind::input, log.source,
                fmt::format("has no trial by {}: {}", is_table ? "that table" : "messages", what_it_has(log, blocks)),
                is_table ? "its times must be on the clock of the log"
                         : "check the text of `trial-start`, and `trial-nth` against their number");
  }
  std::erase_if(log.events, [](const GazeEvent& event) { return event.type == GazeEventType::trial; });
  for (const GazeTrial& trial : trials) {
    log.events.push_back({GazeEventType::trial, Eye::cyclopean, trial.begin_ns, trial.end_ns, trial.name, 0});
  }
}

std::vector<GazeTrial> find_trials(const GazeLog& log) {
  const std::vector<GazeTrial> blocks = blocks_of(log);
  const std::vector<GazeTrial> named = stated_by(log, GazeEventType::trial);
  std::vector<GazeTrial> trials = numbered(log, named.empty() ? blocks : named, blocks);
  if (trials.empty()) {
    throw Error(ErrorKind::input, log.source, "has no trials: " + what_it_has(log, blocks),
                fmt::format("name them once: gazetrace gaze import {} -o gaze.csv `trial-start` TEXT, or `trial-table` "
                            "FILE",
                            log.source));
  }
  return trials;
}

const GazeTrial& trial_by_name(const std::vector<GazeTrial>& trials, std::string_view which) {
  if (const auto number = count_from(which)) {
    if (*number < 1 || *number > trials.size()) {
      throw Error(ErrorKind::usage, "`trial`", fmt::format("there is no trial {}", which),
                  fmt::format("they are numbered from 1 to {}", trials.size()));
    }
    return trials[*number - 1];
  }
  const GazeTrial* found = nullptr;
  for (const GazeTrial& trial : trials) {
    if (trim(trial.name) != which) {
      continue;
    }
    if (found != nullptr) {
      throw Error(ErrorKind::usage, "`trial`",
                  fmt::format("trials {} and {} have that name", found->number, trial.number), "give the number");
    }
    found = &trial;
  }
  if (found == nullptr) {
    throw Error(ErrorKind::usage, "`trial`", fmt::format("no trial is called '{}'", which),
                fmt::format("give a name, or a number from 1 to {}", trials.size()));
  }
  return *found;
}

GazeLog cut_to_trial(GazeLog log, const GazeTrial& trial) {
  const auto cut = [&](auto& values, std::size_t first, std::size_t end) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(end), values.end());
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  const auto from = [&](const auto& values, std::int64_t t_ns) {
    return static_cast<std::size_t>(
        std::lower_bound(values.begin(), values.end(), t_ns, [](const auto& v, std::int64_t t) { return v.t_ns < t; }) -
        values.begin());
  };
  const auto until = [&](const auto& values, std::int64_t t_ns) {
    return static_cast<std::size_t>(
        std::upper_bound(values.begin(), values.end(), t_ns, [](std::int64_t t, const auto& v) { return t < v.t_ns; }) -
        values.begin());
  };
  const std::size_t first = from(log.samples, trial.begin_ns);
  const std::size_t end = std::max(until(log.samples, trial.end_ns), first);
  const std::size_t count = log.samples.size();
  if (log.eyes.size() == count) {
    cut(log.eyes, first, end);
  }
  if (log.origins.size() == count) {
    cut(log.origins, first, end);
  }
  cut(log.samples, first, end);
  if (!log.head.empty()) {
    const std::size_t head_first = from(log.head, trial.begin_ns);
    const std::size_t head_end = until(log.head, trial.end_ns);
    cut(log.head, head_first > 0 ? head_first - 1 : 0, std::min(head_end + 1, log.head.size()));
  }
  std::erase_if(log.events, [&](const GazeEvent& e) { return e.end_ns < trial.begin_ns || e.begin_ns > trial.end_ns; });
  for (GazeEvent& event : log.events) {
    event.begin_ns = std::max(event.begin_ns, trial.begin_ns);
    event.end_ns = std::min(event.end_ns, trial.end_ns);
  }
  std::erase_if(log.calibrations, [&](const GazeCalibration& c) { return c.t_ns > trial.end_ns; });
  log.trial = trial;
  return log;
}

GazeLog chosen_trial(GazeLog log, const std::string& which) {
  if (which.empty()) {
    return log;
  }
  const std::vector<GazeTrial> trials = find_trials(log);
  const GazeTrial trial = trial_by_name(trials, which);
  return cut_to_trial(std::move(log), trial);
}

}  // namespace gazetrace
