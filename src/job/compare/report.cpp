// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/compare_inputs.hpp"

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
  if (const std::string unit = metric_unit(scores.metric); !unit.empty()) {
    json["unit"] = unit;
  }
  for (std::size_t b = 0; b < scores.bands.size(); ++b) {
    json["bands"][eccentricity_band_name(b)] = json_number(scores.bands[b]);
  }
  for (std::size_t r = 0; r < scores.regions.size(); ++r) {
    json["regions"][kRetinalRegionNames[r]] = json_number(scores.regions[r]);
  }
  return json;
}

// "fixation 62.0 %, in-flight 25.0 %, blink 13.0 %".
std::string shares_text(const std::vector<SequenceScores>& summary) {
  std::string text;
  for (const SequenceScores& part : summary) {
    if (part.gaze_class != "all") {
      const double share = static_cast<double>(part.frames) / static_cast<double>(summary.front().frames);
      text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", part.gaze_class, 100 * share);
    }
  }
  return text;
}

}  // namespace

std::string compare_csv_header() {
  std::string text = "frame,gaze,metric,value,weighted,map_min,map_p05,map_p25,map_p50,map_p75,map_p95,map_max";
  for (std::size_t b = 0; b < kEccentricityBandsDeg.size(); ++b) {
    text += fmt::format(",band_{}_deg", eccentricity_band_name(b));
  }
  for (const char* region : kRetinalRegionNames) {
    text += fmt::format(",region_{}", region);
  }
  return text + ",unit\n";
}

std::string compare_csv_rows(const FrameScores& frame) {
  std::string text;
  for (std::size_t m = 0; m < frame.scores.size(); ++m) {
    const Scores& scores = frame.scores[m];
    const MapStatistics& map = frame.statistics[m];
    text += fmt::format("{},{},{},{},{}", frame.frame, to_string(frame.gaze_class), scores.metric, number(scores.value),
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
    for (const auto& region : scores.regions) {
      text += "," + number(region);
    }
    text += "," + metric_unit(scores.metric) + "\n";
  }
  return text;
}

std::string compare_text(const ComparedSequences& compared) {
  const std::vector<SequenceScores>& summary = compared.summary;
  std::string text;
  for (const auto& [name, value] : compared.conditions) {
    text += fmt::format("{:<14}{}\n", name, value);
  }
  const SequenceScores& claim = headline(summary);
  text += fmt::format("{:<14}{}\n{:<14}{}\n", "frames", shares_text(summary), "headline",
                      claim.gaze_class != "all"                     ? claim.gaze_class + " frames"
                      : summary.back().gaze_class == "unclassified" ? "all frames: the eye's movements are unknown"
                                                                    : "all frames: none in a fixation");
  for (const SequenceScores& part : summary) {
    if (summary.size() == 2 && part.gaze_class == "all") {
      continue;  // one class: the same numbers again
    }
    text +=
        fmt::format("\n{} ({} of {} frames){}\n{:<23}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}",
                    part.gaze_class == "all" ? "all frames" : part.gaze_class, part.frames, summary.front().frames,
                    &part == &claim ? ": headline" : "", "metric", "value", "weighted", "p05", "p50", "p95", "worst");
    for (const char* region : kRetinalRegionNames) {
      text += fmt::format("{:>13}", region);
    }
    for (std::size_t b = 0; b < kEccentricityBandsDeg.size(); ++b) {
      text += fmt::format("{:>12}", eccentricity_band_name(b));
    }
    text += "\n";
    for (std::size_t m = 0; m < part.scores.size(); ++m) {
      const Scores& scores = part.scores[m];
      const auto shown = [](const std::optional<double>& value) {
        return value ? fmt::format("{:.5g}", *value) : std::string("-");
      };
      const auto quantile = [&](std::size_t i) {
        return shown(std::isnan(part.quantiles[m][i]) ? std::nullopt : std::optional(part.quantiles[m][i]));
      };
      const std::string unit = metric_unit(scores.metric);
      text += fmt::format("{:<23}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}",
                          scores.metric + (unit.empty() ? "" : " [" + unit + "]"), shown(scores.value),
                          shown(scores.weighted), quantile(0), quantile(1), quantile(2),
                          part.worst_frame[m] ? std::to_string(*part.worst_frame[m]) : "-");
      for (const auto& region : scores.regions) {
        text += fmt::format("{:>13}", shown(region));
      }
      for (const auto& band : scores.bands) {
        text += fmt::format("{:>12}", shown(band));
      }
      text += "\n";
    }
  }
  return text;
}

std::string compare_json(const ComparedSequences& compared) {
  const std::vector<SequenceScores>& summary = compared.summary;
  Json json;
  for (const auto& [name, value] : compared.conditions) {
    json["conditions"][name] = value;
  }
  json["headline"] = headline(summary).gaze_class;
  json["sequence"] = Json::array();
  for (const SequenceScores& part : summary) {
    Json scores = Json::array();
    for (std::size_t m = 0; m < part.scores.size(); ++m) {
      Json one = json_scores(part.scores[m]);
      one["frame_quantiles"] = {{"p05", json_number(part.quantiles[m][0])},
                                {"p50", json_number(part.quantiles[m][1])},
                                {"p95", json_number(part.quantiles[m][2])}};
      one["worst_frame"] = part.worst_frame[m] ? Json(*part.worst_frame[m]) : Json();
      one["scored_frames"] = part.scored_frames[m];
      scores.push_back(std::move(one));
    }
    json["sequence"].push_back({{"gaze", part.gaze_class}, {"frames", part.frames}, {"scores", std::move(scores)}});
  }
  json["frames"] = Json::array();
  for (const FrameScores& frame : compared.frames) {
    Json scores = Json::array();
    for (const Scores& one : frame.scores) {
      scores.push_back(json_scores(one));
    }
    json["frames"].push_back(
        {{"frame", frame.frame}, {"gaze", to_string(frame.gaze_class)}, {"scores", std::move(scores)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
