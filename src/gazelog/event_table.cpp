// SPDX-License-Identifier: Apache-2.0
// Columns after the exports of Pupil Player and Pupil Cloud (fixations.csv, saccades.csv, blinks.csv,
// surface_positions.csv, imu.csv), Gazepoint Analysis (User N_fixations.csv), EyeLink Data Viewer (fixation and saccade
// reports), SMI BeGaze (event statistics), Tobii's fixation exports, BIDS, and 'gaze events' itself.
#include "gazelog/log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/text.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {
namespace {

// Where a row's event begins, and where it ends or how long it lasts.
struct EventColumns {
  OptionalColumn begin, end, duration, type, eye;
  OptionalColumn amplitude_deg, peak_deg_s;
  int begin_exponent = 9, end_exponent = 9, duration_exponent = 9;
  std::string kind;         // "fixations", "saccades", "blinks" or "events"
  bool is_certain = false;  // the columns are those of a known export

  [[nodiscard]] bool found() const { return begin && (end || duration); }
};

int exponent_of(const DelimitedTable& table, std::size_t column, int otherwise) {
  return time_exponent(table.headings[column].unit).value_or(otherwise);
}

std::string kind_of(const DelimitedTable& table) {
  for (const auto& [word, kind] :
       {std::pair("fixation", "fixations"), std::pair("fix", "fixations"), std::pair("saccade", "saccades"),
        std::pair("sac", "saccades"), std::pair("blink", "blinks")}) {
    for (const ColumnHeading& heading : table.headings) {
      const std::string name = to_lower(heading.text);
      if (name.starts_with(word) || name.find(fmt::format("_{}_", word)) != std::string::npos) {
        return kind;
      }
    }
  }
  return "events";
}

EventColumns with(const DelimitedTable& table, std::string_view begin, std::string_view end, std::string_view duration,
                  int exponent, int duration_exponent, std::string kind, bool is_certain) {
  EventColumns c;
  c.begin = table.find(begin);
  c.end = end.empty() ? std::nullopt : table.find(end);
  c.duration = duration.empty() ? std::nullopt : table.find(duration);
  c.begin_exponent = c.begin ? exponent_of(table, *c.begin, exponent) : exponent;
  c.end_exponent = c.end ? exponent_of(table, *c.end, c.begin_exponent) : exponent;
  c.duration_exponent = c.duration ? exponent_of(table, *c.duration, duration_exponent) : duration_exponent;
  c.kind = std::move(kind);
  c.is_certain = is_certain;
  return c;
}

// Each row of a Gazepoint fixation table has an id of its own; in a table of gaze, many rows in turn have one.
bool every_row_has_its_own_id(const GazeFile& file, const DelimitedTable& table, std::size_t id) {
  constexpr std::size_t kEnough = 200;
  std::set<std::string, std::less<>> seen;
  std::size_t count = 0;
  TableRows rows(file, table, id + 1);
  while (count < kEnough && rows.next()) {
    ++count;
    seen.emplace(rows.cell(id));
  }
  return count >= 2 && seen.size() == count;
}

EventColumns find_columns(const GazeFile& file, const DelimitedTable& table) {
  EventColumns c;
  if (table.has_all({"movement", "onset_ns", "offset_ns"})) {
    c = with(table, "onset_ns", "offset_ns", "", 0, 0, "events", true);
    c.type = table.find("movement");
  } else if (table.has_all({"start timestamp [ns]", "end timestamp [ns]"})) {
    c = with(table, "start timestamp [ns]", "end timestamp [ns]", "", 0, 0, kind_of(table), true);
  } else if (table.has_all({"start_timestamp", "duration", "dispersion"})) {
    c = with(table, "start_timestamp", "", "duration", 9, 6, "fixations", true);  // Pupil Core: s, and ms
  } else if (table.has_all({"start_timestamp", "end_timestamp", "duration"})) {
    c = with(table, "start_timestamp", "end_timestamp", "", 9, 9, "blinks", true);
  } else if (table.has_all({"FPOGID", "FPOGS", "FPOGD"}) &&
             every_row_has_its_own_id(file, table, *table.find("FPOGID"))) {
    c = with(table, "FPOGS", "", "FPOGD", 9, 9, "fixations", true);
  } else if (table.has_all({"CURRENT_FIX_START", "CURRENT_FIX_END"})) {
    c = with(table, "CURRENT_FIX_START", "CURRENT_FIX_END", "", 6, 6, "fixations", true);
  } else if (table.has_all({"CURRENT_SAC_START_TIME", "CURRENT_SAC_END_TIME"})) {
    c = with(table, "CURRENT_SAC_START_TIME", "CURRENT_SAC_END_TIME", "", 6, 6, "saccades", true);
  } else if (table.has_all({"Event Start Trial Time [ms]", "Event End Trial Time [ms]"})) {
    c = with(table, "Event Start Trial Time [ms]", "Event End Trial Time [ms]", "", 6, 6, "events", true);
    c.type = table.find("Category");
  } else {
    // Tables of one's own: a begin, and an end or a duration.
    for (const char* const begin : {"onset", "start", "begin", "start time", "fixation start", "start_timestamp"}) {
      for (const auto& [end, duration] :
           {std::pair("offset", ""), std::pair("end", ""), std::pair("end time", ""), std::pair("fixation end", ""),
            std::pair("", "duration"), std::pair("", "fixation duration")}) {
        if (!c.found()) {
          c = with(table, begin, end, duration, 9, 9, kind_of(table), false);
        }
      }
    }
    c.type = table.find_any({"trial_type", "type", "movement", "event", "event type", "label"});
  }
  c.eye = table.find("eye");
  c.amplitude_deg = table.find_any({"amplitude [deg]", "amplitude_deg", "CURRENT_SAC_AMPLITUDE"});
  c.peak_deg_s = table.find_any({"peak_velocity_deg_s", "peak velocity [deg/s]", "CURRENT_SAC_PEAK_VELOCITY"});
  return c;
}

bool is_table(const GazeFile& file) {
  LineReader lines(head_of(file));
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (!text.empty() && text.front() != '#') {
      return text.find('\0') == std::string_view::npos && text.find_first_of(",;\t") != std::string_view::npos &&
             text.front() != '{';
    }
  }
  return false;
}

