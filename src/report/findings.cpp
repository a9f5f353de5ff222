// SPDX-License-Identifier: Apache-2.0
// Sentences made from the numbers: what was gained, where foveation loses, what cannot be said. Two values count as
// different only where their intervals do not overlap, which is stricter than a test of their difference.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "report/words.hpp"

namespace gazetrace {
namespace {

enum class Verdict { better, worse, undecided, unresolved, missing };

Verdict verdict(const ResultScore* test, const ResultScore* baseline, bool is_lower_better) {
  if (test == nullptr || baseline == nullptr || !test->value || !baseline->value) {
    return Verdict::missing;
  }
  if (!test->is_resolved && !baseline->is_resolved) {
    return Verdict::unresolved;
  }
  const Interval& a = *test->value;
  const Interval& b = *baseline->value;
  if (!a.low || !b.low) {
    return Verdict::undecided;
  }
  if (*a.high < *b.low) {
    return is_lower_better ? Verdict::better : Verdict::worse;
  }
  if (*b.high < *a.low) {
    return is_lower_better ? Verdict::worse : Verdict::better;
  }
  return Verdict::undecided;
}

std::string speed_sentence(const ResultRow& test) {
  if (!test.speed_up) {
    return "No speed-up was measured.";
  }
  const Interval& s = *test.speed_up;
  if (s.low && *s.low <= 1 && *s.high >= 1) {
    return fmt::format("Its speed-up of {} is not told apart from 1.", with_interval(s));
  }
  return s.mean >= 1 ? fmt::format("{} times as fast as uniform at the reference rate.", with_interval(s))
                     : fmt::format("Slower than uniform at the reference rate: speed-up {}.", with_interval(s));
}

std::string compared_sentence(const Results& data, const ResultRow& test, const ResultRow& baseline) {
  std::vector<std::string> better;
  std::vector<std::string> worse;
  std::vector<std::string> undecided;
  std::vector<std::string> unresolved;
  for (const ResultMetric& metric : data.metrics) {
    switch (verdict(find_score(test, metric.name, "whole"), find_score(baseline, metric.name, "whole"),
                    metric.is_lower_better)) {
      case Verdict::better:
        better.push_back(metric.name);
        break;
      case Verdict::worse:
        worse.push_back(metric.name);
        break;
      case Verdict::undecided:
        undecided.push_back(metric.name);
        break;
      case Verdict::unresolved:
        unresolved.push_back(metric.name);
        break;
      case Verdict::missing:
        break;
    }
  }
  std::string text;
  const auto add = [&](const char* words, const std::vector<std::string>& names) {
    if (!names.empty()) {
      text += (text.empty() ? "" : "; ") + std::string(words) + " " + list_text(names);
    }
  };
  add("better in", better);
  add("worse in", worse);
  add("not told apart in", undecided);
  add("under the reference's own noise in", unresolved);
  return text.empty() ? std::string() : fmt::format(" Beside {}: {}.", report_role(baseline.role).words, text);
}

std::string place_of(const ResultRow& test) {
  return fmt::format("{}, {}", scene_gaze_text({test.scene, test.gaze}), test.label);
}

void add_losses(const Results& data, const ResultRow& test, const ResultRow& baseline,
                std::vector<std::string>& losses) {
  std::vector<std::string> parts = band_names(data.bands_deg);
  parts.insert(parts.begin(), "whole");
  for (const ResultMetric& metric : data.metrics) {
    std::vector<std::string> lost;
    for (const std::string& part : parts) {
      const ResultScore* const ours = find_score(test, metric.name, part);
      const ResultScore* const theirs = find_score(baseline, metric.name, part);
      if (verdict(ours, theirs, metric.is_lower_better) == Verdict::worse) {
        lost.push_back(fmt::format("{} against {}{} in {}", with_interval(ours->value), with_interval(theirs->value),
                                   theirs->is_resolved ? "" : " (unresolved)", part_text(part)));
      }
    }
    if (!lost.empty()) {
      losses.push_back(fmt::format("{}: {} has the {} {}: {}.", place_of(test), report_role(baseline.role).words,
                                   metric.is_lower_better ? "lower" : "higher", metric.name, list_text(lost)));
    }
  }
}

bool has_scores(const Results& data, const ResultRow& row) {
  for (const ResultMetric& metric : data.metrics) {
    const ResultScore* const score = find_score(row, metric.name, "whole");
    if (score != nullptr && score->value) {
      return true;
    }
  }
  return false;
}

// Which frames a sweep has scored: those with a fixation where there are any.
std::string scored_frames_sentence(const Results& data, const std::string& gaze) {
  const auto shares = data.event_shares.find(gaze);
  if (shares == data.event_shares.end()) {
    return {};
  }
  const auto fixations = shares->second.find("fixation");
  return fixations != shares->second.end() && fixations->second > 0
             ? " Scores are of fixations."
             : " No frame is a fixation: scores are of the others that are seen.";
}

std::string control_sentence(const Results& data, const ResultControl& control) {
  const std::string start = fmt::format(
      "{}: {} is {} when the gaze is {}, against {} when it is right", scene_gaze_text({control.scene, control.gaze}),
      control.metric, value_text(control.wrong_score), control.wrong, value_text(control.right_score));
  const std::string why = control.why.empty() ? std::string() : " (" + control.why + ")";
  if (control_verdict(data, control) == ControlVerdict::insensitive) {
    return start + ": it is insensitive to gaze there and supports no claim about foveation" + why + ".";
  }
  return start +
         (was_measured_once(data, control) ? "; whether it notices is undecided" + why
                                           : ", which is no more than repeats differ: whether it notices is "
                                             "undecided") +
         ", and it supports no claim about foveation.";
}

// What controls with a wrong gaze say, in a sentence for each metric; each control has its row in the table.
void add_controls(const Results& data, std::vector<std::string>& caveats) {
  constexpr std::size_t kNamed = 3;  // so few are named one by one
  std::vector<const ResultControl*> silent;
  for (const ResultControl& control : data.controls) {
    if (!control.is_sensitive) {
      silent.push_back(&control);
    }
  }
  if (silent.size() <= kNamed) {
    for (const ResultControl* const control : silent) {
      caveats.push_back(control_sentence(data, *control));
    }
    return;
  }
  std::map<std::string, std::array<int, 3>> counts;  // by metric: controls, insensitive, undecided
  for (const ResultControl& control : data.controls) {
    std::array<int, 3>& count = counts[control.metric];
    ++count[0];
    const ControlVerdict verdict = control_verdict(data, control);
    count[1] += verdict == ControlVerdict::insensitive ? 1 : 0;
    count[2] += verdict == ControlVerdict::undecided ? 1 : 0;
  }
  for (const auto& [metric, count] : counts) {
    if (count[1] + count[2] > 0) {
      caveats.push_back(
          fmt::format("{}: of {} controls with a wrong gaze it notices {}, is insensitive to {}, and {} are undecided; "
                      "where it does "
                      "not notice, it supports no claim about foveation (each is in the table of controls).",
                      metric, count[0], count[0] - count[1] - count[2], count[1], count[2]));
    }
  }
}

// A sampling that saves nothing is uniform sampling under another name, and its controls are the same picture.
void add_nothing_saved(const Results& data, const ResultRow& test, std::vector<std::string>& caveats) {
  constexpr double kLeastSaving = 1.1;
  for (const ResultRow* const row : family_of(data, test)) {
    if (row->role == RowRole::uniform_reference_rate && row->spp_mean && test.spp_mean && *test.spp_mean > 0 &&
        *row->spp_mean / *test.spp_mean < kLeastSaving) {
      caveats.push_back(fmt::format(
          "{}: it traces {:.3g} samples a pixel where uniform has {:.3g}, so that next to nothing is saved at this "
          "size "
          "on this screen, and controls with a wrong gaze show the same picture. A larger frame, or another sampling, "
          "would change that.",
          place_of(test), *test.spp_mean, *row->spp_mean));
      return;
    }
  }
}

std::string headline_of(const Results& data, const std::array<int, 5>& tally) {
  double least = 0;
  double most = 0;
  int runs = 0;
  bool too_few = false;
  for (const ResultRow* const test : test_rows(data)) {
    if (!test->speed_up) {
      continue;
    }
    const double mean = test->speed_up->mean;
    least = runs == 0 ? mean : std::min(least, mean);
    most = runs == 0 ? mean : std::max(most, mean);
    too_few = too_few || !is_telling(*test->speed_up);
    ++runs;
  }
  if (runs == 0) {
    return "No foveated run has been measured beside uniform sampling.";
  }
  const std::string times = runs == 1 || value_text(least) == value_text(most)
                                ? value_text(least)
                                : value_text(least) + " to " + value_text(most);
  std::string text =
      fmt::format("Foveated frames were rendered {} times as fast as uniform ones at the reference rate{}.", times,
                  runs == 1 ? "" : fmt::format(", over {} runs", runs));
  const int compared = tally[0] + tally[1] + tally[2] + tally[3];
  if (compared > 0) {
    text += fmt::format(
        " Beside uniform sampling of the same cost they scored better in {} of {} comparisons, worse in {}, and not "
        "told "
        "apart in {}.",
        tally[0], compared, tally[1], tally[2] + tally[3]);
  }
  return text +
         (too_few ? " Too few repeats were made for intervals of the speed-up: more would say how sure it is." : "");
}

// How many comparisons of whole frames came out how, in the order of Verdict.
using Tally = std::array<int, 5>;

void count(const Results& data, const ResultRow& test, const ResultRow& baseline, Tally& tally) {
  for (const ResultMetric& metric : data.metrics) {
    ++tally[static_cast<std::size_t>(verdict(find_score(test, metric.name, "whole"),
                                             find_score(baseline, metric.name, "whole"), metric.is_lower_better))];
  }
}

bool is_honest_baseline(const ResultRow& row) {
  return row.role == RowRole::equal_time || row.role == RowRole::equal_samples || row.role == RowRole::low_resolution;
}

}  // namespace

ReportFindings report_findings(const Results& data) {
  ReportFindings findings;
  Tally tally{};
  for (const ResultRow* const test : test_rows(data)) {
    std::string sentence = place_of(*test) + ": " + speed_sentence(*test);
    bool has_baseline = false;
    for (const ResultRow* const row : family_of(data, *test)) {
      if (row->role != RowRole::test && row->role != RowRole::wrong_gaze) {
        sentence += compared_sentence(data, *test, *row);
      }
      has_baseline = has_baseline || is_honest_baseline(*row);
      if (is_honest_baseline(*row)) {
        add_losses(data, *test, *row, findings.losses);
        count(data, *test, *row, tally);
      }
    }
    findings.summary.push_back(sentence);
    if (test->speed_up && (test->speed_up->high ? *test->speed_up->high : test->speed_up->mean) < 1) {
      findings.losses.push_back(
          fmt::format("{}: it is slower than uniform sampling at the reference rate, speed-up {}.", place_of(*test),
                      with_interval(test->speed_up)));
    }
    add_nothing_saved(data, *test, findings.caveats);
    if (!has_scores(data, *test)) {
      findings.caveats.push_back(place_of(*test) + ": no metric has a score, so nothing is said of its quality." +
                                 scored_frames_sentence(data, test->gaze));
    }
    if (!has_baseline) {
      findings.caveats.push_back(place_of(*test) +
                                 ": no uniform run of equal time or equal samples stands beside it, so nothing is "
                                 "claimed for foveation there.");
    }
  }
  findings.tally = fmt::format(
      "Scores of whole frames beside uniform sampling of equal time, equal samples and low resolution: {} better, {} "
      "worse, "
      "{} not told apart, {} under the reference's own noise, {} not known.",
      tally[0], tally[1], tally[2], tally[3], tally[4]);
  for (const ResultFixedQuality& fixed : data.fixed_quality) {
    if (!fixed.result.speed_up || !fixed.result.bound.empty()) {
      findings.caveats.push_back(
          fmt::format("{}{}: speed-up at {} {} is {}{}{}.", scene_gaze_text({fixed.scene, fixed.gaze}),
                      fixed.curve.empty() ? "" : ", " + fixed.curve, fixed.metric, value_text(fixed.at),
                      fixed.result.speed_up ? fixed.result.bound + " " : "",
                      fixed.result.speed_up ? value_text(fixed.result.speed_up) : "not known",
                      fixed.result.why.empty() ? "" : ", " + fixed.result.why));
    }
  }
  add_controls(data, findings.caveats);
  findings.headline = headline_of(data, tally);
  return findings;
}

}  // namespace gazetrace
