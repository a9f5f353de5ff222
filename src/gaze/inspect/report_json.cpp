// SPDX-License-Identifier: Apache-2.0
// An inspection for programs. Durations and stamps are nanoseconds; values that are not known are left out or null.
#include <cmath>
#include <nlohmann/json.hpp>

#include "gaze/inspect/inspect.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

Json facts(const GazeInspection& r) {
  Json json = Json::array();
  for (const GazeFact& fact : r.facts) {
    json.push_back({{"what", fact.what},
                    {"value", fact.value},
                    {"evidence", to_string(fact.evidence)},
                    {"guess", fact.evidence == Evidence::statistics},
                    {"detail", fact.detail}});
  }
  return json;
}

void add_timing(const GazeInspection& r, Json& json) {
  const GazeTiming& t = r.timing;
  const bool hidden = r.is_wall_clock && t.first_ns == 0;
  json["wall_clock"] = r.is_wall_clock;
  json["first_ns"] = hidden ? Json() : Json(t.first_ns);
  json["last_ns"] = hidden ? Json() : Json(t.last_ns);
  json["duration_ns"] = r.span_ns;
  json["nominal_rate_hz"] = t.nominal_rate_hz > 0 ? Json(t.nominal_rate_hz) : Json();
  json["median_rate_hz"] = t.median_rate_hz;
  json["mean_rate_hz"] = t.mean_rate_hz;
  json["step_quartiles_ns"] = {t.step_q1_ns, t.step_q3_ns};
  json["jitter_ns"] = t.jitter_ns;
  json["gaps"] = {{"count", t.gaps}, {"longest_ns", t.longest_gap_ns}, {"total_ns", t.gaps_total_ns}};
  json["pauses"] = {{"count", t.pauses}, {"total_ns", t.pauses_total_ns}};
  json["order"] = {{"rows", r.order.rows},
                   {"backward_steps", r.order.backward_steps},
                   {"duplicates", r.order.duplicates},
                   {"identical_duplicates", r.order.identical_duplicates}};
}

void add_quality(const GazeInspection& r, Json& json) {
  const GazeLoss& loss = r.loss;
  json["samples"] = loss.samples;
  json["usable"] = loss.usable;
  json["usable_share"] = loss.samples > 0 ? static_cast<double>(loss.usable) / static_cast<double>(loss.samples) : 0.0;
  if (loss.left_share) {
    json["usable_share_of_eye"] = {{"left", *loss.left_share}, {"right", *loss.right_share}};
  }
  for (const GazeValidity validity : kReportedValidities) {
    json["validity"][std::string(to_string(validity))] = loss.by_validity[static_cast<std::size_t>(validity)];
  }
  json["losses"] = {{"blink_like", loss.blink_like}, {"blink_like_median_ms", loss.blink_like_median_ms},
                    {"longer", loss.longer},         {"longest_ns", loss.longest_ns},
                    {"leading_ns", loss.leading_ns}, {"trailing_ns", loss.trailing_ns}};
  json["frozen"] = {{"runs", r.frozen.runs},
                    {"samples", r.frozen.samples},
                    {"longest_ns", r.frozen.longest_ns},
                    {"repeated_share", r.frozen.repeated_share}};
  if (loss.usable > 0) {
    json["range"] = {{"first", r.range_x}, {"second", r.range_y}};
  }
  json["unit"] = r.unit;
  if (r.precision) {
    json["precision"] = {
        {"rms_s2s", r.precision->rms_s2s}, {"sd", r.precision->sd}, {"fixations", r.precision->fixations}};
  }
  json["accuracy"] = Json::array();
  for (const GazeCalibration& c : r.calibrations) {
    json["accuracy"].push_back({{"eye", to_string(c.eye)},
                                {"mean_deg", c.mean_error_deg},
                                {"max_deg", std::isnan(c.max_error_deg) ? Json() : Json(c.max_error_deg)},
                                {"line", c.row}});
  }
  if (r.disparity) {
    const GazeDisparity& d = *r.disparity;
    json["disparity"] = {{"pairs", d.pairs},
                         {"horizontal", d.horizontal},
                         {"horizontal_spread", d.horizontal_spread},
                         {"vertical", d.vertical},
                         {"vertical_spread", d.vertical_spread}};
  }
}

}  // namespace

std::string inspection_json(const GazeInspection& r) {
  Json json{{"source", r.source},
            {"format", r.format},
            {"format_confidence", r.format_confidence},
            {"kind", to_string(r.kind)},
            {"clock", r.clock}};
  json["facts"] = facts(r);
  if (r.geometry) {
    const DisplayGeometry& g = *r.geometry;
    json["geometry"] = {
        {"px", {g.width_px, g.height_px}}, {"cm", {g.width_cm, g.height_cm}}, {"distance_cm", g.distance_cm}};
  }
  json["recordings"] = Json::array();
  for (const GazeRecording& recording : r.recordings) {
    json["recordings"].push_back({{"kind", recording.is_block ? "block" : "recording"},
                                  {"rows", recording.rows},
                                  {"first_line", recording.first_row},
                                  {"duration_ns", duration_ns(recording)}});
    if (!recording.name.empty()) {
      json["recordings"].back()["name"] = recording.name;
    }
  }
  json["recording"] = r.recording > 0 ? Json(r.recording) : Json();
  add_timing(r, json);
  add_quality(r, json);
  json["both_eyes"] = r.both_eyes;
  json["head_poses"] = r.head_poses;
  for (std::size_t i = 0; i < kReportedEvents.size(); ++i) {
    json["events"][std::string(to_string(kReportedEvents[i]))] = r.events[i];
  }
  json["axes"] = Json::array();
  for (const GazeAxisTest& test : r.axes) {
    json["axes"].push_back(
        {{"axis", std::string(1, test.axis)}, {"verdict", to_string(test.verdict)}, {"evidence", test.evidence}});
  }
  json["vestibulo_ocular"] = Json::array();
  for (const VorTest& test : r.vor) {
    json["vestibulo_ocular"].push_back({{"axis", std::string(1, test.axis)},
                                        {"stretches", test.stretches},
                                        {"steadier_as_read", test.steadier_as_read},
                                        {"speed_as_read_deg_s", test.speed_as_read_deg_s},
                                        {"speed_flipped_deg_s", test.speed_flipped_deg_s},
                                        {"verdict", to_string(test.verdict)}});
  }
  json["warnings"] = r.warnings;
  json["findings"] = Json::array();
  for (const GazeFinding& f : r.findings) {
    json["findings"].push_back({{"kind", to_string(f.kind)},
                                {"code", f.code},
                                {"what", f.what},
                                {"evidence", f.evidence},
                                {"flag", f.setting.empty() ? Json() : Json(f.setting)}});
  }
  json["flags"] = r.settings;
  json["verdict"] = r.verdict;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
