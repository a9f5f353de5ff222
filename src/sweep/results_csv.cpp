// SPDX-License-Identifier: Apache-2.0
// results.csv: a line for each row, metric and part of the picture.
#include <fmt/format.h>

#include <algorithm>

#include "sweep/tables.hpp"

namespace gazetrace {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) {
    return text;
  }
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' ? "\"\"" : std::string(1, c);
  }
  return result + "\"";
}

std::string shown(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : std::string();
}
std::string shown(const Interval& interval) {
  return fmt::format("{:.9g},{},{}", interval.mean, shown(interval.low), shown(interval.high));
}

// Blank where the row has no such setting: uniform rows know nothing of regions.
std::string value_of(const NamedValues& settings, const std::string& option) {
  const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == option; });
  return found == settings.end() ? std::string() : found->second;
}

}  // namespace

std::string sweep_csv(const SweepPlan& plan, const SweepResults& results) {
  std::string text = "id,scene,gaze,role,of,label";
  for (const std::string& option : plan.varied) {
    text += "," + option;
  }
  text +=
      ",resolution_scale,repeats,samples,spp_mean,rays,peak_mib,time_s,time_low_s,time_high_s,speed_up,speed_up_low,"
      "speed_up_high,end_to_end,efficiency,metric,part,score,"
      "score_low,score_high,resolved\n";
  for (const SweepRow& row : results.rows) {
    std::string head = fmt::format("{},{},{},{},{},{}", quoted(row.id), quoted(row.scene), quoted(row.gaze),
                                   to_string(row.role), quoted(row.of), quoted(row.label));
    for (const std::string& option : plan.varied) {
      head += "," + quoted(value_of(row.settings, option));
    }
    const double samples = mean_of_runs(row, &SweepRun::samples);
    const bool has_speed_up = row.speed_up.mean > 0;
    head += fmt::format(",{:.9g},{},{:.15g},{:.9g},{:.15g},{:.9g}", row.resolution_scale, row.runs.size(), samples,
                        samples / row.compared_pixels, mean_of_runs(row, &SweepRun::rays),
                        mean_of_runs(row, &SweepRun::peak_mib));
    head += fmt::format(",{},{},{},{}", shown(row.time_s), has_speed_up ? shown(row.speed_up) : ",,",
                        shown(row.end_to_end), shown(row.efficiency));
    for (const auto& [metric, parts] : row.scores) {
      for (const auto& [part, score] : parts) {
        text += fmt::format("{},{},{},{},{}\n", head, metric, part, shown(score.value), score.resolved ? 1 : 0);
      }
    }
  }
  return text;
}

}  // namespace gazetrace
