// SPDX-License-Identifier: Apache-2.0
#include "report/csv.hpp"

#include <fmt/format.h>

#include "report/words.hpp"

namespace gazetrace {

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

std::string csv_estimate(const std::optional<Estimate>& value) {
  return value ? csv_number(value->mean) + "," + csv_number(value->low) + "," + csv_number(value->high)
               : std::string(",,");
}

std::string report_csv(const ReportData& data) {
  std::string text =
      "id,scene,gaze,role,of,label,time_s,time_s_low,time_s_high,samples,spp_mean,rays,peak_mib,speed_up,speed_up_low,"
      "speed_up_high,end_to_end,efficiency,metric,part,score,score_low,score_high,resolved,floor\n";
  for (const ReportRow& row : data.rows) {
    std::string start;
    for (const std::string& cell : {row.id, row.scene, row.gaze, row.role, row.of, row.label}) {
      start += csv_cell(cell) + ",";
    }
    start += fmt::format("{},{},{},{},{},{},{},{}", csv_estimate(row.time_s), csv_number(row.samples),
                         csv_number(row.spp_mean), csv_number(row.rays), csv_number(row.peak_mib),
                         csv_estimate(row.speed_up), csv_number(row.end_to_end), csv_number(row.efficiency));
    const ReportScene* const scene = find_scene(data, row);
    if (row.scores.empty()) {
      text += start + ",,,,,,,\n";
    }
    for (const auto& [metric, scores] : row.scores) {
      for (const ReportScore& score : scores) {
        const std::optional<double> floor = find_floor(scene, row.gaze, metric, score.part);
        text += fmt::format("{},{},{},{},{},{}\n", start, csv_cell(metric), csv_cell(score.part),
                            csv_estimate(score.value), score.is_resolved ? 1 : 0, csv_number(floor));
      }
    }
  }
  return text;
}

}  // namespace gazetrace
