// SPDX-License-Identifier: Apache-2.0
#include "report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gazetrace/compare.hpp"

namespace gazetrace {
namespace {

std::size_t role_rank(const std::string& name) {
  const auto& roles = report_roles();
  return static_cast<std::size_t>(
      std::find_if(roles.begin(), roles.end(), [&](const ReportRole& role) { return role.name == name; }) -
      roles.begin());
}

}  // namespace

const std::vector<ReportRole>& report_roles() {
  static const std::vector<ReportRole> roles{
#define REPORT_ROLE(name, words, color, dash, mark) {name, words, color, dash, mark},
#include "report/roles.def"
#undef REPORT_ROLE
  };
  return roles;
}

ReportRole report_role(const std::string& name) {
  const std::size_t rank = role_rank(name);
  return rank < report_roles().size() ? report_roles()[rank] : ReportRole{name, name, "#8a8a8a", "", "square"};
}

std::string value_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : std::string("–");
}

std::string mean_text(const std::optional<Estimate>& value) {
  return value ? value_text(value->mean) : std::string("–");
}

std::string interval_text(const std::optional<Estimate>& value) {
  return value && value->low ? value_text(value->low) + " to " + value_text(value->high) : std::string();
}

std::string with_interval(const std::optional<Estimate>& value) {
  const std::string interval = interval_text(value);
  return interval.empty() ? mean_text(value) : mean_text(value) + " (" + interval + ")";
}

std::string count_text(const std::optional<double>& value) {
  if (!value) {
    return "–";
  }
  constexpr std::array<const char*, 4> kUnits{"", " k", " M", " G"};
  double scaled = *value;
  std::size_t unit = 0;
  while (std::fabs(scaled) >= 1000 && unit + 1 < kUnits.size()) {
    scaled /= 1000;
    ++unit;
  }
  return fmt::format("{:.4g}{}", scaled, kUnits[unit]);
}

std::string part_text(const std::string& part) {
  const auto& regions = kRetinalRegionNames;
  if (std::find(regions.begin(), regions.end(), part) != regions.end()) {
    return "the " + part + (part == "intermediate" ? " region" : "");
  }
  return part == "whole"      ? "the whole frame"
         : part == "weighted" ? "the frame weighted by cortical magnification"
                              : part + " degrees";
}

std::vector<std::string> scored_parts(const ReportData& data) {
  std::vector<std::string> parts = data.bands;
  parts.insert(parts.end(), kRetinalRegionNames.begin(), kRetinalRegionNames.end());
  parts.emplace_back("weighted");
  std::erase_if(parts, [&](const std::string& part) {
    return std::none_of(data.rows.begin(), data.rows.end(), [&](const ReportRow& row) {
      return std::any_of(row.scores.begin(), row.scores.end(),
                         [&](const auto& metric) { return find_score(row, metric.first, part) != nullptr; });
    });
  });
  return parts;
}

std::string metric_text(const ReportMetric& metric) {
  return metric.unit.empty() || metric.unit == metric.name ? metric.name : metric.name + " [" + metric.unit + "]";
}

