// SPDX-License-Identifier: Apache-2.0
// BIDS 1.11 eye tracking: ..._recording-<label>_physio.tsv(.gz) without a header line; names, units and rate from the
// sidecars, which inherit; the screen from the events' sidecar; one file an eye, so the other eye's file beside it is
// read with it. Drafts are accepted with a note: _eyetrack.tsv, eye1_x_coordinate, sizes in centimetres, a header line.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/text.hpp"
#include "gaze/bids_sidecars.hpp"
#include "gaze/facts.hpp"
#include "gaze/gzip.hpp"
#include "gaze/missing_values.hpp"
#include "gaze/read_support.hpp"
#include "gaze/units.hpp"
#include "gaze/validity.hpp"

namespace gazetrace {
namespace {

struct BidsColumns {
  std::size_t time = 0, x = 0, y = 0;
  std::optional<std::size_t> pupil;
  // Of recordings that gazetrace wrote: every bit of the places, and what the standard has no name for.
  std::optional<std::size_t> z, validity, confidence, origin_x, origin_y, origin_z;
  bool is_fraction = false, is_direction = false;
  std::string x_name, y_name;

  [[nodiscard]] std::size_t needed() const {
    std::size_t last = std::max({time, x, y});
    for (const auto& column : {pupil, z, validity, confidence, origin_x, origin_y, origin_z}) {
      last = std::max(last, column.value_or(0));
    }
    return last + 1;
  }
};

std::string unpacked(const std::string& path) {
  std::string bytes = read_file_bytes(path);
  return utf8_text(is_gzip(bytes) ? unpack_gzip(bytes, path) : std::move(bytes));
}

BidsColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, const std::string& place) {
  const auto need = [&](const std::string& declared, std::initializer_list<std::string_view> names) {
    if (!declared.empty()) {
      return declared_column(table, declared, place);
    }
    if (const auto found = table.find_any(names)) {
      return *found;
    }
    throw Error(ErrorKind::input, place, fmt::format("the sidecar's Columns have no '{}'", *names.begin()),
                "its columns are: " + column_listing(table));
  };
  BidsColumns c;
  c.time = need(options.columns.time, {"timestamp", "time", "eye_timestamp", "eye1_timestamp"});
  c.x = need(options.columns.x, {"x_coordinate", "eye1_x_coordinate", "eye2_x_coordinate"});
  c.y = need(options.columns.y, {"y_coordinate", "eye1_y_coordinate", "eye2_y_coordinate"});
  c.pupil = table.find_any({"pupil_size", "eye1_pupil_size", "eye2_pupil_size"});
  c.x_name = table.headings[c.x].text;
  c.y_name = table.headings[c.y].text;
  if (!options.columns.x.empty() || !options.columns.y.empty()) {
    return c;
  }
  const auto x = table.find("display_x");
  const auto y = table.find("display_y");
  const auto dx = table.find("direction_x");
  const auto dy = table.find("direction_y");
  c.z = table.find("direction_z");
  c.is_direction = dx && dy && c.z;
  c.is_fraction = !c.is_direction && x && y;
  if (c.is_direction || c.is_fraction) {
    c.x = c.is_direction ? *dx : *x;
    c.y = c.is_direction ? *dy : *y;
  }
  c.validity = table.find("validity");
  c.confidence = table.find("confidence");
  c.origin_x = table.find("origin_x");
  c.origin_y = table.find("origin_y");
  c.origin_z = table.find("origin_z");
  return c;
}

// EyeLink's inclusive corners are often written as the size: 1919 x 1079.
void mend_resolution(DisplayGeometry& g, GazeLog& log, const std::string& place) {
  const auto is_corner = [](int n) { return n % 2 == 1 && (n + 1) % 8 == 0; };
  if (is_corner(g.width_px) && is_corner(g.height_px)) {
    log.warnings.push_back(
        fmt::format("{}: ScreenResolution {}x{} looks like inclusive corners taken for a size; {}x{} is used", place,
                    g.width_px, g.height_px, g.width_px + 1, g.height_px + 1));
    ++g.width_px;
    ++g.height_px;
  }
}

std::string screen_key(std::string_view what) {
  return fmt::format("StimulusPresentation.{}", what);
}

// ["top", "left"], in any order. None but these can be read.
PositionOrigin screen_origin(const Sidecars& events, const GazeReadOptions& options) {
  std::vector<std::string> words = events.texts(screen_key("ScreenOrigin"));
  if (words.empty()) {
    return PositionOrigin::top_left;
  }
  std::string stated;
  for (std::string& word : words) {
    word = to_lower(trim(word));
    stated += (stated.empty() ? "" : ", ") + word.substr(0, 20);
  }
  const auto is = [&](std::string_view vertical, std::string_view horizontal) {
    const auto either = [&](const std::string& word) { return word == vertical || word == horizontal; };
    return std::all_of(words.begin(), words.end(), either);
  };
  if (is("top", "left")) {
    return PositionOrigin::top_left;
  }
  if (is("bottom", "left")) {
    return PositionOrigin::bottom_left;
  }
  if (is("center", "centre")) {
    return PositionOrigin::center;
  }
  const bool from_right = is("top", "right") || is("bottom", "right");
  if (options.columns.origin != PositionOrigin::automatic) {
    return PositionOrigin::top_left;  // overruled
  }
  if (from_right && options.flip_x) {
    return is("top", "right") ? PositionOrigin::top_left : PositionOrigin::bottom_left;
  }
  throw Error(ErrorKind::input, events.source(screen_key("ScreenOrigin")),
              fmt::format("its ScreenOrigin is '{}'", stated),
              from_right ? "give --gaze-flip-x, which counts from the left what counts from the right"
                         : "top left, bottom left and center can be read; else give --gaze-origin");
}

void read_geometry(const Sidecars& events, GazeLog& log) {
  const auto& key = screen_key;
  const std::vector<double> resolution = events.numbers(key("ScreenResolution"));
  const std::vector<double> size = events.numbers(key("ScreenSize"));
  const std::vector<double> point = events.numbers(key("ScreenDistance"));
  const double distance = point.size() == 3 ? std::abs(point[2]) : events.number(key("ScreenDistance")).value_or(0);
  const std::string place = events.source(key("ScreenResolution"));
  DisplayGeometry g;
  const auto fits = [](const std::vector<double>& v, double most) {
    return v.size() == 2 && v[0] > 0 && v[1] > 0 && v[0] < most && v[1] < most;
  };
  if (fits(resolution, 1e5)) {
    g.width_px = static_cast<int>(std::lround(resolution[0]));
    g.height_px = static_cast<int>(std::lround(resolution[1]));
    mend_resolution(g, log, place);
    add_fact(log, "display size", fmt::format("{}x{} px", g.width_px, g.height_px), Evidence::sidecar, place);
  }
  if (fits(size, 1e4)) {
    // Metres; drafts had centimetres, and no screen is 5 m wide.
    const double to_cm = size[0] > 5 ? 1 : 100;
    g.width_cm = size[0] * to_cm;
    g.height_cm = size[1] * to_cm;
    if (to_cm == 1) {
      log.warnings.push_back(
          fmt::format("{}: ScreenSize {} is taken for centimetres, as drafts had it", place, size[0]));
    }
    add_fact(log, "display size", fmt::format("{:.5g} x {:.5g} cm", g.width_cm, g.height_cm), Evidence::sidecar, place);
  }
  if (distance > 0 && distance < 1e4) {
    g.distance_cm = distance > 10 ? distance : distance * 100;
    if (point.size() == 3 && (point[0] != 0 || point[1] != 0)) {
      log.warnings.push_back(fmt::format(
          "{}: of ScreenDistance [{}, {}, {}] only the last is used, for the distance; where the eye stands "
          "beside the display's center can be given with --screen-eye-cm",
          events.source(key("ScreenDistance")), point[0], point[1], point[2]));
    }
    add_fact(log, "distance", fmt::format("{:.5g} cm", g.distance_cm), Evidence::sidecar, place);
  }
  if (const std::vector<double> eye = events.numbers(key("EyeOffset")); eye.size() == 2) {  // gazetrace's own, metres
    g.eye_x_cm = eye[0] * 100;
    g.eye_y_cm = eye[1] * 100;
  }
  if (const std::vector<double> density = events.numbers(key("PixelsPerDegree"));
      density.size() == 2 && density[0] > 0 && density[1] > 0) {  // likewise
    log.pixels_per_degree = Vec2d{density[0], density[1]};
  }
  if (g.width_px > 0 || g.width_cm > 0 || g.distance_cm > 0) {
    log.recording_geometry = g;
  }
}

// A unit, and how many of it a number of the file counts.
struct StatedUnit {
  PositionUnit unit = PositionUnit::px;
  double each = 1;
};

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

// What the sidecar says of the positions' unit, or the user where it says nothing that is understood.
StatedUnit stated_unit(const Sidecars& sidecars, const BidsColumns& columns, const GazeReadOptions& options,
                       GazeLog& log, Evidence& evidence) {
  std::string x = sidecars.text(columns.x_name + ".Units");
  if (x.empty()) {
    x = sidecars.text("SampleCoordinateUnit");  // of drafts
  }
  const std::string y = sidecars.text(columns.y_name + ".Units");
  const auto unit = unit_from(x);
  const auto y_unit = y.empty() ? unit : unit_from(y);
  const bool is_understood = unit && y_unit && unit->unit == y_unit->unit && unit->each == y_unit->each;
  const PositionUnit given = options.columns.position_unit;
  if (given != PositionUnit::automatic && (!is_understood || unit->each != 1)) {
    evidence = Evidence::option;
    if (!x.empty()) {
      log.warnings.push_back(fmt::format("{}: its Units of {} are '{}'; --gaze-unit {} was given and is used",
                                         log.source, columns.x_name, x.substr(0, 40), to_string(given)));
    }
    return {given};
  }
  if (is_understood) {
    evidence = Evidence::sidecar;
    return *unit;
  }
  const std::string source = sidecars.source(columns.x_name + ".Units");
  throw Error(ErrorKind::input, source.empty() ? log.source : source,
              x.empty()             ? fmt::format("no sidecar states the Units of {}", columns.x_name)
              : x == y || y.empty() ? fmt::format("its Units of {} are '{}'", columns.x_name, x.substr(0, 40))
                                    : fmt::format("its Units are '{}' of {} and '{}' of {}", x.substr(0, 40),
                                                  columns.x_name, y.substr(0, 40), columns.y_name),
              fmt::format("give --gaze-unit, or write \"{}\": {{\"Units\": \"pixel\"}} into it", columns.x_name));
}

Eye recorded_eye(const Sidecars& sidecars) {
  const std::string eye = to_lower(sidecars.text("RecordedEye"));
  return eye == "left" ? Eye::left : eye == "right" ? Eye::right : Eye::cyclopean;
}

void add_origin(GazeLog& log, Eye eye, std::int64_t t_ns, const Vec3f& place_mm) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  EyeOrigins origins{{kUnknown, kUnknown, kUnknown}, {kUnknown, kUnknown, kUnknown}, t_ns};
  (eye == Eye::right ? origins.right_mm : origins.left_mm) = place_mm;
  log.origins.push_back(origins);
}

