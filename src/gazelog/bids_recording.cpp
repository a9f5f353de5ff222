// SPDX-License-Identifier: Apache-2.0
#include "gazelog/bids_recording.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "gazelog/columns.hpp"
#include "gazelog/log_file.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

BidsColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, UsedColumns& used) {
  const auto need = [&](const std::string& declared, std::initializer_list<std::string_view> names) {
    if (!declared.empty()) {
      return declared_column(table, declared);
    }
    if (const auto found = table.find_any(names)) {
      return *found;
    }
    throw Error(ErrorKind::input, table.place, fmt::format("the sidecar's Columns have no '{}'", *names.begin()),
                "its columns are: " + column_listing(table));
  };
  BidsColumns c;
  c.time = *used.use(need(options.columns.time, {"timestamp", "time", "eye_timestamp", "eye1_timestamp"}));
  c.x = need(options.columns.x, {"x_coordinate", "eye1_x_coordinate", "eye2_x_coordinate"});
  c.y = need(options.columns.y, {"y_coordinate", "eye1_y_coordinate", "eye2_y_coordinate"});
  c.pupil = used.use(table.find_any({"pupil_size", "eye1_pupil_size", "eye2_pupil_size"}));
  c.x_name = table.headings[c.x].text;
  c.y_name = table.headings[c.y].text;
  if (options.columns.x.empty() && options.columns.y.empty()) {
    const auto has = [&](const char* name) { return table.find(name).has_value(); };
    c.z = used.find("direction_z");
    c.is_direction = has("direction_x") && has("direction_y") && c.z;
    c.is_fraction = !c.is_direction && has("display_x") && has("display_y");
    if (c.is_direction || c.is_fraction) {
      c.x = *table.find(c.is_direction ? "direction_x" : "display_x");
      c.y = *table.find(c.is_direction ? "direction_y" : "display_y");
    }
    c.validity = used.find("validity");
    c.confidence = used.find("confidence");
    c.origin = {used.find("origin_x"), used.find("origin_y"), used.find("origin_z")};
  }
  used.use(c.x);
  used.use(c.y);
  return c;
}

std::optional<StatedUnit> unit_from(const std::string& text) {
  const std::string lower = to_lower(trim(text));
  if (lower == "rad" || lower == "radian" || lower == "radians") {
    return StatedUnit{PositionUnit::deg, kDegPerRad};
  }
  if (lower == "m" || lower == "meter" || lower == "metre") {
    return StatedUnit{PositionUnit::cm, 100};
  }
  const auto unit = position_unit_from(lower);
  return unit && *unit != PositionUnit::unit_vector ? std::optional(StatedUnit{*unit}) : std::nullopt;
}

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

void add_origin(RawGaze& raw, Eye eye, std::int64_t t_ns, const Vec3f& place_mm) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  EyeOrigins origins{{kUnknown, kUnknown, kUnknown}, {kUnknown, kUnknown, kUnknown}, t_ns};
  (eye == Eye::right ? origins.right_mm : origins.left_mm) = place_mm;
  raw.origins.push_back(origins);
}

// The time after so many seconds, converted digit by digit and limited to what int64 nanoseconds can hold.
std::int64_t end_of(std::int64_t begin_ns, std::string_view seconds) {
  std::int64_t length_ns = 0;
  const NumberStatus status = scaled_integer(trim(seconds), 9, length_ns);
  if (status == NumberStatus::overflow) {
    length_ns = trim(seconds).starts_with('-') ? 0 : kMost;
  }
  std::int64_t end_ns = 0;
  return status == NumberStatus::malformed || length_ns <= 0    ? begin_ns
         : __builtin_add_overflow(begin_ns, length_ns, &end_ns) ? kMost
                                                                : end_ns;
}

// Where no unit is stated, the unit in which the steps agree with SamplingFrequency.
int exponent_by_rate(const GazeFile& file, const DelimitedTable& table, std::size_t time, double rate_hz,
                     const std::string& place) {
  const std::vector<double> times = first_stamps(file, table, time);
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    steps.push_back(std::abs(times[i] - times[i - 1]));
  }
  if (!steps.empty() && rate_hz > 0) {
    const double step = upper_median(steps);
    for (const int exponent : {9, 6, 3, 0}) {
      const double ratio = step * std::pow(10.0, exponent) * 1e-9 * rate_hz;
      if (ratio > 0.5 && ratio < 2) {
        return exponent;
      }
    }
  }
  throw Error(ErrorKind::input, place, "the sidecar does not state the timestamp's Units",
              "give `time-unit`, or write \"timestamp\": {\"Units\": \"ms\"} into it");
}

}  // namespace

