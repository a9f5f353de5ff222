// SPDX-License-Identifier: Apache-2.0
// Invented results of a sweep, for tests of reports.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gazetrace/output.hpp"
#include "gazetrace/report.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {

using nlohmann::ordered_json;

inline ordered_json estimate(double mean, double low, double high) {
  return {{"mean", mean}, {"low", low}, {"high", high}};
}

inline ordered_json score(double mean, double low, double high, bool resolved = true) {
  ordered_json json = estimate(mean, low, high);
  json["resolved"] = resolved;
  return json;
}

inline ordered_json row(const std::string& id, const std::string& role, const ordered_json& flip) {
  return {{"id", id},
          {"scene", "box"},
          {"gaze", "glide"},
          {"role", role},
          {"of", role == "test" ? ordered_json() : ordered_json("t")},
          {"label", "run " + id},
          {"settings", ordered_json::object()},
          {"time_s", estimate(2, 1.9, 2.1)},
          {"samples", 1e6},
          {"spp_mean", nullptr},
          {"rays", nullptr},
          {"peak_mib", nullptr},
          {"speed_up", estimate(4, 3.8, 4.2)},
          {"efficiency", nullptr},
          {"scores", {{"flip", {{"whole", flip}}}}},
          {"frames", ordered_json::array()}};
}

inline ordered_json results(const std::vector<ordered_json>& rows) {
  return {{"format", "gazetrace-sweep-1"},
          {"title", "a sweep"},
          {"bands_deg", {0, 2.6, 60}},
          {"metrics", {{{"name", "flip"}, {"better", "lower"}}}},
          {"scenes", {{{"name", "box"}, {"reference", {{"spp", 64}, {"floor", {{"flip", {{"whole", 0.01}}}}}}}}}},
          {"rows", rows}};
}

inline Results read(const ordered_json& json) {
  const TemporaryFolder folder;
  const std::string path = folder / "results.json";
  write_text_atomically(path, json.dump());
  return read_results(path);
}

inline std::string page_of(const Results& data) {
  return report_page(data, {}).html;
}

}  // namespace gazetrace
