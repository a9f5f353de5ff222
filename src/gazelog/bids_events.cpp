// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>

#include "gazelog/bids_parts.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/eyes.hpp"

namespace gazetrace {
namespace {

using Json = BidsJson;

// Tabs and line ends would break the table.
std::string one_cell(std::string text) {
  for (char& c : text) {
    c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  }
  return text.empty() ? "n/a" : text;
}

// The recording that an event belongs to: that of its eye, else that of the gaze, else the first. Messages and segments
// belong to no eye.
Eye home_of(const GazeEvent& event, const std::vector<BidsRecording>& recordings, const std::optional<Eye>& chosen) {
  const bool moves = event.type == GazeEventType::fixation || event.type == GazeEventType::saccade ||
                     event.type == GazeEventType::blink;
  const auto has = [&](Eye eye) {
    return std::any_of(recordings.begin(), recordings.end(), [&](const BidsRecording& r) { return r.eye == eye; });
  };
  return !moves ? recordings.front().eye : has(event.eye) ? event.eye : chosen ? *chosen : recordings.front().eye;
}

// What a tracker states of an event besides its begin and end.
bool has_stated(const GazeEvent& event) {
  return event.stated_duration_ns || event.stated_amplitude_deg || event.stated_peak_velocity_deg_s;
}

// The events of one recording, and whether any of them has columns of stated values.
struct EventsOfEye {
  std::vector<const GazeEvent*> events;
  bool has_stated = false;
};

EventsOfEye events_of(const GazeLog& log, Eye eye, const std::vector<BidsRecording>& recordings) {
  const std::optional<Eye> chosen = chosen_eye(log).eye;
  EventsOfEye found;
  for (const GazeEvent& event : log.events) {
    if (home_of(event, recordings, chosen) == eye) {
      found.events.push_back(&event);
      found.has_stated = found.has_stated || has_stated(event);
    }
  }
  return found;
}

bool has_trials(const GazeLog& log) {
  return std::any_of(log.events.begin(), log.events.end(),
                     [](const GazeEvent& event) { return event.type == GazeEventType::trial; });
}

// Seconds with as many digits as there are nanoseconds.
std::string seconds(std::int64_t ns) {
  const auto magnitude = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  return fmt::format("{}{}.{:09d}", ns < 0 ? "-" : "", magnitude / 1'000'000'000, magnitude % 1'000'000'000);
}

std::string events_table(const EventsOfEye& of_eye) {
  std::string text;
  const auto or_missing = [](const std::optional<double>& value) { return value ? fmt::format("{}", *value) : "n/a"; };
  for (const GazeEvent* const e : of_eye.events) {
    const GazeEvent& event = *e;
    // Unsigned, because the longest duration does not fit into the type of the times.
    const std::uint64_t length_ns = event.end_ns > event.begin_ns ? static_cast<std::uint64_t>(event.end_ns) -
                                                                        static_cast<std::uint64_t>(event.begin_ns)
                                                                  : 0;
    const bool is_blink = event.type == GazeEventType::blink;
    const bool is_message = event.type == GazeEventType::message;
    fmt::format_to(std::back_inserter(text), "{}\t{}.{:09d}\t{}\t{}\t{}", event.begin_ns, length_ns / 1'000'000'000,
                   length_ns % 1'000'000'000, is_blink || is_message ? std::string_view("n/a") : to_string(event.type),
                   is_blink ? "1" : "0", one_cell(event.text));
    if (of_eye.has_stated) {
      fmt::format_to(std::back_inserter(text), "\t{}\t{}\t{}",
                     event.stated_duration_ns ? seconds(*event.stated_duration_ns) : "n/a",
                     or_missing(event.stated_amplitude_deg), or_missing(event.stated_peak_velocity_deg_s));
    }
    text += '\n';
  }
  return text;
}

std::string seconds_since(std::int64_t t_ns, std::int64_t first_ns) {
  std::int64_t since_ns = 0;
  return __builtin_sub_overflow(t_ns, first_ns, &since_ns) ? "n/a" : seconds(since_ns);
}

// What happened in the run: when it was recorded, and the messages of the experiment. What the eye did stands in
// physioevents, as the standard asks; so do all messages. Those of more than a minute before the first sample, such as
// EyeLink's at the start of its file, are no events of the run, and the official validator suspects them of being
// damaged.
std::string run_events_table(const GazeLog& log) {
  struct RunEvent {
    std::int64_t begin_ns, end_ns;
    std::string_view type;
    std::string message;
  };
  constexpr std::int64_t kMinuteNs = 60'000'000'000;
  const std::int64_t first_ns = log.samples.front().t_ns;
  const auto is_long_before = [&](std::int64_t t_ns) {
    std::int64_t before_ns = 0;
    return t_ns < first_ns && (__builtin_sub_overflow(first_ns, t_ns, &before_ns) || before_ns > kMinuteNs);
  };
  std::vector<RunEvent> rows;
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::segment) {
      rows.push_back({event.begin_ns, event.end_ns, "recording", {}});
    } else if (event.type == GazeEventType::trial) {
      rows.push_back({event.begin_ns, event.end_ns, "trial", event.text});
    } else if (event.type == GazeEventType::message && !is_long_before(event.begin_ns)) {
      rows.push_back({event.begin_ns, event.begin_ns, "message", event.text});
    }
  }
  if (std::none_of(rows.begin(), rows.end(), [](const RunEvent& row) { return row.type == "recording"; })) {
    rows.push_back({first_ns, log.samples.back().t_ns, "recording", {}});
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const RunEvent& a, const RunEvent& b) { return a.begin_ns < b.begin_ns; });
  std::string text = "onset\tduration\ttrial_type\tmessage\n";
  for (const RunEvent& row : rows) {
    text += fmt::format("{}\t{}\t{}\t{}\n", seconds_since(row.begin_ns, first_ns),
                        seconds_since(row.end_ns, row.begin_ns), row.type, one_cell(row.message));
  }
  return text;
}