std::string read_bids_table(const std::string& path, std::uint64_t most_unpacked_bytes) {
  std::string bytes = read_file_bytes(path);
  return utf8_text(is_gzip(bytes) ? unpack_gzip(bytes, path, most_unpacked_bytes) : std::move(bytes));
}

Eye recorded_eye(const Sidecars& sidecars) {
  const std::string eye = to_lower(sidecars.text("RecordedEye"));
  return eye == "left" ? Eye::left : eye == "right" ? Eye::right : Eye::cyclopean;
}

std::string bids_coordinate_system(const Sidecars& sidecars) {
  const std::string space = sidecars.text("SampleCoordinateSystem");
  return space.empty() ? "gaze-on-screen" : space;
}

BidsColumns read_bids_samples(const GazeFile& file, const Sidecars& sidecars, const GazeReadOptions& options,
                              RawGaze& raw) {
  std::vector<std::string> names = sidecars.texts("Columns");
  if (names.empty()) {
    throw Error(ErrorKind::input, file.path, "no sidecar names its Columns",
                "put the ..._physio.json beside it, or name the columns: `format` generic `time-column` 1 "
                "`x-column` 2 `y-column` 3");
  }
  DelimitedTable table = open_headerless(file.text, '\t', names);
  table.place = file.path;
  UsedColumns used(table);
  BidsColumns c = find_columns(table, options, used);
  std::vector<std::string_view> first;
  LineReader lines(file.text);
  std::string_view line;
  if (lines.next(line)) {
    split_cells(line, '\t', first);
    if (c.time < first.size() && !number_from(trim(first[c.time])) && !is_missing(trim(first[c.time]))) {
      raw.warnings.push_back(file.path + ": has a header line, as drafts had it; the sidecar's names are used");
      table.body = lines.rest();
      table.lines_above = 1;
    }
  }
  const std::string& time_name = names[c.time];
  const auto stated = time_exponent(sidecars.text(time_name + ".Units"));
  const int exponent = stated ? *stated
                       : options.columns.time_unit != TimeUnit::automatic
                           ? 9
                           : exponent_by_rate(file, table, c.time, raw.nominal_rate_hz, file.path);
  const TimeScale scale =
      declare_time(raw, options, time_name, exponent, stated ? Evidence::sidecar : Evidence::statistics, file.path);
  if (c.pupil) {
    const std::string measure = sidecars.text(names[*c.pupil] + ".Measure");  // area or diameter, in no unit
    raw.pupil_unit = measure.empty() ? sidecars.text(names[*c.pupil] + ".Units") : measure;
  }
  const Eye eye = recorded_eye(sidecars);
  TableRows rows(file, table, used.needed());
  while (rows.next()) {
    rows.check_length();
    RawSample sample;
    sample.t_ns = rows.time_ns(c.time, scale);
    sample.row = rows.line();
    sample.eye = eye;
    sample.confidence = static_cast<float>(rows.number(c.confidence));
    sample.pupil = static_cast<float>(rows.number(c.pupil));
    sample.at.x = rows.number(c.x);
    sample.at.y = rows.number(c.y);
    if (std::isnan(sample.at.x) || std::isnan(sample.at.y)) {
      sample.at.x = sample.at.y = kNan;
      sample.validity = GazeValidity::lost;
    }
    if (c.validity) {
      sample.validity = validity_by_name(rows.cell(*c.validity)).value_or(sample.validity);
    }
    if (c.is_direction) {
      sample.at.z = rows.number(c.z);
    }
    if (c.origin[0] && c.origin[1] && c.origin[2]) {
      add_origin(raw, eye, sample.t_ns, to_float(rows.vector(c.origin)));
    }
    raw.rows.push_back(sample);
  }
  return c;
}

