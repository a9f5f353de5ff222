// SPDX-License-Identifier: Apache-2.0
// Finding things in results, and what places and lists are called in sentences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/results.hpp"

namespace gazetrace {

// Empty where there is none.
const ResultRow* find_row(const std::vector<ResultRow>& rows, const std::string& id);
std::string unit_of(const Results& results, const std::string& metric);
const ResultScore* find_score(const ResultRow& row, const std::string& metric, const std::string& part);
std::vector<const ResultRow*> test_rows(const Results& results);

struct SceneGaze {
  std::string scene, gaze;
  friend bool operator==(const SceneGaze&, const SceneGaze&) = default;
};
std::vector<SceneGaze> scene_gazes(const Results& results);  // of the rows, in their order

// The reference that a row was measured against; empty where the file does not have it.
const ResultReference* find_reference(const Results& results, const ResultRow& row);
std::optional<double> find_floor(const ResultReference* reference, const std::string& gaze, const std::string& metric,
                                 const std::string& part);

// "0-2.6", "2.6-60", "60+": of bands of eccentricity that begin at these angles.
std::vector<std::string> band_names(const std::vector<double>& begin_deg);

// What was measured with, as names and values for people; what is not known is left out.
NamedValues facts_of(const ResultBuild& build);
NamedValues facts_of(const ResultMachine& machine);
NamedValues facts_of(const ResultViewing& viewing);

std::string scene_gaze_text(const SceneGaze& both);            // "sponza, gaze reader"
std::string list_text(const std::vector<std::string>& items);  // "a, b and c"

}  // namespace gazetrace