// Where no unit is stated: that in which the steps are what SamplingFrequency says.
int exponent_by_rate(const GazeFile& file, const DelimitedTable& table, std::size_t time, double rate_hz,
                     const std::string& place) {
  std::vector<double> times;
  TableRows rows(file, table, time + 1);
  while (times.size() < 2000 && rows.next()) {
    if (const auto value = number_from(rows.cell(time))) {
      times.push_back(*value);
    }
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    steps.push_back(std::abs(times[i] - times[i - 1]));
  }
  if (!steps.empty() && rate_hz > 0) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    for (const int exponent : {9, 6, 3, 0}) {
      const double ratio = *middle * std::pow(10.0, exponent) * 1e-9 * rate_hz;
      if (ratio > 0.5 && ratio < 2) {
        return exponent;
      }
    }
  }
  throw Error(ErrorKind::input, place, "the sidecar does not state the timestamp's Units",
              "give --gaze-time-unit, or write \"timestamp\": {\"Units\": \"ms\"} into it");
}

// Of one file into the log. Returns its columns.
BidsColumns read_samples(const GazeFile& file, const Sidecars& sidecars, const GazeReadOptions& options, GazeLog& log) {
  std::vector<std::string> names = sidecars.texts("Columns");
  if (names.empty()) {
    throw Error(ErrorKind::input, file.path, "no sidecar names its Columns",
                "put the ..._physio.json beside it, or name the columns: --gaze-format generic --gaze-time-column 1 "
                "--gaze-x-column 2 --gaze-y-column 3");
  }
  DelimitedTable table = open_headerless(file.text, '\t', names);
  const BidsColumns c = find_columns(table, options, file.path);
  std::vector<std::string_view> first;
  LineReader lines(file.text);
  std::string_view line;
  if (lines.next(line)) {
    split_cells(line, '\t', first);
    if (c.time < first.size() && !number_from(trim(first[c.time])) && !is_missing(trim(first[c.time]))) {
      log.warnings.push_back(file.path + ": has a header line, as drafts had it; the sidecar's names are used");
      table.body = lines.rest();
      table.lines_above = 1;
    }
  }
  const std::string& time_name = names[c.time];
  const auto stated = time_exponent(sidecars.text(time_name + ".Units"));
  const int exponent = stated ? *stated
                       : options.columns.time_unit != TimeUnit::automatic
                           ? 9
                           : exponent_by_rate(file, table, c.time, log.nominal_rate_hz, file.path);
  const TimeScale scale =
      choose_time_unit(log, options, time_name, exponent, stated ? Evidence::sidecar : Evidence::statistics, file.path);
  log.pupil_unit = c.pupil ? sidecars.text(names[*c.pupil] + ".Units") : "";
  const Eye eye = recorded_eye(sidecars);
  TableRows rows(file, table, c.needed());
  while (rows.next()) {
    rows.check_length();
    GazeSample sample;
    sample.t_ns = rows.time_ns(c.time, scale);
    sample.row = rows.line();
    sample.eye = eye;
    sample.confidence = static_cast<float>(rows.number(c.confidence));
    sample.pupil = static_cast<float>(rows.number(c.pupil));
    sample.u = rows.number(c.x);
    sample.v = rows.number(c.y);
    if (std::isnan(sample.u) || std::isnan(sample.v)) {
      sample.u = sample.v = kNan;
      sample.validity = GazeValidity::lost;
    }
    if (c.validity) {
      sample.validity = validity_by_name(rows.cell(*c.validity)).value_or(sample.validity);
    }
    if (c.is_direction) {
      sample.direction = {sample.u, sample.v, rows.number(c.z)};
      sample.u = sample.v = 0;
    }
    if (c.origin_x && c.origin_y && c.origin_z) {
      add_origin(log, eye, sample.t_ns,
                 to_float({rows.number(c.origin_x), rows.number(c.origin_y), rows.number(c.origin_z)}));
    }
    log.samples.push_back(sample);
  }
  return c;
}