// ..._physioevents.tsv(.gz): onset in the unit of its OnsetSource, duration in seconds, trial_type, blink, message.
void read_bids_events(const Sidecars& physio, const std::string& path, RawGaze& raw) {
  const BidsName name = parse_bids_name(path);
  const std::size_t at = path.rfind("_physio.");
  if (at == std::string::npos) {
    return;
  }
  for (const char* const extension : {".tsv.gz", ".tsv"}) {
    const std::string events_path = path.substr(0, at) + "_physioevents" + extension;
    std::error_code code;
    if (!std::filesystem::exists(events_path, code)) {
      continue;
    }
    const Eye eye = recorded_eye(physio);
    if (!physio.allow_outside()) {
      check_in_data_set(path, events_path);
    }
    const Sidecars sidecars(name, "physioevents", physio.allow_outside());
    const GazeFile file{events_path, read_bids_table(events_path)};
    const DelimitedTable table = open_headerless(file.text, '\t', sidecars.texts("Columns"));
    const auto onset = table.find("onset");
    const auto exponent = time_exponent(physio.text(sidecars.text("OnsetSource") + ".Units"));
    if (!onset || !exponent) {
      raw.warnings.push_back(events_path + ": its onsets are in no known unit; left out");
      return;
    }
    const auto type = table.find("trial_type");
    const auto duration = table.find("duration");
    const auto blink = table.find("blink");
    const auto message = table.find("message");
    const auto stated = table.find("stated_duration");
    const auto amplitude = table.find("amplitude");
    const auto peak = table.find("peak_velocity");
    TableRows rows(file, table, table.headings.size());
    while (rows.next()) {
      GazeEvent event;
      event.row = rows.line();
      event.eye = eye;
      event.begin_ns = rows.time_ns(*onset, {*exponent, 0});
      event.end_ns = end_of(event.begin_ns, rows.cell(duration));
      const std::string text = to_lower(rows.cell(type));
      const bool blinks = blink && rows.cell(*blink) == "1";
      event.type = blinks               ? GazeEventType::blink
                   : text == "fixation" ? GazeEventType::fixation
                   : text == "saccade"  ? GazeEventType::saccade
                   : text == "segment"  ? GazeEventType::segment
                   : text == "trial"    ? GazeEventType::trial
                   : text == "aoi"      ? GazeEventType::aoi
                                        : GazeEventType::message;
      event.text = is_missing(rows.cell(message)) ? "" : std::string(rows.cell(message));
      if (std::int64_t stated_ns = 0; stated && scaled_integer(rows.cell(*stated), 9, stated_ns) == NumberStatus::ok) {
        event.stated_duration_ns = stated_ns;
      }
      event.stated_amplitude_deg = number_from(rows.cell(amplitude));
      event.stated_peak_velocity_deg_s = number_from(rows.cell(peak));
      raw.events.push_back(std::move(event));
    }
    return;
  }
}

StatedUnit stated_bids_unit(const Sidecars& sidecars, const BidsColumns& columns, const GazeReadOptions& options,
                            const std::string& path, RawGaze& raw, Evidence& evidence) {
  std::string x = sidecars.text(columns.x_name + ".Units");
  if (x.empty()) {
    x = sidecars.text("SampleCoordinateUnit");  // the name in drafts of the standard
  }
  const std::string y = sidecars.text(columns.y_name + ".Units");
  const auto unit = unit_from(x);
  const auto y_unit = y.empty() ? unit : unit_from(y);
  const bool is_understood = unit && y_unit && *unit == *y_unit;
  const PositionUnit given = options.columns.position_unit;
  if (given != PositionUnit::automatic && (!is_understood || unit->each != 1)) {
    evidence = Evidence::option;
    if (!x.empty()) {
      raw.warnings.push_back(fmt::format("{}: its Units of {} are '{}'; `unit` {} was given and is used", path,
                                         columns.x_name, x.substr(0, 40), to_string(given)));
    }
    return {given};
  }
  if (is_understood) {
    evidence = Evidence::sidecar;
    return *unit;
  }
  const std::string source = sidecars.source(columns.x_name + ".Units");
  throw Error(ErrorKind::input, source.empty() ? path : source,
              x.empty()             ? fmt::format("no sidecar states the Units of {}", columns.x_name)
              : x == y || y.empty() ? fmt::format("its Units of {} are '{}'", columns.x_name, x.substr(0, 40))
                                    : fmt::format("its Units are '{}' of {} and '{}' of {}", x.substr(0, 40),
                                                  columns.x_name, y.substr(0, 40), columns.y_name),
              fmt::format("give `unit`, or write \"{}\": {{\"Units\": \"pixel\"}} into it", columns.x_name));
}

}  // namespace gazetrace