std::optional<GazeEventType> type_of(std::string_view text) {
  const std::string lower = to_lower(text);
  return lower.starts_with("fix")     ? std::optional(GazeEventType::fixation)
         : lower.starts_with("sac")   ? std::optional(GazeEventType::saccade)
         : lower.starts_with("blink") ? std::optional(GazeEventType::blink)
                                      : std::nullopt;
}

Eye eye_of(std::string_view text) {
  const std::string lower = to_lower(text);
  return lower.starts_with('l') ? Eye::left : lower.starts_with('r') ? Eye::right : Eye::cyclopean;
}

}  // namespace

void refuse_other_tables(const GazeFile& file, bool is_named) {
  if (!is_table(file)) {
    return;
  }
  const DelimitedTable table = open_table(file);
  const auto has = [&](std::string_view words) {
    return std::any_of(table.headings.begin(), table.headings.end(), [&](const ColumnHeading& heading) {
      return to_lower(heading.text).find(words) != std::string::npos;
    });
  };
  if ((has("top left x") && has("bottom right x")) || has("img_to_surf_trans")) {
    throw Error(
        ErrorKind::input, table.place, "holds the corners of a surface in the scene camera's picture, and no gaze",
        "read the gaze on that surface: gaze_positions_on_surface_<name>.csv of Pupil Player, or gaze.csv of Pupil "
        "Cloud's Marker Mapper");
  }
  if (has("gyro x") && has("acceleration x") && !has("gaze")) {
    throw Error(ErrorKind::input, table.place, "holds movements of the head (IMU), and no gaze",
                "read the gaze that was exported beside it");
  }
  const bool has_gaze = has("gaze x") || has("gaze_x") || has("gaze position") || has("gaze point") || has("bpogx") ||
                        has("gazepoint") || has("por x");
  const EventColumns c = find_columns(file, table);
  if (!c.found() || (has_gaze && c.kind != "fixations" && !c.is_certain) || (is_named && !c.is_certain)) {
    return;
  }
  throw Error(
      ErrorKind::input, table.place,
      fmt::format("is a table of {} with one row for each ('{}', '{}'), and no gaze: what the eye did between is not "
                  "in it",
                  c.kind, table.headings[*c.begin].text, table.headings[c.end ? *c.end : *c.duration].text),
      "read the log that it was made from, and give this table as its events with `events`");
}