// ..._physioevents.tsv(.gz): onset in the unit of its OnsetSource, duration in seconds, trial_type, blink, message.
void read_events(const Sidecars& physio, const std::string& path, GazeLog& log) {
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
    const Sidecars sidecars(name, "physioevents");
    const GazeFile file{events_path, unpacked(events_path)};
    const DelimitedTable table = open_headerless(file.text, '\t', sidecars.texts("Columns"));
    const auto onset = table.find("onset");
    const auto exponent = time_exponent(physio.text(sidecars.text("OnsetSource") + ".Units"));
    if (!onset || !exponent) {
      log.warnings.push_back(events_path + ": its onsets are in no known unit; left out");
      return;
    }
    const auto type = table.find("trial_type");
    const auto duration = table.find("duration");
    const auto blink = table.find("blink");
    const auto message = table.find("message");
    TableRows rows(file, table, table.headings.size());
    while (rows.next()) {
      GazeEvent event;
      event.row = rows.line();
      event.eye = eye;
      event.begin_ns = rows.time_ns(*onset, {*exponent, 0});
      const double seconds = rows.number(duration);
      event.end_ns = event.begin_ns + (seconds > 0 && seconds < 1e6 ? std::llround(seconds * 1e9) : 0);
      const std::string text = to_lower(rows.cell(type));
      const bool blinks = blink && rows.cell(*blink) == "1";
      event.type = blinks               ? GazeEventType::blink
                   : text == "fixation" ? GazeEventType::fixation
                   : text == "saccade"  ? GazeEventType::saccade
                   : text == "segment"  ? GazeEventType::segment
                                        : GazeEventType::message;
      event.text = is_missing(rows.cell(message)) ? "" : std::string(rows.cell(message));
      log.events.push_back(std::move(event));
    }
    return;
  }
}

}  // namespace

