// SPDX-License-Identifier: Apache-2.0
// What a person reads on the terminal.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "results/lookup.hpp"

namespace gazetrace {
namespace {

// "0.1234 +-0.0012"
std::string with_spread(const std::optional<Interval>& interval) {
  if (!interval) {
    return "-";
  }
  std::string text = fmt::format("{:.4g}", interval->mean);
  if (interval->low && interval->high) {
    text += fmt::format(" +-{:.2g}", (*interval->high - *interval->low) / 2);
  }
  return text;
}

// "3.05 (2.91 to 3.2)": intervals of ratios are not symmetric.
std::string ratio_text(const std::optional<Interval>& ratio) {
  if (!ratio) {
    return "-";
  }
  return fmt::format("{:.4g}", ratio->mean) +
         (ratio->low && ratio->high ? fmt::format(" ({:.3g} to {:.3g})", *ratio->low, *ratio->high) : std::string());
}

std::string number_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : std::string("-");
}

std::string with_unit(const Results& results, const std::string& metric) {
  const std::string unit = unit_of(results, metric);
  return metric + (unit.empty() ? "" : " [" + unit + "]");
}

std::string score_text(const ResultRow& row, const std::string& metric) {
  const ResultScore* const score = find_score(row, metric, "whole");
  return score == nullptr ? "-" : with_spread(score->value) + (score->is_resolved ? "" : " unresolved");
}

std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size());
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      widths[c] = std::max(widths[c], line[c].size());
    }
  }
  std::string text;
  for (const auto& line : lines) {
    std::string one;
    for (std::size_t c = 0; c < line.size(); ++c) {
      one += fmt::format("{:<{}}  ", line[c], widths[c]);
    }
    one.erase(one.find_last_not_of(' ') + 1);
    text += one + "\n";
  }
  return text;
}

// What the columns of times hold.
std::string times_text(const Results& results) {
  const bool writes = std::any_of(results.rows.begin(), results.rows.end(),
                                  [](const ResultRow& row) { return row.output_s.has_value(); });
  return fmt::format(
      "s a frame, speed-up: sampling map, tracing, reconstruction and accumulation, t_uniform / t_foveated\n"
      "end-to-end: {}\n",
      writes ? "the same with exposure, view and writing of the pictures, without reading the scene"
             : "not known, as no pictures were written");
}

std::vector<std::string> line_of(const Results& results, const ResultRow& row) {
  std::string role = to_string(row.role);
  if (row.reached) {
    role += fmt::format(", reached {}", ratio_text(row.reached));
  }
  std::vector<std::string> line{row.id,
                                role,
                                row.label,
                                with_spread(row.time_s) + (row.task.empty() ? "" : ", task " + row.task),
                                number_text(row.spp_mean),
                                ratio_text(row.speed_up),
                                number_text(row.end_to_end),
                                row.efficiency ? fmt::format("{:.0f} %", 100 * *row.efficiency) : "-"};
  for (const ResultMetric& metric : results.metrics) {
    line.push_back(score_text(row, metric.name));
  }
  return line;
}

// Rows of a place that no other beats in both time and quality; where several references share the place, for each.
std::string fronts_text(const Results& results, const SceneGaze& both) {
  std::string text;
  const std::string place = both.scene + "/" + both.gaze;
  for (const ResultMetric& metric : results.metrics) {
    const auto fronts = results.pareto.find(metric.name);
    if (fronts == results.pareto.end()) {
      continue;
    }
    for (const auto& [name, ids] : fronts->second) {
      if (name == place || name.starts_with(place + "/")) {
        text += fmt::format("Pareto front of time and {}{}: {}\n", metric.name,
                            name == place ? "" : ", reference " + name.substr(place.size() + 1), fmt::join(ids, ", "));
      }
    }
  }
  return text;
}

std::string published_text(const Results& results) {
  std::string text;
  for (const ResultRow& row : results.rows) {
    for (const PublishedSpeedUp& other : row.published) {
      text += fmt::format("  {}/{} {}: {} here, {:g} in {}\n", row.scene, row.gaze, row.label, ratio_text(row.speed_up),
                          other.speed_up, other.source);
    }
  }
  return text.empty() ? text : "\nspeed-up beside the published one\n" + text;
}

std::string fixed_quality_text(const Results& results) {
  std::string text;
  for (const ResultFixedQuality& one : results.fixed_quality) {
    const FixedQuality& r = one.result;
    text += fmt::format(
        "  {}/{}{} {} {:g}: {}{}{}\n", one.scene, one.gaze, one.curve.empty() ? "" : ", " + one.curve + ",",
        with_unit(results, one.metric), one.at,
        r.speed_up ? fmt::format("{}{}{:.3g}", r.bound, r.bound.empty() ? "" : " ", *r.speed_up) : "-",
        r.why.empty() ? "" : " (" + r.why + ")",
        one.model_gain ? fmt::format("; by the model of eccentricity alone {:.3g}", *one.model_gain) : std::string());
  }
  return text.empty() ? text : "\nspeed-up at fixed quality, t_uniform / t_foveated\n" + text;
}

std::string controls_text(const Results& results) {
  std::string text;
  for (const ResultControl& control : results.controls) {
    text += fmt::format("  {}/{} {} {}, gaze {}: {}, with the right one {}: {}{}\n", control.scene, control.gaze,
                        control.of, with_unit(results, control.metric), control.wrong, number_text(control.wrong_score),
                        number_text(control.right_score), control.is_sensitive ? "sensitive" : "not sensitive",
                        control.why.empty() ? "" : " (" + control.why + ")");
  }
  return text.empty() ? text : "\ncontrols with a wrong gaze\n" + text;
}

}  // namespace

std::string results_table(const Results& results) {
  std::vector<std::string> header{"id", "role", "setting", "s a frame", "spp", "speed-up", "end-to-end", "efficiency"};
  for (const ResultMetric& metric : results.metrics) {
    header.push_back(with_unit(results, metric.name));
  }
  std::string text = results.title + "\n" + times_text(results);
  for (const SceneGaze& both : scene_gazes(results)) {
    std::vector<std::vector<std::string>> lines{header};
    for (const ResultRow& row : results.rows) {
      if (SceneGaze{row.scene, row.gaze} == both) {
        lines.push_back(line_of(results, row));
      }
    }
    text += fmt::format("\n{}, gaze {}\n", both.scene, both.gaze) + aligned(lines) + fronts_text(results, both);
  }
  text += published_text(results) + fixed_quality_text(results) + controls_text(results);
  for (const std::string& note : results.notes) {
    text += "\nnote: " + note;
  }
  return text + (results.notes.empty() ? "" : "\n");
}

}  // namespace gazetrace