Json screen_json(const GazeLog& log) {
  Json screen;
  if (log.recording_geometry) {
    const DisplayGeometry& g = *log.recording_geometry;
    if (g.width_px > 0 && g.height_px > 0) {
      screen["ScreenResolution"] = {g.width_px, g.height_px};
    }
    // Metres for the standard, and a key of gazetrace's own for centimetres that metres do not give back to the last
    // bit.
    if (g.width_cm > 0 && g.height_cm > 0) {
      const double width_m = inverse_of_product(g.width_cm, 100);
      const double height_m = inverse_of_product(g.height_cm, 100);
      screen["ScreenSize"] = {width_m, height_m};
      if (width_m * 100 != g.width_cm || height_m * 100 != g.height_cm) {
        screen["ScreenSizeCm"] = {g.width_cm, g.height_cm};
      }
    }
    if (g.distance_cm > 0) {
      const double distance_m = inverse_of_product(g.distance_cm, 100);
      screen["ScreenDistance"] = distance_m;
      if (distance_m * 100 != g.distance_cm) {
        screen["ScreenDistanceCm"] = g.distance_cm;
      }
    }
    if (g.eye_x_cm != 0 || g.eye_y_cm != 0) {
      screen["EyeOffsetCm"] = {g.eye_x_cm, g.eye_y_cm};
    }
  }
  if (log.kind == GazeKind::screen) {
    screen["ScreenOrigin"] = {"top", "left"};
  }
  if (log.pixels_per_degree) {
    screen["PixelsPerDegree"] = {log.pixels_per_degree->x, log.pixels_per_degree->y};
  }
  return screen;
}

Json events_sidecar(Eye eye, bool has_stated, bool has_trials) {
  Json json{{kBidsWriterKey, kBidsWriter},
            {"Columns", {"onset", "duration", "trial_type", "blink", "message"}},
            {"Description", fmt::format("Movements of the {} eye as the log states them", to_string(eye))},
            {"OnsetSource", "timestamp"},
            {"duration", {{"Units", "s"}}},
            {"trial_type",
             {{"Description", has_trials ? "fixation, saccade, segment, trial or aoi; n/a of blinks and messages"
                                         : "fixation, saccade, segment or aoi; n/a of blinks and messages"}}},
            {"blink", {{"Description", "1 for a blink, else 0"}}},
            {"message",
             {{"Description", has_trials ? "The words of a message, or the name of a trial or of an area of interest"
                                         : "The words of a message, or the name of an area of interest"}}}};
  if (has_stated) {
    for (const auto& [column, unit, what] :
         {std::tuple("stated_duration", "s", "The duration by the tracker, which may count the last sample's own time"),
          std::tuple("amplitude", "deg", "The amplitude by the tracker"),
          std::tuple("peak_velocity", "deg/s", "The peak velocity by the tracker")}) {
      json["Columns"].push_back(column);
      json[column] = {{"Description", what}, {"Units", unit}};
    }
  }
  return json;
}

Json run_events_sidecar(const GazeLog& log) {
  Json json{{kBidsWriterKey, kBidsWriter}};
  if (const Json screen = screen_json(log); !screen.is_null()) {
    json["StimulusPresentation"] = screen;
  } else {
    json["StimulusPresentation"] = {{"Description", "Gaze in the head: no screen is described"}};
  }
  json["trial_type"] = {{"Description", "Kind of event"},
                        {"Levels",
                         {{"recording", "Gaze was recorded without a pause"},
                          {"message", "A message of the experiment or of the tracker"}}}};
  if (has_trials(log)) {
    json["trial_type"]["Levels"]["trial"] = "A trial, of which the message is the name";
  }
  json["message"] = {{"Description", "The words of a message"}};
  return json;
}

}  // namespace

BidsEvents bids_events_of_eye(const GazeLog& log, Eye eye, const std::vector<BidsRecording>& recordings) {
  const EventsOfEye events = events_of(log, eye, recordings);
  return {events_table(events), events_sidecar(eye, events.has_stated, has_trials(log))};
}

BidsEvents bids_run_events(const GazeLog& log) {
  return {run_events_table(log), run_events_sidecar(log)};
}

}  // namespace gazetrace
