// SPDX-License-Identifier: Apache-2.0
#include "report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gazetrace/compare.hpp"

namespace gazetrace {
namespace {

std::size_t role_rank(RowRole role) {
  const auto& roles = report_roles();
  const std::string name = to_string(role);
  return static_cast<std::size_t>(
      std::find_if(roles.begin(), roles.end(), [&](const ReportRole& one) { return one.name == name; }) -
      roles.begin());
}

}  // namespace

const std::vector<ReportRole>& report_roles() {
  static const std::vector<ReportRole> roles{
#define REPORT_ROLE(role, words, color, dash, mark) {to_string(RowRole::role), words, color, dash, mark},
#include "report/roles.def"
#undef REPORT_ROLE
  };
  return roles;
}

const ReportRole& report_role(RowRole role) {
  return report_roles().at(role_rank(role));
}

std::string value_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : std::string("–");
}

std::string mean_text(const std::optional<Interval>& value) {
  return value ? value_text(value->mean) : std::string("–");
}

bool is_telling(const Interval& value) {
  constexpr double kWidest = 16;
  return value.low && value.high && !(*value.low > 0 && *value.high > kWidest * *value.low);
}

std::string interval_text(const std::optional<Interval>& value) {
  if (!value || !value->low) {
    return {};
  }
  return is_telling(*value) ? value_text(value->low) + " to " + value_text(value->high)
                            : std::string("too few repeats for an interval");
}

std::string with_interval(const std::optional<Interval>& value) {
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

std::vector<std::string> scored_parts(const Results& data) {
  std::vector<std::string> parts = band_names(data.bands_deg);
  parts.insert(parts.end(), kRetinalRegionNames.begin(), kRetinalRegionNames.end());
  parts.emplace_back("weighted");
  std::erase_if(parts, [&](const std::string& part) {
    return std::none_of(data.rows.begin(), data.rows.end(), [&](const ResultRow& row) {
      return std::any_of(row.scores.begin(), row.scores.end(),
                         [&](const auto& metric) { return find_score(row, metric.first, part) != nullptr; });
    });
  });
  return parts;
}

std::string metric_text(const ResultMetric& metric) {
  return metric.unit.empty() || metric.unit == metric.name ? metric.name : metric.name + " [" + metric.unit + "]";
}

std::vector<const ResultRow*> family_of(const Results& data, const ResultRow& test) {
  std::vector<const ResultRow*> family{&test};
  for (const ResultRow& row : data.rows) {
    const bool is_named = std::any_of(test.baselines.begin(), test.baselines.end(),
                                      [&](const auto& baseline) { return baseline.second == row.id; });
    if (&row != &test && (is_named || row.of == test.id)) {
      family.push_back(&row);
    }
  }
  std::stable_sort(family.begin() + 1, family.end(),
                   [](const ResultRow* a, const ResultRow* b) { return role_rank(a->role) < role_rank(b->role); });
  return family;
}

std::vector<const ResultRow*> plotted_family(const Results& data, const ResultRow& test) {
  std::vector<const ResultRow*> family = family_of(data, test);
  family.erase(std::remove_if(family.begin(), family.end(),
                              [](const ResultRow* row) { return row->role == RowRole::wrong_gaze; }),
               family.end());
  return family;
}

std::map<std::string, std::string> run_names(const Results& data) {
  const auto place = [](const ResultRow& row) { return row.scene + "\n" + row.gaze + "\n"; };
  std::map<std::string, std::string> names;
  for (const ResultRow& row : data.rows) {
    names[row.id] = row.label;
  }
  // Adds `more` to the names that several rows of a scene and gaze have.
  const auto tell_apart = [&](const auto& more) {
    std::map<std::string, int> count;
    for (const ResultRow& row : data.rows) {
      ++count[place(row) + names[row.id]];
    }
    std::map<std::string, std::string> longer = names;
    for (const ResultRow& row : data.rows) {
      const std::string text = count[place(row) + names[row.id]] > 1 ? more(row) : std::string();
      longer[row.id] += text.empty() ? std::string() : ", " + text;
    }
    names = std::move(longer);
  };
  tell_apart([&](const ResultRow& row) {
    const ResultRow* const test = row.of.empty() ? nullptr : find_row(data.rows, row.of);
    return test == nullptr ? std::string() : "beside " + test->label;
  });
  tell_apart([](const ResultRow& row) {
    std::string text;
    for (const auto& [option, value] : row.settings) {
      text += (text.empty() ? "" : ", ") + option + " " + value;
    }
    return text;
  });
  tell_apart([](const ResultRow& row) { return report_role(row.role).words; });
  std::map<std::string, int> number;
  tell_apart([&](const ResultRow& row) { return "#" + std::to_string(++number[place(row) + row.label]); });
  return names;
}

std::string reference_text(const ResultReference& scene, std::size_t references) {
  return references > 1 ? "reference " + scene.key : std::string("reference");
}

namespace {

struct ControlledScore {
  const ResultMetric* metric = nullptr;
  const ResultScore* right = nullptr;  // the score of the run that the control belongs to
};

// A control names its metric, followed by the part where that is not the whole frame.
ControlledScore controlled_score(const Results& data, const ResultControl& control) {
  for (const ResultMetric& metric : data.metrics) {
    const bool is_whole = control.metric == metric.name;
    if (is_whole || control.metric.starts_with(metric.name + " ")) {
      const ResultRow* const row = find_row(data.rows, control.of);
      const std::string part = is_whole ? "whole" : control.metric.substr(metric.name.size() + 1);
      return {&metric, row == nullptr ? nullptr : find_score(*row, metric.name, part)};
    }
  }
  return {};
}

}  // namespace

bool was_measured_once(const Results& data, const ResultControl& control) {
  const ResultScore* const right = controlled_score(data, control).right;
  return right != nullptr && right->value && !right->value->low;
}

ControlVerdict control_verdict(const Results& data, const ResultControl& control) {
  if (control.is_sensitive) {
    return ControlVerdict::sensitive;
  }
  const ResultMetric* const metric = controlled_score(data, control).metric;
  const bool is_worse = metric != nullptr && control.right_score && control.wrong_score &&
                        (metric->is_lower_better ? *control.wrong_score > *control.right_score
                                                 : *control.wrong_score < *control.right_score);
  return is_worse || was_measured_once(data, control) ? ControlVerdict::undecided : ControlVerdict::insensitive;
}

}  // namespace gazetrace
