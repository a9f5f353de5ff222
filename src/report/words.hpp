// SPDX-License-Identifier: Apache-2.0
// How values, runs and metrics are called on the page, in diagrams and in sentences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/report.hpp"

namespace gazetrace {

struct ReportRole {
  std::string name, words, color, dash, mark;
};
const std::vector<ReportRole>& report_roles();
// The role of that name; an unknown one is gray and called as it is.
ReportRole report_role(const std::string& name);

// Three to four digits that say something; "–" for what is missing.
std::string value_text(const std::optional<double>& value);
std::string mean_text(const std::optional<Estimate>& value);
std::string interval_text(const std::optional<Estimate>& value);  // "0.11 to 0.13"; empty without an interval
std::string with_interval(const std::optional<Estimate>& value);  // "0.12 (0.11 to 0.13)"
std::string count_text(const std::optional<double>& value);       // "1.23 M"
std::string part_text(const std::string& part);                   // "2.6-5.2 degrees", "the fovea"
// Parts of the picture that some run has scores of: bands from the gaze outwards, retinal regions, "weighted".
std::vector<std::string> scored_parts(const ReportData& data);
std::string metric_text(const ReportMetric& metric);           // "flip", with its unit
std::string list_text(const std::vector<std::string>& items);  // "a, b and c"

const ReportScore* find_score(const ReportRow& row, const std::string& metric, const std::string& part);
const ReportRow* find_row(const ReportData& data, const std::string& id);
// A test row and its baselines, the test first, in the order of the roles: those that it names, and those that name it.
std::vector<const ReportRow*> family_of(const ReportData& data, const ReportRow& test);
// The same for diagrams: without controls about a wrong gaze, which are no settings to choose from.
std::vector<const ReportRow*> plotted_family(const ReportData& data, const ReportRow& test);
std::vector<const ReportRow*> test_rows(const ReportData& data);

struct SceneGaze {
  std::string scene, gaze;
  friend bool operator==(const SceneGaze&, const SceneGaze&) = default;
};
std::vector<SceneGaze> scene_gazes(const ReportData& data);  // of the rows, in their order
// The scene with the reference that a run was measured against; empty where the file does not have it.
const ReportScene* find_scene(const ReportData& data, const ReportRow& row);
// Those of the runs of a scene and gaze: several where they differ in size or view.
std::vector<const ReportScene*> find_scenes(const ReportData& data, const SceneGaze& both);
// "reference", with its key where there are others.
std::string reference_text(const ReportScene& scene, std::size_t references);
std::optional<double> find_floor(const ReportScene* scene, const std::string& gaze, const std::string& metric,
                                 const std::string& part);

// Whether a metric noticed that the gaze was wrong. undecided: the wrong gaze was measured once, or scores worse by no
// more than repeats differ.
enum class ControlVerdict { sensitive, insensitive, undecided };
ControlVerdict control_verdict(const ReportData& data, const ReportControl& control);
bool was_measured_once(const ReportData& data, const ReportControl& control);
std::string scene_gaze_text(const SceneGaze& both);  // "sponza, gaze reader"

}  // namespace gazetrace
