// SPDX-License-Identifier: Apache-2.0
#include "study/report/page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/statistics.hpp"
#include "core/svg.hpp"
#include "gazetrace/version.hpp"
#include "report/fill.hpp"
#include "study/report/page_files.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string shown(double value, const char* unit, int digits = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}g}{}{}", value, digits, *unit != 0 ? " " : "", unit) : "not known";
}

double quantile(std::vector<double> values, double share) {
  return lower_quantile(values, share);
}

std::string file_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

std::string quality_table(const std::vector<GazeQuality>& quality) {
  struct Row {
    const char* name;
    std::function<std::string(const GazeQuality&)> value;
  };
  const Row rows[] = {
      {"Sampling rate", [](const auto& q) { return shown(q.sampling_rate_hz, "Hz", 4); }},
      {"Effective rate", [](const auto& q) { return shown(q.effective_rate_hz, "Hz", 4); }},
      {"Data loss", [](const auto& q) { return shown(100 * q.data_loss, "%"); }},
      {"Accuracy, mean", [](const auto& q) { return shown(q.accuracy_deg, "deg"); }},
      {"Accuracy, worst", [](const auto& q) { return shown(q.accuracy_max_deg, "deg"); }},
      {"Precision, RMS-S2S", [](const auto& q) { return shown(q.precision_rms_s2s, q.precision_unit.c_str()); }},
      {"Precision, SD", [](const auto& q) { return shown(q.precision_sd, q.precision_unit.c_str()); }},
      {"Recorded", [](const auto& q) { return shown(q.duration_s, "s", 5); }},
      {"Samples", [](const auto& q) { return std::to_string(q.samples); }},
  };
  std::string html = "<div class=\"scroll\"><table><thead><tr><th></th>";
  for (const GazeQuality& q : quality) {
    html += "<th scope=\"col\">" + escaped(q.of) + "</th>";
  }
  html += "</tr></thead><tbody>";
  for (const Row& row : rows) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", row.name);
    for (const GazeQuality& q : quality) {
      html += "<td>" + escaped(row.value(q)) + "</td>";
    }
    html += "</tr>";
  }
  return html + "</tbody></table></div>";
}

std::string events_table(const GazeLog& log, const EyeEvents& events) {
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th></th><th scope=\"col\">count</th><th scope=\"col\">median "
      "duration</th><th scope=\"col\">middle half</th><th scope=\"col\">median amplitude</th></tr></thead><tbody>";
  for (const EyeMovement movement : {EyeMovement::fixation, EyeMovement::saccade, EyeMovement::microsaccade,
                                     EyeMovement::pursuit, EyeMovement::blink, EyeMovement::lost}) {
    const std::size_t count = count_of(events, movement);
    if (count == 0) {
      continue;
    }
    const std::vector<double> ms = durations_ms(log, events, movement);
    const std::vector<double> deg = amplitudes_deg(events, movement);
    html += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{:.0f} ms</td><td>{:.0f} to {:.0f} ms</td><td>{}</td></tr>",
        to_string(movement), count, quantile(ms, 0.5), quantile(ms, 0.25), quantile(ms, 0.75),
        deg.empty() ? "" : fmt::format("{:.2f} deg", quantile(deg, 0.5)));
  }
  return html + "</tbody></table></div>";
}

std::string figure(const GazePlot& plot) {
  const bool is_place = plot.name == "scanpath" || plot.name == "heat_map";
  const char* const frame = is_place ? "wide place" : plot.is_wide ? "wide" : "";
  const std::string note = plot.note.empty() ? "" : "<p class=\"small\">" + escaped(plot.note) + "</p>";
  return fmt::format("<figure><figcaption>{}</figcaption><div class=\"{}\"{}>{}</div>{}</figure>\n",
                     escaped(plot.title), frame, plot.is_wide && !is_place ? " tabindex=\"0\"" : "", plot.svg, note);
}

// The page's title names the recording already.
std::string warnings_of(const GazeLog& log, const GazeReport& report) {
  const std::string place = log.source + ": ";
  if (report.warnings.empty()) {
    return {};
  }
  std::string html = "<div class=\"warnings\" role=\"note\"><b>To be checked</b><ul>";
  for (const std::string& warning : report.warnings) {
    html += "<li>" + escaped(warning.starts_with(place) ? warning.substr(place.size()) : warning) + "</li>";
  }
  return html + "</ul></div>";
}

std::string method_of(const EyeEvents& events) {
  if (events.preset == "log") {
    return "those that the recording itself states";
  }
  for (const EventPreset& preset : event_presets()) {
    if (preset.name == events.preset) {
      return escaped(preset.name + ", " + preset.description);
    }
  }
  return escaped(events.settings.method);
}

}  // namespace

std::string gaze_page(const GazeLog& log, const GazeReport& report) {
  const std::string name =
      file_name(log.source) + (log.trial ? fmt::format(", trial {}", log.trial->number) : std::string());
  std::string small;
  std::string places;
  std::string times;
  for (const GazePlot& plot : report.plots) {
    const bool is_place = plot.name == "scanpath" || plot.name == "heat_map";
    (is_place ? places : plot.is_wide ? times : small) += figure(plot);
  }
  const std::string kind = log.kind == GazeKind::direction ? "directions from the head" : "gaze on a screen";
  return fill_template(gaze_page_html, {{"title", escaped("Gaze of " + name)},
                                        {"style", std::string(gaze_page_style)},
                                        {"facts", escaped(fmt::format("{}, {}", log.format, kind))},
                                        {"warnings", warnings_of(log, report)},
                                        {"quality", quality_table(report.quality)},
                                        {"events", events_table(log, report.events)},
                                        {"event_plots", small},
                                        {"place_plots", places},
                                        {"time_plots", times},
                                        {"method", method_of(report.events)},
                                        {"program", fmt::format("gazetrace {}", kVersion)}});
}

namespace {

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

std::string gaze_report_json(const GazeLog& log, const GazeReport& report) {
  Json quality = Json::array();
  for (const GazeQuality& q : report.quality) {
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
    const std::vector<double> ms = durations_ms(log, report.events, movement);
    const std::vector<double> deg = amplitudes_deg(report.events, movement);
    events[std::string(to_string(movement))] = {{"count", ms.size()},
                                                {"duration_ms_q1", number(quantile(ms, 0.25))},
                                                {"duration_ms_median", number(quantile(ms, 0.5))},
                                                {"duration_ms_q3", number(quantile(ms, 0.75))},
                                                {"amplitude_deg_median", number(quantile(deg, 0.5))}};
  }
  const MainSequence& m = report.main_sequence;
  Json json{{"source", file_name(log.source)},
            {"method", report.events.preset},
            {"quality", std::move(quality)},
            {"events", std::move(events)},
            {"main_sequence",
             {{"saccades", m.saccades},
              {"factor", number(m.factor)},
              {"exponent", number(m.exponent)},
              {"correlation", number(m.correlation)}}},
            {"vergence", vergence_json(report.vergence)},
            {"pupil_unit", log.pupil_unit},
            {"warnings", report.warnings}};
  if (log.trial) {
    json["trial"] = log.trial->number;
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
