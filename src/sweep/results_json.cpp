// SPDX-License-Identifier: Apache-2.0
// results.json: everything that a report needs. Numbers that do not exist or are not finite are null.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "gazetrace/version.hpp"
#include "sweep/tables.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}
Json number(const std::optional<double>& value) {
  return value ? number(*value) : Json();
}
Json text_or_null(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}
Json object_of(const NamedValues& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) {
    json[name] = value;
  }
  return json;
}

Json json_of(const Interval& interval) {
  return {{"mean", number(interval.mean)}, {"low", number(interval.low)}, {"high", number(interval.high)}};
}

// Beside the frame's own picture.
Json flip_picture(const SweepRow& row, std::int32_t frame) {
  const bool has_flip = !row.runs.empty() && row.runs.front().scores.contains("flip");
  const std::size_t folder = row.png.rfind('/');
  return has_flip && folder != std::string::npos
             ? Json(frame_file_name(row.png.substr(0, folder) + "/flip.####.png", frame))
             : Json();
}

Json json_of(const SweepFrame& frame, const SweepRow& row, std::size_t index) {
  Json scores = Json::object();
  double time_s = 0;
  for (const SweepRun& run : row.runs) {
    time_s += run.frames.at(index).time_s / static_cast<double>(row.runs.size());
  }
  for (const auto& [metric, parts] : row.runs.front().frames.at(index).scores) {
    if (parts.contains("whole")) {
      scores[metric] = number(parts.at("whole"));
    }
  }
  const Json gaze = frame.gaze_px ? Json{frame.gaze_px->x, frame.gaze_px->y} : Json();
  return {{"index", frame.frame},
          {"t_s", static_cast<double>(frame.t_video_ns) * 1e-9},
          {"time_s", number(time_s)},
          {"event", frame.event},
          {"gaze_px", gaze},
          {"rings_px", frame.rings_px},
          {"png", row.png.empty() ? Json() : Json(frame_file_name(row.png, frame.frame))},
          {"flip_png", flip_picture(row, frame.frame)},
          {"scores", std::move(scores)}};
}

Json json_of(const SweepRow& row) {
  Json json{{"id", row.id},
            {"scene", row.scene},
            {"gaze", row.gaze},
            {"role", to_string(row.role)},
            {"of", text_or_null(row.of)},
            {"label", row.label},
            {"curve", row.curve},
            {"wrong", text_or_null(row.wrong)},
            {"baselines", row.baselines},
            {"settings", object_of(row.settings)},
            {"resolution_scale", row.resolution_scale},
            {"reference", row.reference}};
  json["time_s"] = json_of(row.time_s);
  json["time_s"]["values"] = Json::array();
  for (const SweepRun& run : row.runs) {
    json["time_s"]["values"].push_back(number(run.time_s));
  }
  json["output_s"] = row.runs.empty() ? Json() : number(row.runs.front().output_s);
  const double samples = mean_of_runs(row, &SweepRun::samples);
  json["samples"] = samples;
  json["spp_mean"] = number(samples / row.compared_pixels);
  json["rays"] = mean_of_runs(row, &SweepRun::rays);
  json["peak_mib"] = number(mean_of_runs(row, &SweepRun::peak_mib));
  json["speed_up"] = row.speed_up.mean > 0 ? json_of(row.speed_up) : Json();
  json["end_to_end"] = number(row.end_to_end);
  json["efficiency"] = number(row.efficiency);
  json["published"] = Json::array();
  for (const SweepPublished& other : row.published) {
    json["published"].push_back({{"speed_up", other.speed_up}, {"source", other.source}});
  }
  if (row.role == SweepRole::equal_time) {
    json["reached"] = json_of(row.reached);
  }
  json["scores"] = Json::object();
  for (const auto& [metric, parts] : row.scores) {
    for (const auto& [part, score] : parts) {
      json["scores"][metric][part] = json_of(score.value);
      json["scores"][metric][part]["resolved"] = score.resolved;
    }
  }
  json["frames"] = Json::array();
  for (std::size_t f = 0; f < row.frames.size() && !row.runs.empty(); ++f) {
    json["frames"].push_back(json_of(row.frames[f], row, f));
  }
  return json;
}

// By gaze, where every reference says the same of it: clips of another length or picture look at other things.
template <class T>
Json agreed(const SweepResults& results, T SweepFloor::*member) {
  std::map<std::string, T> values;
  std::set<std::string> doubtful;
  for (const SweepReferenceResult& reference : results.references) {
    for (const SweepFloor& floor : reference.floors) {
      const auto [found, is_new] = values.emplace(floor.gaze, floor.*member);
      if (floor.*member != found->second || (floor.*member).empty()) {
        doubtful.insert(floor.gaze);
      }
    }
  }
  std::erase_if(values, [&](const auto& value) { return doubtful.contains(value.first); });
  return values;
}

