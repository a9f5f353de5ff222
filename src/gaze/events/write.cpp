// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
  const char* name;
  double EyeEvent::*value;
};
constexpr Column kMeasures[] = {{"amplitude_deg", &EyeEvent::amplitude_deg},
                                {"peak_velocity_deg_s", &EyeEvent::peak_velocity_deg_s},
                                {"mean_velocity_deg_s", &EyeEvent::mean_velocity_deg_s},
                                {"angle_deg", &EyeEvent::angle_deg},
                                {"dispersion_deg", &EyeEvent::dispersion_deg},
                                {"u", &EyeEvent::u},
                                {"v", &EyeEvent::v}};

double milliseconds(const EyeEvent& event) {
  return static_cast<double>(event.end_ns - event.begin_ns) * 1e-6;
}

std::int64_t row_of(const GazeLog& log, std::size_t sample) {
  return sample < log.samples.size() ? log.samples[sample].row : 0;
}

void append_number(std::string& text, double value) {
  if (std::isnan(value)) {
    text += "\tn/a";
  } else {
    fmt::format_to(std::back_inserter(text), "\t{:.6g}", value);
  }
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

std::string events_as_tsv(const EyeEvents& events, const GazeLog& log) {
  std::string text = "movement\tonset_ns\toffset_ns\tduration_ms\tfirst_row\tlast_row";
  for (const Column& column : kMeasures) {
    text += std::string("\t") + column.name;
  }
  text += "\tdx\tdy\tdz\n";
  for (const EyeEvent& event : events.events) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\t{}", to_string(event.movement), event.begin_ns,
                   event.end_ns, milliseconds(event), row_of(log, event.first), row_of(log, event.last));
    for (const Column& column : kMeasures) {
      append_number(text, event.*column.value);
    }
    append_number(text, event.direction.x);
    append_number(text, event.direction.y);
    append_number(text, event.direction.z);
    text += '\n';
  }
  return text;
}

std::string events_as_json(const EyeEvents& events, const GazeLog& log) {
  const EventSettings& s = events.settings;
  Json list = Json::array();
  for (const EyeEvent& event : events.events) {
    Json item{{"movement", to_string(event.movement)},
              {"onset_ns", event.begin_ns},
              {"offset_ns", event.end_ns},
              {"duration_ms", milliseconds(event)},
              {"first_row", row_of(log, event.first)},
              {"last_row", row_of(log, event.last)}};
    for (const Column& column : kMeasures) {
      item[column.name] = number(event.*column.value);
    }
    item["direction"] = Json::array({number(event.direction.x), number(event.direction.y), number(event.direction.z)});
    list.push_back(std::move(item));
  }
  const Json json{{"source", log.source},
                  {"preset", events.preset},
                  {"settings",
                   {{"algorithm", s.method},
                    {"space", to_string(s.space)},
                    {"velocity_deg_s", s.velocity_deg_s},
                    {"velocity_window_ns", s.velocity_window_ns},
                    {"max_gap_ns", s.max_gap_ns},
                    {"merge_gap_ns", s.merge_gap_ns},
                    {"merge_angle_deg", s.merge_angle_deg},
                    {"min_fixation_ns", s.min_fixation_ns},
                    {"dispersion_deg", s.dispersion_deg},
                    {"start_velocity_deg_s", s.start_velocity_deg_s},
                    {"max_velocity_deg_s", s.max_velocity_deg_s},
                    {"max_acceleration_deg_s2", s.max_acceleration_deg_s2},
                    {"min_saccade_ns", s.min_saccade_ns},
                    {"dispersion_window_ns", s.dispersion_window_ns},
                    {"noise_factor", s.noise_factor},
                    {"max_microsaccade_deg", s.max_microsaccade_deg},
                    {"min_blink_ns", s.min_blink_ns},
                    {"max_blink_ns", s.max_blink_ns}}},
                  {"peak_threshold_deg_s", number(events.peak_threshold_deg_s)},
                  {"onset_threshold_deg_s", number(events.onset_threshold_deg_s)},
                  {"events", std::move(list)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
