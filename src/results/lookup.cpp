// SPDX-License-Identifier: Apache-2.0
#include "results/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gazetrace {
namespace {

void add_fact(NamedValues& facts, const char* name, const std::string& value) {
  if (!value.empty()) {
    facts.emplace_back(name, value);
  }
}
void add_fact(NamedValues& facts, const char* name, const std::optional<double>& value) {
  if (value) {
    facts.emplace_back(name, fmt::format("{:.6g}", *value));
  }
}

}  // namespace

const ResultRow* find_row(const std::vector<ResultRow>& rows, const std::string& id) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const ResultRow& one) { return one.id == id; });
  return row == rows.end() ? nullptr : &*row;
}

std::string unit_of(const Results& results, const std::string& metric) {
  const auto found = std::find_if(results.metrics.begin(), results.metrics.end(),
                                  [&](const ResultMetric& one) { return one.name == metric; });
  return found == results.metrics.end() ? std::string() : found->unit;
}

const ResultScore* find_score(const ResultRow& row, const std::string& metric, const std::string& part) {
  const auto parts = row.scores.find(metric);
  if (parts == row.scores.end()) {
    return nullptr;
  }
  const auto score = parts->second.find(part);
  return score == parts->second.end() ? nullptr : &score->second;
}

std::vector<const ResultRow*> test_rows(const Results& results) {
  std::vector<const ResultRow*> tests;
  for (const ResultRow& row : results.rows) {
    if (row.role == RowRole::test) {
      tests.push_back(&row);
    }
  }
  return tests;
}

std::vector<SceneGaze> scene_gazes(const Results& results) {
  std::vector<SceneGaze> found;
  for (const ResultRow& row : results.rows) {
    const SceneGaze both{row.scene, row.gaze};
    if (std::find(found.begin(), found.end(), both) == found.end()) {
      found.push_back(both);
    }
  }
  return found;
}

const ResultReference* find_reference(const Results& results, const ResultRow& row) {
  const ResultReference* keyless = nullptr;  // of that scene, without a key to tell it from others
  for (const ResultReference& reference : results.references) {
    if (reference.scene != row.scene) {
      continue;
    }
    if (!row.reference.empty() && reference.key == row.reference) {
      return &reference;
    }
    if (keyless == nullptr && (row.reference.empty() || reference.key.empty())) {
      keyless = &reference;
    }
  }
  return keyless;
}

std::optional<double> find_floor(const ResultReference* reference, const std::string& gaze, const std::string& metric,
                                 const std::string& part) {
  if (reference == nullptr) {
    return std::nullopt;
  }
  const ResultFloor* floor = nullptr;
  for (const ResultFloor& one : reference->floors) {
    if (one.gaze == gaze || (floor == nullptr && one.gaze.empty())) {
      floor = &one;
    }
  }
  if (floor == nullptr) {
    return std::nullopt;
  }
  const auto parts = floor->scores.find(metric);
  if (parts == floor->scores.end() || !parts->second.contains(part)) {
    return std::nullopt;
  }
  return parts->second.at(part);
}

std::vector<std::string> band_names(const std::vector<double>& begin_deg) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < begin_deg.size(); ++i) {
    names.push_back(i + 1 < begin_deg.size() ? fmt::format("{:g}-{:g}", begin_deg[i], begin_deg[i + 1])
                                             : fmt::format("{:g}+", begin_deg[i]));
  }
  return names;
}

NamedValues facts_of(const ResultBuild& build) {
  NamedValues facts;
  add_fact(facts, "version", build.version);
  add_fact(facts, "digest", build.digest);
  add_fact(facts, "compiler", build.compiler);
  add_fact(facts, "march", build.march);
  return facts;
}

NamedValues facts_of(const ResultMachine& machine) {
  NamedValues facts;
  add_fact(facts, "cpu", machine.cpu);
  add_fact(facts, "threads", machine.threads ? std::to_string(*machine.threads) : std::string());
  return facts;
}

NamedValues facts_of(const ResultViewing& viewing) {
  NamedValues facts;
  add_fact(facts, "size_px", fmt::format("{}", fmt::join(viewing.size_px, ", ")));
  add_fact(facts, "ppd", viewing.pixels_per_degree);
  add_fact(facts, "width_deg", viewing.width_deg);
  add_fact(facts, "peak_cd_m2", viewing.peak_cd_m2);
  add_fact(facts, "contrast", viewing.contrast);
  add_fact(facts, "ambient_lux", viewing.ambient_lux);
  add_fact(facts, "model_gain", viewing.model_gain);
  add_fact(facts, "model_gain_cut_4_cpd", viewing.model_gain_cut_4_cpd);
  return facts;
}

std::string scene_gaze_text(const SceneGaze& both) {
  return both.gaze.empty() ? both.scene : both.scene + ", gaze " + both.gaze;
}

std::string list_text(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += i == 0 ? "" : i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

}  // namespace gazetrace
