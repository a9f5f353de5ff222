// SPDX-License-Identifier: Apache-2.0
// What values, runs and metrics are called on the page, in diagrams and in sentences.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/report.hpp"
#include "results/lookup.hpp"

namespace gazetrace {

struct ReportRole {
  std::string name, words, color, dash, mark;
};
const std::vector<ReportRole>& report_roles();
const ReportRole& report_role(RowRole role);

// A value with four significant digits; "–" where it is missing.
std::string value_text(const std::optional<double>& value);
std::string mean_text(const std::optional<Interval>& value);
// "0.11 to 0.13"; empty without an interval. An interval whose ends differ more than sixteenfold, as two repeats
// give one, says nothing but that there were too few, and that is what its text says.
std::string interval_text(const std::optional<Interval>& value);
bool is_telling(const Interval& value);
std::string with_interval(const std::optional<Interval>& value);  // "0.12 (0.11 to 0.13)"
std::string count_text(const std::optional<double>& value);       // "1.23 M"
std::string part_text(const std::string& part);                   // "2.6-5.2 degrees", "the fovea"
// The parts of the picture that some run has scores of: bands from the gaze outwards, retinal regions, "weighted".
std::vector<std::string> scored_parts(const Results& data);
std::string metric_text(const ResultMetric& metric);  // "flip", with its unit

// A test row, followed by its baselines in the order of the roles: those that it names, and those that name it.
std::vector<const ResultRow*> family_of(const Results& data, const ResultRow& test);
// The same without controls with a wrong gaze, for diagrams: nobody could choose those as a setting.
std::vector<const ResultRow*> plotted_family(const Results& data, const ResultRow& test);

// A name for each row of the results, by its id. Rows of one scene and gaze that have the same label are told apart by
// the test that they stand beside, by the options that the sweep varied, by their role and at last by a number.
std::map<std::string, std::string> run_names(const Results& data);

// "reference", with its key where there are others.
std::string reference_text(const ResultReference& scene, std::size_t references);

// Whether a metric noticed that the gaze was wrong. It is undecided where the gaze was measured only once, and where
// the wrong gaze scores worse by no more than repeats differ.
enum class ControlVerdict { sensitive, insensitive, undecided };
ControlVerdict control_verdict(const Results& data, const ResultControl& control);
bool was_measured_once(const Results& data, const ResultControl& control);

}  // namespace gazetrace
