// SPDX-License-Identifier: Apache-2.0
// What a person reads on the terminal.
#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/sweep.hpp"

namespace gazetrace {
namespace {

// "0.1234 +-0.0012"
std::string with_spread(const Interval& interval, const char* unit = "") {
  std::string text = fmt::format("{:.4g}{}", interval.mean, unit);
  if (interval.low && interval.high) {
    text += fmt::format(" +-{:.2g}", (*interval.high - *interval.low) / 2);
  }
  return text;
}

// "3.05 (2.91 to 3.2)": intervals of ratios are not symmetric.
std::string ratio_text(const Interval& ratio) {
  return fmt::format("{:.4g}", ratio.mean) +
         (ratio.low && ratio.high ? fmt::format(" ({:.3g} to {:.3g})", *ratio.low, *ratio.high) : std::string());
}

std::string score_text(const SweepRow& row, const std::string& metric) {
  const auto parts = row.scores.find(metric);
  if (parts == row.scores.end() || !parts->second.contains("whole")) {
    return "-";
  }
  const SweepScore& score = parts->second.at("whole");
  return with_spread(score.value) + (score.resolved ? "" : " unresolved");
}

bool is_beside(const SweepRow& a, const SweepRow& b) {
  return a.scene == b.scene && a.gaze == b.gaze;
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
std::string times_text(const SweepMeasure& measure) {
  const bool writes = measure.write_png || measure.write_exr;
  return fmt::format(
      "s a frame, speed-up: sampling map, tracing, reconstruction and accumulation, t_uniform / t_foveated\n"
      "end-to-end: {}\n",
      writes ? "the same with exposure, view and writing of the pictures, without reading the scene"
             : "not known, as no pictures were written");
}

// Rows of a place that no other beats in both time and quality; where several references share the place, for each.
std::string fronts_text(const SweepPlan& plan, const SweepResults& results, const SweepRow& of_place) {
  std::string text;
  const std::string place = of_place.scene + "/" + of_place.gaze;
  for (const std::string& metric : plan.measure.comparison.metrics) {
    const auto fronts = results.pareto.find(metric);
    if (fronts == results.pareto.end()) {
      continue;
    }
    for (const auto& [name, ids] : fronts->second) {
      if (name == place || name.starts_with(place + "/")) {
        text += fmt::format("Pareto front of time and {}{}: {}\n", metric,
                            name == place ? "" : ", reference " + name.substr(place.size() + 1), fmt::join(ids, ", "));
      }
    }
  }
  return text;
}

std::string published_text(const SweepResults& results) {
  std::string text;
  for (const SweepRow& row : results.rows) {
    for (const SweepPublished& other : row.published) {
      text += fmt::format("  {}/{} {}: {} here, {:g} in {}\n", row.scene, row.gaze, row.label, ratio_text(row.speed_up),
                          other.speed_up, other.source);
    }
  }
  return text.empty() ? text : "\nspeed-up beside what was published\n" + text;
}

std::string fixed_quality_text(const SweepResults& results) {
  std::string text;
  for (const SweepFixedQuality& one : results.fixed_quality) {
    const FixedQuality& r = one.result;
    text += fmt::format("  {}/{}{} {} {:g}: {}{}\n", one.scene, one.gaze,
                        one.curve.empty() ? "" : ", " + one.curve + ",", one.metric, one.at,
                        r.speed_up ? fmt::format("{}{}{:.3g}", r.bound, r.bound.empty() ? "" : " ", *r.speed_up) : "-",
                        r.why.empty() ? "" : " (" + r.why + ")");
  }
  return text.empty() ? text : "\nspeed-up at fixed quality, t_uniform / t_foveated\n" + text;
}

std::string controls_text(const SweepResults& results) {
  std::string text;
  for (const SweepControl& control : results.controls) {
    text += fmt::format("  {}/{} {} {}, gaze {}: {:.4g}, with the right one {:.4g}: {}{}\n", control.scene,
                        control.gaze, control.of, control.metric, control.wrong, control.wrong_score.mean,
                        control.right.mean, control.sensitive ? "sensitive" : "not sensitive",
                        control.why.empty() ? "" : " (" + control.why + ")");
  }
  return text.empty() ? text : "\ncontrols with a wrong gaze\n" + text;
}

}  // namespace

std::string sweep_table(const SweepPlan& plan, const SweepResults& results) {
  std::vector<std::string> header{"id", "role", "setting", "s a frame", "spp", "speed-up", "end-to-end", "efficiency"};
  const std::vector<std::string>& metrics = plan.measure.comparison.metrics;
  header.insert(header.end(), metrics.begin(), metrics.end());
  std::string text = plan.title + "\n" + times_text(plan.measure);
  std::vector<const SweepRow*> places;  // the first row of each
  for (const SweepRow& row : results.rows) {
    if (std::none_of(places.begin(), places.end(), [&](const SweepRow* first) { return is_beside(*first, row); })) {
      places.push_back(&row);
    }
  }
  for (const SweepRow* const first : places) {
    std::vector<std::vector<std::string>> lines{header};
    for (const SweepRow& row : results.rows) {
      if (!is_beside(*first, row)) {
        continue;
      }
      std::string role = to_string(row.role);
      if (row.role == SweepRole::equal_time) {
        role += fmt::format(", reached {}", ratio_text(row.reached));
      }
      lines.push_back({row.id, role, row.label, with_spread(row.time_s),
                       fmt::format("{:.4g}", row.runs.front().samples / row.compared_pixels),
                       row.speed_up.mean > 0 ? ratio_text(row.speed_up) : "-",
                       row.end_to_end ? fmt::format("{:.4g}", *row.end_to_end) : "-",
                       row.efficiency ? fmt::format("{:.0f} %", 100 * *row.efficiency) : "-"});
      for (const std::string& metric : metrics) {
        lines.back().push_back(score_text(row, metric));
      }
    }
    text +=
        fmt::format("\n{}, gaze {}\n", first->scene, first->gaze) + aligned(lines) + fronts_text(plan, results, *first);
  }
  text += published_text(results) + fixed_quality_text(results) + controls_text(results);
  for (const std::string& note : results.notes) {
    text += "\nnote: " + note;
  }
  return text + (results.notes.empty() ? "" : "\n");
}

}  // namespace gazetrace
