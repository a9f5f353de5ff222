// SPDX-License-Identifier: Apache-2.0
#include "results/csv.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/output.hpp"
#include "results/lookup.hpp"

namespace gazetrace {
namespace {

// Counts that must not lose their last digits.
std::string csv_count(const std::optional<double>& value) {
  return value ? fmt::format("{:.15g}", *value) : std::string();
}

// Blank where the row has no such setting: uniform rows know nothing of regions.
std::string value_of(const NamedValues& settings, const std::string& option) {
  const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == option; });
  return found == settings.end() ? std::string() : found->second;
}

}  // namespace

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  }
  return quoted + "\"";
}

std::string csv_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : std::string();
}

std::string csv_interval(const std::optional<Interval>& value) {
  return value ? csv_number(value->mean) + "," + csv_number(value->low) + "," + csv_number(value->high)
               : std::string(",,");
}

std::string results_csv(const Results& results) {
  std::string text = "id,scene,gaze,role,of,label";
  for (const std::string& option : results.varied) {
    text += "," + csv_cell(option);
  }
  text +=
      ",resolution_scale,repeats,samples,spp_mean,rays,peak_mib,task,time_s,time_low_s,time_high_s,speed_up,speed_up_"
      "low,"
      "speed_up_high,end_to_end,efficiency,metric,part,score,score_low,score_high,resolved,floor,unit\n";
  for (const ResultRow& row : results.rows) {
    std::string head = fmt::format("{},{},{},{},{},{}", csv_cell(row.id), csv_cell(row.scene), csv_cell(row.gaze),
                                   to_string(row.role), csv_cell(row.of), csv_cell(row.label));
    for (const std::string& option : results.varied) {
      head += "," + csv_cell(value_of(row.settings, option));
    }
    head += fmt::format(",{:.9g},{},{},{},{},{},{},{},{},{},{}", row.resolution_scale, row.times_s.size(),
                        csv_count(row.samples), csv_number(row.spp_mean), csv_count(row.rays), csv_number(row.peak_mib),
                        row.task, csv_interval(row.time_s), csv_interval(row.speed_up), csv_number(row.end_to_end),
                        csv_number(row.efficiency));
    if (row.scores.empty()) {
      text += head + ",,,,,,,,\n";
    }
    const ResultReference* const reference = find_reference(results, row);
    for (const auto& [metric, parts] : row.scores) {
      for (const auto& [part, score] : parts) {
        text += fmt::format("{},{},{},{},{},{},{}\n", head, csv_cell(metric), csv_cell(part), csv_interval(score.value),
                            score.is_resolved ? 1 : 0, csv_number(find_floor(reference, row.gaze, metric, part)),
                            csv_cell(unit_of(results, metric)));
      }
    }
  }
  return text;
}

void write_results(const std::string& folder, const Results& results) {
  write_text_atomically(folder + "/results.csv", results_csv(results));
  write_text_atomically(folder + "/methods.txt", results_methods(results));
  write_text_atomically(folder + "/results.json", results_json(results));
}

}  // namespace gazetrace