double sniff_gaze_bids(const GazeFile& file) {
  const BidsName name = parse_bids_name(file.path);
  const bool table = name.extension == ".tsv" || name.extension == ".tsv.gz";
  if (!table || (name.suffix != "physio" && name.suffix != "eyetrack")) {
    return 0.0;
  }
  const std::string_view head = head_of(file, 4096);
  std::vector<std::string_view> cells;
  split_cells(head.substr(0, head.find('\n')), '\t', cells);
  return cells.size() >= 3 ? 0.98 : 0.5;
}

GazeLog read_gaze_bids(const GazeFile& file, const GazeReadOptions& options) {
  const BidsName name = parse_bids_name(file.path);
  const Sidecars sidecars(name, name.suffix);
  GazeLog log;
  log.source = file.path;
  log.format = "bids";
  log.nominal_rate_hz = sidecars.number("SamplingFrequency").value_or(0);
  log.clock = sidecars.text("timestamp.Origin");
  if (const std::string chosen = sidecars.text("ChosenEye"); chosen == "left" || chosen == "right") {
    add_fact(log, kStatedEye, chosen, Evidence::sidecar, "chosen before it was converted");  // gazetrace's own
  }
  if (const std::string device = sidecars.text("RecordedOn"); !device.empty()) {
    add_fact(log, kDevice, device, Evidence::sidecar);  // likewise
  }
  const std::string space = sidecars.text("SampleCoordinateSystem");
  if (!space.empty() && space != "gaze-on-screen" && space != "eye-in-head") {
    throw Error(ErrorKind::input, file.path, fmt::format("its SampleCoordinateSystem is '{}'", space.substr(0, 40)),
                "gaze-on-screen and eye-in-head can be read");
  }
  const Sidecars events(name, "events");
  read_geometry(events, log);
  const BidsColumns columns = read_samples(file, sidecars, options, log);
  read_events(sidecars, file.path, log);
  std::vector<Eye> read{recorded_eye(sidecars)};
  for (const std::string& path : sibling_recordings(name, name.suffix)) {
    const Sidecars other(parse_bids_name(path), name.suffix);
    const Eye eye = recorded_eye(other);
    if (std::find(read.begin(), read.end(), eye) != read.end()) {
      continue;
    }
    read.push_back(eye);
    const GazeFile sibling{path, unpacked(path)};
    GazeLog second;
    second.nominal_rate_hz = log.nominal_rate_hz;
    const BidsColumns its = read_samples(sibling, other, options, second);
    if (its.is_direction != columns.is_direction || its.is_fraction != columns.is_fraction) {
      throw Error(ErrorKind::input, path, "says its places in other columns than the recording beside it",
                  "read one of them alone, from another folder");
    }
    log.pupil_unit = log.pupil_unit.empty() ? second.pupil_unit : log.pupil_unit;
    read_events(other, path, log);
    log.origins.insert(log.origins.end(), second.origins.begin(), second.origins.end());
    log.samples.insert(log.samples.end(), second.samples.begin(), second.samples.end());
    std::stable_sort(log.samples.begin(), log.samples.end(),
                     [](const GazeSample& a, const GazeSample& b) { return a.t_ns < b.t_ns; });
    add_fact(log, "other eye", std::filesystem::path(path).filename().string(), Evidence::sidecar, "RecordedEye");
  }
  if (columns.is_direction) {
    finish_directions(log, options, GazeAxes::gl, Evidence::sidecar, file.path);
    return log;
  }
  GazeReadOptions settled = options;
  if (space == "eye-in-head") {
    settled.frame = GazeFrame::head;
  }
  PlaceSpace places{PositionUnit::fraction, PositionOrigin::top_left, Evidence::sidecar, "display_x, display_y",
                    columns.validity.has_value()};
  if (!columns.is_fraction) {
    const StatedUnit unit = stated_unit(sidecars, columns, options, log, places.evidence);
    places.unit = unit.unit;
    places.origin = unit.unit == PositionUnit::deg ? PositionOrigin::center : screen_origin(events, options);
    const bool says_origin = !events.texts(screen_key("ScreenOrigin")).empty();
    places.origin_evidence = unit.unit == PositionUnit::deg ? places.evidence
                             : says_origin                  ? Evidence::sidecar
                                                            : Evidence::format;
    places.columns = columns.x_name + ", " + columns.y_name;
    if (unit.each != 1) {
      mark_missing_values(log, settled);  // in the unit of the file
      settled.missing_value.reset();
      for (GazeSample& sample : log.samples) {
        sample.u *= unit.each;
        sample.v *= unit.each;
      }
    }
  }
  finish_places(log, settled, places, file.path);
  return log;
}

}  // namespace gazetrace
