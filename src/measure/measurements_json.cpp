// SPDX-License-Identifier: Apache-2.0
#include "measure/measurements_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/statistics.hpp"
#include "gaze/inspect/inspect.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double quantile(std::vector<double> values, double share) {
  return lower_quantile(values, share);
}

std::string file_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

std::string method_in_words(const EyeEvents& events) {
  if (events.preset == "log") {
    return "those that the recording itself states";
  }
  for (const EventPreset& preset : event_presets()) {
    if (preset.name == events.preset) {
      return preset.name + ", " + preset.description;
    }
  }
  return events.settings.method;
}

// The picture that places are in: its height over its width and, where it is known, its edges seen from the eye, as
// tangents of angles around straight ahead.
Json picture_json(const GazeLog& log) {
  if (log.kind == GazeKind::direction) {
    return nullptr;
  }
  const auto& g = log.recording_geometry;
  Json json{{"aspect",
             g && g->width_px > 0 && g->height_px > 0 ? static_cast<double>(g->height_px) / g->width_px : 9.0 / 16}};
  const ScreenAngles screen(log);
  if (log.kind == GazeKind::screen && screen.known()) {
    const Vec3d first = screen.direction(0, 0);
    const Vec3d last = screen.direction(1, 1);
    json["left"] = first.x / -first.z;
    json["top"] = first.y / -first.z;
    json["right"] = last.x / -last.z;
    json["bottom"] = last.y / -last.z;
  }
  return json;
}

Json trials_json(const std::vector<GazeTrial>& trials) {
  Json list = Json::array();
  for (const GazeTrial& trial : trials) {
    list.push_back(
        {{"number", trial.number}, {"name", trial.name}, {"onset_ns", trial.begin_ns}, {"offset_ns", trial.end_ns}});
  }
  return list;
}

Json vergence_json(const VergenceOverTime& vergence) {
  if (!vergence.missing.empty()) {
    return {{"missing", vergence.missing}};
  }
  std::vector<double> angles_deg, distances_mm;
  for (const Vergence& at : vergence.samples) {
    if (std::isfinite(at.horizontal_deg)) {
      angles_deg.push_back(at.horizontal_deg);
    }
    if (std::isfinite(at.distance_mm)) {
      distances_mm.push_back(at.distance_mm);
    }
  }
  const bool is_known = vergence.pupil_distance_mm > 0;
  return {{"samples", angles_deg.size()},
          {"pupil_distance_mm", is_known ? Json(vergence.pupil_distance_mm) : Json(nullptr)},
          {"pupil_distance_is", !is_known                     ? "unknown"
                                : vergence.is_distance_stated ? "stated"
                                                              : "of the log"},
          {"angle_deg_q1", number(quantile(angles_deg, 0.25))},
          {"angle_deg_median", number(quantile(angles_deg, 0.5))},
          {"angle_deg_q3", number(quantile(angles_deg, 0.75))},
          {"distance_mm_median", number(quantile(distances_mm, 0.5))}};
}

}  // namespace

std::string measurements_json(const GazeLog& log, const GazeMeasurements& measured) {
  Json quality = Json::array();
  for (const GazeQuality& q : measured.quality) {
    quality.push_back({{"of", q.of},
                       {"samples", q.samples},
                       {"usable", q.usable},
                       {"duration_s", q.duration_s},
                       {"sampling_rate_hz", q.sampling_rate_hz},
                       {"effective_rate_hz", number(q.effective_rate_hz)},
                       {"data_loss", number(q.data_loss)},
                       {"accuracy_deg", number(q.accuracy_deg)},
                       {"accuracy_max_deg", number(q.accuracy_max_deg)},
                       {"validations", q.validations},
                       {"precision_rms_s2s", number(q.precision_rms_s2s)},
                       {"precision_sd", number(q.precision_sd)},
                       {"precision_unit", q.precision_unit}});
  }
  Json events = Json::object();
  for (const EyeMovement movement :
       {EyeMovement::fixation, EyeMovement::saccade, EyeMovement::microsaccade, EyeMovement::pursuit,
        EyeMovement::blink, EyeMovement::lost, EyeMovement::unclassified}) {
    const std::vector<double> ms = durations_ms(log, measured.events, movement);
    const std::vector<double> deg = amplitudes_deg(measured.events, movement);
    events[std::string(to_string(movement))] = {{"count", ms.size()},
                                                {"duration_ms_q1", number(quantile(ms, 0.25))},
                                                {"duration_ms_median", number(quantile(ms, 0.5))},
                                                {"duration_ms_q3", number(quantile(ms, 0.75))},
                                                {"amplitude_deg_median", number(quantile(deg, 0.5))}};
  }
  const MainSequence& m = measured.main_sequence;
  Json json{{"source", file_name(log.source)},
            {"method", measured.events.preset},
            {"quality", std::move(quality)},
            {"events", std::move(events)},
            {"main_sequence",
             {{"saccades", m.saccades},
              {"factor", number(m.factor)},
              {"exponent", number(m.exponent)},
              {"correlation", number(m.correlation)}}},
            {"vergence", vergence_json(measured.vergence)},
            {"pupil_unit", log.pupil_unit},
            {"method_words", method_in_words(measured.events)},
            {"kind", log.kind == GazeKind::direction ? "direction"
                     : log.kind == GazeKind::screen  ? "screen"
                                                     : "camera"},
            {"plane_unit", GazePlane(log, std::nullopt).unit()},
            {"first_ns", log.samples.front().t_ns},
            {"picture", picture_json(log)},
            {"trials", trials_json(measured.trials)},
            {"program", fmt::format("gazetrace {}", kVersion)},
            {"warnings", measured.warnings}};
  if (log.trial) {
    json["trial"] = log.trial->number;
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