std::string list_text(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += i == 0 ? "" : i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

const ReportScore* find_score(const ReportRow& row, const std::string& metric, const std::string& part) {
  const auto found = row.scores.find(metric);
  if (found == row.scores.end()) {
    return nullptr;
  }
  const auto score = std::find_if(found->second.begin(), found->second.end(),
                                  [&](const ReportScore& one) { return one.part == part; });
  return score == found->second.end() ? nullptr : &*score;
}

const ReportRow* find_row(const ReportData& data, const std::string& id) {
  const auto row = std::find_if(data.rows.begin(), data.rows.end(), [&](const ReportRow& one) { return one.id == id; });
  return row == data.rows.end() ? nullptr : &*row;
}

std::vector<const ReportRow*> family_of(const ReportData& data, const ReportRow& test) {
  std::vector<const ReportRow*> family{&test};
  for (const ReportRow& row : data.rows) {
    const bool is_named = std::any_of(test.baselines.begin(), test.baselines.end(),
                                      [&](const auto& baseline) { return baseline.second == row.id; });
    if (&row != &test && (is_named || row.of == test.id)) {
      family.push_back(&row);
    }
  }
  std::stable_sort(family.begin() + 1, family.end(),
                   [](const ReportRow* a, const ReportRow* b) { return role_rank(a->role) < role_rank(b->role); });
  return family;
}

std::vector<const ReportRow*> plotted_family(const ReportData& data, const ReportRow& test) {
  std::vector<const ReportRow*> family = family_of(data, test);
  family.erase(
      std::remove_if(family.begin(), family.end(), [](const ReportRow* row) { return row->role == "wrong-gaze"; }),
      family.end());
  return family;
}

std::vector<const ReportRow*> test_rows(const ReportData& data) {
  std::vector<const ReportRow*> tests;
  for (const ReportRow& row : data.rows) {
    if (row.role == "test") {
      tests.push_back(&row);
    }
  }
  return tests;
}

std::vector<SceneGaze> scene_gazes(const ReportData& data) {
  std::vector<SceneGaze> found;
  for (const ReportRow& row : data.rows) {
    const SceneGaze both{row.scene, row.gaze};
    if (std::find(found.begin(), found.end(), both) == found.end()) {
      found.push_back(both);
    }
  }
  return found;
}

const ReportScene* find_scene(const ReportData& data, const ReportRow& row) {
  const ReportScene* keyless = nullptr;  // of that name, without a key to tell it from others
  for (const ReportScene& scene : data.scenes) {
    if (scene.name != row.scene) {
      continue;
    }
    if (!row.reference.empty() && scene.key == row.reference) {
      return &scene;
    }
    if (keyless == nullptr && (row.reference.empty() || scene.key.empty())) {
      keyless = &scene;
    }
  }
  return keyless;
}

std::vector<const ReportScene*> find_scenes(const ReportData& data, const SceneGaze& both) {
  std::vector<const ReportScene*> scenes;
  for (const ReportRow& row : data.rows) {
    const ReportScene* const scene = SceneGaze{row.scene, row.gaze} == both ? find_scene(data, row) : nullptr;
    if (scene != nullptr && std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) {
      scenes.push_back(scene);
    }
  }
  return scenes;
}

std::string reference_text(const ReportScene& scene, std::size_t references) {
  return references > 1 ? "reference " + scene.key : std::string("reference");
}

std::optional<double> find_floor(const ReportScene* scene, const std::string& gaze, const std::string& metric,
                                 const std::string& part) {
  if (scene == nullptr) {
    return std::nullopt;
  }
  const auto by_gaze = scene->floor_by_gaze.find(gaze);
  const ReportFloor& floor = by_gaze == scene->floor_by_gaze.end() ? scene->floor : by_gaze->second;
  const auto parts = floor.find(metric);
  if (parts == floor.end() || parts->second.count(part) == 0) {
    return std::nullopt;
  }
  return parts->second.at(part);
}

namespace {

struct ControlledScore {
  const ReportMetric* metric = nullptr;
  const ReportScore* right = nullptr;  // of the run that the control belongs to
};

// A control is named by its metric, and by the part where that is not the whole frame.
ControlledScore controlled_score(const ReportData& data, const ReportControl& control) {
  for (const ReportMetric& metric : data.metrics) {
    const bool is_whole = control.metric == metric.name;
    if (is_whole || control.metric.starts_with(metric.name + " ")) {
      const ReportRow* const row = find_row(data, control.of);
      const std::string part = is_whole ? "whole" : control.metric.substr(metric.name.size() + 1);
      return {&metric, row == nullptr ? nullptr : find_score(*row, metric.name, part)};
    }
  }
  return {};
}

}  // namespace

bool was_measured_once(const ReportData& data, const ReportControl& control) {
  const ReportScore* const right = controlled_score(data, control).right;
  return right != nullptr && right->value && !right->value->low;
}

ControlVerdict control_verdict(const ReportData& data, const ReportControl& control) {
  if (control.is_sensitive) {
    return ControlVerdict::sensitive;
  }
  const ReportMetric* const metric = controlled_score(data, control).metric;
  const bool is_worse = metric != nullptr && control.right_score && control.wrong_score &&
                        (metric->is_lower_better ? *control.wrong_score > *control.right_score
                                                 : *control.wrong_score < *control.right_score);
  return is_worse || was_measured_once(data, control) ? ControlVerdict::undecided : ControlVerdict::insensitive;
}

std::string scene_gaze_text(const SceneGaze& both) {
  return both.gaze.empty() ? both.scene : both.scene + ", gaze " + both.gaze;
}

}  // namespace gazetrace
