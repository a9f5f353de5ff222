// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/nan.hpp"
#include "gaze/angles.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_event_durations.hpp"
#include "gazetrace/gaze_events.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kStatedByLog = "log";  // as `events_of_log` calls it

struct Column {
  std::string name;
  double EyeEvent::*value;
};

// The filter of the velocities, by name and window: the angle between the ends of the window over the time between them
// (`angular_speed_deg_s`).
std::string velocity_filter(const EyeEvents& events) {
  return fmt::format("two_point_{:g}ms", static_cast<double>(events.settings.velocity_window_ns) * 1e-6);
}

// Our own measures. Beside events that a tracker states they carry names that keep them apart from its own.
std::vector<Column> measures(const EyeEvents& events) {
  const bool are_stated = events.preset == kStatedByLog;
  const std::string own = are_stated ? "measured_" : "";
  const std::string filter = are_stated ? velocity_filter(events) + "_" : "";
  return {{own + "amplitude_deg", &EyeEvent::amplitude_deg},
          {filter + "peak_velocity_deg_s", &EyeEvent::peak_velocity_deg_s},
          {filter + "mean_velocity_deg_s", &EyeEvent::mean_velocity_deg_s},
          {"angle_deg", &EyeEvent::angle_deg},
          {"dispersion_deg", &EyeEvent::dispersion_deg},
          {"u", &EyeEvent::u},
          {"v", &EyeEvent::v}};
}

// n samples last n steps of the clock, so that an event of one sample does not last 0 ms.
std::int64_t measured_duration_ns(const EyeEvent& event, std::int64_t step_ns) {
  return event.end_ns - event.begin_ns + step_ns;
}

// Milliseconds to the microsecond, without zeros at the end.
std::string milliseconds(std::int64_t duration_ns) {
  const std::int64_t us = duration_ns / 1000 + (duration_ns % 1000 >= 500 ? 1 : 0);
  std::string text = fmt::format("{}.{:03d}", us / 1000, us % 1000);
  text.erase(text.find_last_not_of('0') + 1);
  return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
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

std::int64_t onset_ns(const EyeEvent& event) {
  return event.stated ? event.stated->begin_ns : event.begin_ns;
}
std::int64_t offset_ns(const EyeEvent& event) {
  return event.stated ? event.stated->end_ns : event.end_ns;
}
double stated_amplitude_deg(const EyeEvent& event) {
  return event.stated ? event.stated->amplitude_deg.value_or(kNan) : kNan;
}
double stated_peak_velocity_deg_s(const EyeEvent& event) {
  return event.stated ? event.stated->peak_velocity_deg_s.value_or(kNan) : kNan;
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json events_json(const EyeEvents& events, const GazeLog& log) {
  const EventSettings& s = events.settings;
  const bool are_stated = events.preset == kStatedByLog;
  const std::vector<Column> columns = measures(events);
  const std::int64_t step_ns = event_step_ns(log);
  Json list = Json::array();
  for (const EyeEvent& event : events.events) {
    Json item{{"movement", to_string(event.movement)},
              {"onset_ns", onset_ns(event)},
              {"offset_ns", offset_ns(event)},
              {"duration_ms", std::stod(milliseconds(event_duration_ns(event, step_ns)))},
              {"first_row", row_of(log, event.first)},
              {"last_row", row_of(log, event.last)}};
    if (are_stated) {
      item["amplitude_deg"] = number(stated_amplitude_deg(event));
      item["peak_velocity_deg_s"] = number(stated_peak_velocity_deg_s(event));
      item["measured_duration_ms"] = std::stod(milliseconds(measured_duration_ns(event, step_ns)));
    }
    for (const Column& column : columns) {
      item[column.name] = number(event.*column.value);
    }
    item["direction"] = Json::array({number(event.direction.x), number(event.direction.y), number(event.direction.z)});
    list.push_back(std::move(item));
  }
  return {{"source", log.source},
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
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

// What a tracker says, where it says so; else the time from begin to end.
std::int64_t event_duration_ns(const EyeEvent& event, std::int64_t step_ns) {
  return !event.stated               ? measured_duration_ns(event, step_ns)
         : event.stated->duration_ns ? *event.stated->duration_ns
                                     : event.stated->end_ns - event.stated->begin_ns;
}

std::int64_t event_step_ns(const GazeLog& log) {
  return median_step_ns(times_of(log));
}

std::string events_as_tsv(const EyeEvents& events, const GazeLog& log) {
  const bool are_stated = events.preset == kStatedByLog;
  const std::vector<Column> columns = measures(events);
  const std::int64_t step_ns = event_step_ns(log);
  std::string text = "movement\tonset_ns\toffset_ns\tduration_ms\tfirst_row\tlast_row";
  text += are_stated ? "\tamplitude_deg\tpeak_velocity_deg_s\tmeasured_duration_ms" : "";
  for (const Column& column : columns) {
    text += "\t" + column.name;
  }
  text += "\tdx\tdy\tdz\n";
  for (const EyeEvent& event : events.events) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\t{}", to_string(event.movement), onset_ns(event),
                   offset_ns(event), milliseconds(event_duration_ns(event, step_ns)), row_of(log, event.first),
                   row_of(log, event.last));
    if (are_stated) {
      append_number(text, stated_amplitude_deg(event));
      append_number(text, stated_peak_velocity_deg_s(event));
      text += "\t" + milliseconds(measured_duration_ns(event, step_ns));
    }
    for (const Column& column : columns) {
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
  return text_of(events_json(events, log));
}

std::string events_as_json(const EyeEvents& events, const GazeLog& log, const std::vector<EventDoubt>& doubts) {
  Json json = events_json(events, log);
  json["doubts"] = Json::array();
  for (const EventDoubt& doubt : doubts) {
    json["doubts"].push_back({{"code", doubt.code}, {"what", doubt.what}});
  }
  return text_of(json);
}

}  // namespace gazetrace