Json json_of(const SweepReferenceResult& reference) {
  Json floors = Json::object();
  Json bands = Json::object();
  Json events = Json::object();
  for (const SweepFloor& floor : reference.floors) {
    bands[floor.gaze] = floor.band_pixel_share;
    events[floor.gaze] = floor.event_shares;
    for (const auto& [metric, parts] : floor.scores) {
      for (const auto& [part, value] : parts) {
        floors[floor.gaze][metric][part] = number(value);
      }
    }
  }
  const Json first = floors.empty() ? Json::object() : floors.begin().value();
  return {{"name", reference.scene},
          {"reference",
           {{"key", reference.key},
            {"spp", reference.spp},
            {"frames_rendered", reference.pictures},
            {"seeds", reference.seeds},
            {"scramblings", reference.seeds.size()},
            {"directory", reference.directory},
            {"png", reference.png},
            {"floor", first},
            {"floor_by_gaze", std::move(floors)},
            {"band_pixel_share_by_gaze", std::move(bands)},
            {"shares_by_gaze", std::move(events)}}}};
}

Json viewing_of(const SweepPlan& plan) {
  const FrameRequest& request = plan.tests.front().plan.frames.front();
  const DisplayPhotometry& photometry = plan.measure.comparison.photometry;
  return {{"size_px", {request.width_px, request.height_px}},
          {"ppd", number(1 / (request.view.step_x * kDegPerRad))},
          {"width_deg", number(std::atan(request.view.step_x * request.width_px / 2) * 2 * kDegPerRad)},
          {"peak_cd_m2", photometry.peak_cd_m2},
          {"contrast", photometry.contrast},
          {"ambient_lux", photometry.ambient_lux}};
}

}  // namespace

std::string sweep_json(const SweepPlan& plan, const SweepResults& results) {
  Json json{{"format", "gazetrace-sweep-1"}, {"title", plan.title}, {"plan_file", plan.plan_file}};
  json["build"] = {{"version", kVersion},
                   {"digest", results.build},
                   {"compiler", build_description()},
                   {"march", instruction_set()}};
  json["machine"] = {{"cpu", results.machine}, {"threads", results.threads}};
  json["viewing"] = viewing_of(plan);
  json["color"] = {{"view", ColorPipeline(plan.references.front().color).description()}};
  json["common_settings"] = object_of(plan.common_settings);
  json["varied"] = plan.varied;
  json["repeats"] = plan.measure.repeats;
  json["bands_deg"] = kEccentricityBandsDeg;
  json["regions_deg"] = plan.measure.comparison.regions.end_deg;
  json["band_pixel_share"] = agreed(results, &SweepFloor::band_pixel_share);
  json["shares"] = agreed(results, &SweepFloor::event_shares);
  json["metrics"] = Json::array();
  for (const MetricInfo& info : comparison_metrics()) {
    const auto& wanted = plan.measure.comparison.metrics;
    if (std::find(wanted.begin(), wanted.end(), info.name) != wanted.end()) {
      const bool is_lower = info.better == MetricDirection::lower;
      json["metrics"].push_back({{"name", info.name},
                                 {"unit", info.name == "psnr"          ? "dB"
                                          : info.name == "fovvideovdp" ? "JOD"
                                                                       : ""},
                                 {"better", is_lower ? "lower" : "higher"},
                                 {"note", info.description}});
    }
  }
  json["scenes"] = Json::array();
  for (const SweepReferenceResult& reference : results.references) {
    json["scenes"].push_back(json_of(reference));
  }
  json["rows"] = Json::array();
  for (const SweepRow& row : results.rows) {
    json["rows"].push_back(json_of(row));
  }
  json["pareto"] = results.pareto;
  json["fixed_quality"] = Json::array();
  for (const SweepFixedQuality& one : results.fixed_quality) {
    json["fixed_quality"].push_back({{"metric", one.metric},
                                     {"at", one.at},
                                     {"scene", one.scene},
                                     {"gaze", one.gaze},
                                     {"curve", one.curve},
                                     {"speed_up", number(one.result.speed_up)},
                                     {"bound", one.result.bound},
                                     {"why", one.result.why}});
  }
  json["controls"] = Json::array();
  for (const SweepControl& control : results.controls) {
    json["controls"].push_back({{"scene", control.scene},
                                {"gaze", control.gaze},
                                {"metric", control.metric},
                                {"of", control.of},
                                {"wrong", control.wrong},
                                {"right_score", number(control.right.mean)},
                                {"wrong_score", number(control.wrong_score.mean)},
                                {"sensitive", control.sensitive},
                                {"why", control.why}});
  }
  json["notes"] = results.notes;
  json["methods"] = sweep_methods(plan, results);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
