// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) {
  return fmt::format("{:.9g}", value);
}
std::string number(const std::optional<double>& value) {
  return value ? number(*value) : std::string();
}

// JSON has no infinity: PSNR of equal pictures is null, as is what does not exist.
Json json_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

Json json_scores(const Scores& scores) {
  Json json{
      {"metric", scores.metric}, {"value", json_number(scores.value)}, {"weighted", json_number(scores.weighted)}};
  for (std::size_t b = 0; b < scores.bands.size(); ++b) {
    json["bands"][eccentricity_band_name(b)] = json_number(scores.bands[b]);
  }
  return json;
}

}  // namespace

std::string compare_csv_header() {
  std::string text = "frame,gaze,metric,value,weighted,map_min,map_p05,map_p25,map_p50,map_p75,map_p95,map_max";
  for (std::size_t b = 0; b < kEccentricityBandsDeg.size(); ++b) {
    text += fmt::format(",band_{}_deg", eccentricity_band_name(b));
  }
  return text + "\n";
}

std::string compare_csv_rows(const FrameScores& frame) {
  std::string text;
  for (std::size_t m = 0; m < frame.scores.size(); ++m) {
    const Scores& scores = frame.scores[m];
    const MapStatistics& map = frame.statistics[m];
    text += fmt::format("{},{},{},{},{}", frame.frame, frame.gaze_class, scores.metric, number(scores.value),
                        number(scores.weighted));
    const auto map_number = [&](double value) { return map.pixels > 0 ? number(value) : std::string(); };
    text += "," + map_number(map.min);
    for (const double quantile : map.quantiles) {
      text += "," + map_number(quantile);
    }
    text += "," + map_number(map.max);
    for (const auto& band : scores.bands) {
      text += "," + number(band);
    }
    text += "\n";
  }
  return text;
}

std::string compare_text(const CompareConditions& conditions, const std::vector<SequenceScores>& summary) {
  std::string text;
  for (const auto& [name, value] : conditions) {
    text += fmt::format("{:<14}{}\n", name, value);
  }
  for (const SequenceScores& part : summary) {
    if (summary.size() == 2 && part.gaze_class != "all") {
      continue;  // one class: the same numbers again
    }
    text += fmt::format("\n{} ({} frames of {})\n{:<12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}",
                        part.gaze_class == "all" ? "all frames" : "gaze " + part.gaze_class, part.frames,
                        summary.front().frames, "metric", "value", "weighted", "p05", "p50", "p95", "worst");
    for (std::size_t b = 0; b < kEccentricityBandsDeg.size(); ++b) {
      text += fmt::format("{:>10}", eccentricity_band_name(b));
    }
    text += "\n";
    for (std::size_t m = 0; m < part.scores.size(); ++m) {
      const Scores& scores = part.scores[m];
      const auto shown = [](const std::optional<double>& value) {
        return value ? fmt::format("{:.5g}", *value) : std::string("-");
      };
      text += fmt::format("{:<12}{:>12}{:>12}{:>12.5g}{:>12.5g}{:>12.5g}{:>8}", scores.metric, shown(scores.value),
                          shown(scores.weighted), part.quantiles[m][0], part.quantiles[m][1], part.quantiles[m][2],
                          part.worst_frame[m]);
      for (const auto& band : scores.bands) {
        text += fmt::format("{:>10}", shown(band));
      }
      text += "\n";
    }
  }
  return text;
}

std::string compare_json(const CompareConditions& conditions, const std::vector<SequenceScores>& summary,
                         const std::vector<FrameScores>& frames) {
  Json json;
  for (const auto& [name, value] : conditions) {
    json["conditions"][name] = value;
  }
  json["sequence"] = Json::array();
  for (const SequenceScores& part : summary) {
    Json scores = Json::array();
    for (std::size_t m = 0; m < part.scores.size(); ++m) {
      Json one = json_scores(part.scores[m]);
      one["frame_quantiles"] = {{"p05", json_number(part.quantiles[m][0])},
                                {"p50", json_number(part.quantiles[m][1])},
                                {"p95", json_number(part.quantiles[m][2])}};
      one["worst_frame"] = part.worst_frame[m];
      scores.push_back(std::move(one));
    }
    json["sequence"].push_back({{"gaze", part.gaze_class}, {"frames", part.frames}, {"scores", std::move(scores)}});
  }
  json["frames"] = Json::array();
  for (const FrameScores& frame : frames) {
    Json scores = Json::array();
    for (const Scores& one : frame.scores) {
      scores.push_back(json_scores(one));
    }
    json["frames"].push_back({{"frame", frame.frame}, {"gaze", frame.gaze_class}, {"scores", std::move(scores)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