std::vector<GazeEvent> read_event_table(const std::string& path) {
  const GazeFile file = open_log_file(path);
  if (!is_table(file)) {
    throw Error(ErrorKind::input, path, "is no table of events", "give a CSV or TSV with a header");
  }
  const DelimitedTable table = open_table(file);
  const EventColumns c = find_columns(file, table);
  const std::optional<GazeEventType> type_of_all = type_of(c.kind);
  if (!c.found() || (!type_of_all && !c.type)) {
    throw Error(
        ErrorKind::input, table.place, "there are no columns of begin, of end or duration, and of the type of an event",
        "the columns may be called onset, offset or duration, and type, with units such as onset [ms]; they are: " +
            column_listing(table));
  }
  UsedColumns used(table);
  for (const OptionalColumn& column : {c.begin, c.end, c.duration, c.type}) {
    used.use(column);
  }
  std::vector<GazeEvent> events;
  TableRows rows(file, table, table.headings.size());
  while (rows.next()) {
    const std::optional<GazeEventType> type = c.type ? type_of(rows.cell(*c.type)) : type_of_all;
    if (!type) {
      continue;  // another movement, such as unclassified
    }
    if (rows.cell(used.needed() - 1).empty() && is_missing(rows.cell(*c.begin))) {
      rows.check_length();
    }
    GazeEvent event;
    event.type = *type;
    event.eye = c.eye ? eye_of(rows.cell(*c.eye)) : Eye::cyclopean;
    event.row = rows.line();
    event.begin_ns = rows.time_ns(*c.begin, {c.begin_exponent, 0});
    if (c.end) {
      event.end_ns = rows.time_ns(*c.end, {c.end_exponent, 0});
    } else {
      event.stated_duration_ns = rows.time_ns(*c.duration, {c.duration_exponent, 0});
      if (__builtin_add_overflow(event.begin_ns, *event.stated_duration_ns, &event.end_ns)) {
        rows.fail("the event ends beyond int64 nanoseconds", "mend the row");
      }
    }
    event.stated_amplitude_deg = number_from(rows.cell(c.amplitude_deg));
    event.stated_peak_velocity_deg_s = number_from(rows.cell(c.peak_deg_s));
    if (event.end_ns < event.begin_ns) {
      rows.fail("the event ends before it begins", "mend the row");
    }
    events.push_back(std::move(event));
  }
  return events;
}

void take_events(const std::string& path, RawGaze& raw) {
  std::vector<GazeEvent> events = read_event_table(path);
  if (raw.rows.empty()) {
    return;
  }
  const auto ends = std::minmax_element(raw.rows.begin(), raw.rows.end(),
                                        [](const RawSample& a, const RawSample& b) { return a.t_ns < b.t_ns; });
  const std::int64_t first_ns = ends.first->t_ns;
  const std::int64_t last_ns = ends.second->t_ns;
  const std::size_t all = events.size();
  std::erase_if(events, [&](const GazeEvent& e) { return e.end_ns < first_ns || e.begin_ns > last_ns; });
  if (events.empty()) {
    throw Error(ErrorKind::input, path, fmt::format("none of its {} events lies within the log's time", all),
                "are both of one recording, with times on one clock?");
  }
  if (events.size() < all) {
    raw.warnings.push_back(
        fmt::format("{}: {} of {} events lie outside the log's time; left out", path, all - events.size(), all));
  }
  const std::size_t replaced = std::erase_if(raw.events, [&](const GazeEvent& own) {
    return std::any_of(events.begin(), events.end(), [&](const GazeEvent& e) { return e.type == own.type; });
  });
  if (replaced > 0) {
    raw.warnings.push_back(
        fmt::format("{}: its events take the place of {} that the log states itself", path, replaced));
  }
  raw.events.insert(raw.events.end(), events.begin(), events.end());
}

}  // namespace gazetrace
