// SPDX-License-Identifier: Apache-2.0
// BIDS 1.11 eye tracking: ..._recording-<eye>_physio.tsv.gz without a header line, its sidecar, ..._physioevents.tsv.gz
// for the events of that eye, ..._events.tsv for what happened in the run, and ..._events.json with the screen.
//
// x and y are pixels, or degrees of azimuth and elevation for gaze in the head, as other programs expect them. Where
// these do not give back every bit of what was read, columns of gazetrace's own follow that do. Other such columns hold
// validity, confidence and the eye's position in the head, for which the standard has no names.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <tuple>

#include "core/atomic_file.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/eyes.hpp"
#include "gazelog/gzip.hpp"
#include "gazelog/timing.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_write.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

// An x with x / scale == value: the product or one of its neighbouring numbers, where there is one.
double inverse_of_division(double value, double scale) {
  const double product = value * scale;
  for (const double x : {product, std::nextafter(product, -HUGE_VAL), std::nextafter(product, HUGE_VAL)}) {
    if (x / scale == value) {
      return x;
    }
  }
  return product;
}

// An x with x * scale == value, found in the same way.
double inverse_of_product(double value, double scale) {
  const double quotient = value / scale;
  for (const double x : {quotient, std::nextafter(quotient, -HUGE_VAL), std::nextafter(quotient, HUGE_VAL)}) {
    if (x * scale == value) {
      return x;
    }
  }
  return quotient;
}

struct Row {
  std::int64_t t_ns = 0;
  EyeGaze gaze;
  Vec3f origin_mm{NAN, NAN, NAN};
};

// What one file holds.
struct Recording {
  Eye eye = Eye::cyclopean;
  std::vector<Row> rows;
};

Row row_of(const GazeSample& sample, GazeKind kind) {
  const Vec3d at = kind == GazeKind::direction ? sample.direction : Vec3d{sample.u, sample.v, 0};
  return {sample.t_ns, {at, sample.confidence, sample.pupil, sample.validity}, {NAN, NAN, NAN}};
}

// The gaze of each eye, and the gaze that was made from both unless one eye was taken as it is; or the only gaze there
// is, split by the eyes that its samples name.
std::vector<Recording> recordings_of(const GazeLog& log) {
  const bool has_own_rows = !chosen_eye(log).is_alone;
  std::vector<Recording> all{{Eye::left, {}}, {Eye::right, {}}, {Eye::cyclopean, {}}};
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    const EyeOrigins* const origins = log.origins.empty() ? nullptr : &log.origins[i];
    if (log.eyes.empty()) {
      Row row = row_of(sample, log.kind);
      if (origins != nullptr) {
        row.origin_mm = sample.eye == Eye::right ? origins->right_mm : origins->left_mm;
      }
      all[static_cast<std::size_t>(sample.eye)].rows.push_back(row);
      continue;
    }
    all[0].rows.push_back({sample.t_ns, log.eyes[i].left, origins != nullptr ? origins->left_mm : Row().origin_mm});
    all[1].rows.push_back({sample.t_ns, log.eyes[i].right, origins != nullptr ? origins->right_mm : Row().origin_mm});
    if (has_own_rows) {
      all[2].rows.push_back(row_of(sample, log.kind));
    }
  }
  std::erase_if(all, [](const Recording& r) { return r.rows.empty(); });
  return all;
}

template <class Number>
void append(std::string& text, Number value) {
  if (std::isnan(value)) {
    text += "\tn/a";
  } else {
    fmt::format_to(std::back_inserter(text), "\t{}", value);
  }
}

// The size of the display in pixels; 1 where it is not known, so that the values are fractions instead of pixels.
struct PixelScale {
  double width_px = 1, height_px = 1;
};

PixelScale pixel_scale(const GazeLog& log) {
  const bool sized =
      log.recording_geometry && log.recording_geometry->width_px > 0 && log.recording_geometry->height_px > 0;
  return sized && log.kind == GazeKind::screen ? PixelScale{static_cast<double>(log.recording_geometry->width_px),
                                                            static_cast<double>(log.recording_geometry->height_px)}
                                               : PixelScale{};
}

// Whether pixels give back every bit of all places.
bool are_pixels_exact(const std::vector<Recording>& recordings, GazeKind kind, const PixelScale& scale) {
  const auto survives = [](double value, double by) {
    return std::isnan(value) || inverse_of_division(value, by) / by == value;
  };
  for (const Recording& recording : recordings) {
    for (const Row& row : recording.rows) {
      if (!survives(row.gaze.at.x, scale.width_px) || !survives(row.gaze.at.y, scale.height_px)) {
        return false;
      }
    }
  }
  return kind == GazeKind::screen;
}

class RecordingWriter {
 public:
  RecordingWriter(const GazeLog& log, const Recording& recording, const PixelScale& scale, bool is_exact)
      : log_(log), recording_(recording), width_px_(scale.width_px), height_px_(scale.height_px), is_exact_(is_exact) {
    for (const Row& row : recording.rows) {
      has_pupil_ = has_pupil_ || !std::isnan(row.gaze.pupil);
      has_confidence_ = has_confidence_ || !std::isnan(row.gaze.confidence);
      has_origin_ = has_origin_ || !std::isnan(row.origin_mm.x);
    }
  }

  [[nodiscard]] std::string table() const {
    std::string text;
    for (const Row& row : recording_.rows) {
      const Vec3d& at = row.gaze.at;
      fmt::format_to(std::back_inserter(text), "{}", row.t_ns);
      if (log_.kind == GazeKind::direction) {
        append(text, std::atan2(at.x, -at.z) * kDegPerRad);
        append(text, std::atan2(at.y, std::hypot(at.x, at.z)) * kDegPerRad);
      } else {
        append(text, inverse_of_division(at.x, width_px_));
        append(text, inverse_of_division(at.y, height_px_));
      }
      if (has_pupil_) {
        append(text, row.gaze.pupil);
      }
      fmt::format_to(std::back_inserter(text), "\t{}", to_string(row.gaze.validity));
      if (has_confidence_) {
        append(text, row.gaze.confidence);
      }
      if (!is_exact_) {
        append(text, at.x);
        append(text, at.y);
        if (log_.kind == GazeKind::direction) {
          append(text, at.z);
        }
      }
      if (has_origin_) {
        append(text, row.origin_mm.x);
        append(text, row.origin_mm.y);
        append(text, row.origin_mm.z);
      }
      text += '\n';
    }
    return text;
  }

  [[nodiscard]] Json sidecar() const {
    const bool is_direction = log_.kind == GazeKind::direction;
    const std::string unit = is_direction ? "deg" : width_px_ > 1 ? "pixel" : "1";
    Json json{{kBidsWriterKey, kBidsWriter},
              {"PhysioType", "eyetrack"},
              {"SamplingFrequency", rate_hz()},
              {"StartTime", 0},
              {"RecordedEye", to_string(recording_.eye)},
              {"SampleCoordinateSystem", is_direction ? "eye-in-head" : "gaze-on-screen"}};
    if (const ChosenEye chosen = chosen_eye(log_); chosen.eye) {
      json["ChosenEye"] = to_string(*chosen.eye);  // a key of gazetrace's own: the eye whose gaze stands for both
    }
    if (log_.device) {
      json["RecordedOn"] = to_string(*log_.device);  // a key of gazetrace's own: desktop or head-mounted
    }
    if (log_.sample_age_unknown) {
      json["SampleAge"] = "unknown";  // our own
    }
    add_calibration(json);
    for (const GazeCalibration& c :
         log_.calibrations) {  // a key of gazetrace's own: ns, degrees, null where not stated
      json["Calibrations"].push_back({{"Eye", to_string(c.eye)},
                                      {"Time", c.t_ns},
                                      {"MeanError", c.mean_error_deg},
                                      {"MaxError", c.max_error_deg}});
    }
    json["Columns"] = {"timestamp", "x_coordinate", "y_coordinate"};
    json["timestamp"] = {{"Units", "ns"}, {"Origin", log_.clock}};
    json["x_coordinate"] = {{"Units", unit}};
    json["y_coordinate"] = {{"Units", unit}};
    const auto add = [&](const char* name, const std::string& units, const char* description) {
      json["Columns"].push_back(name);
      json[name] = {{"Description", description}};
      if (!units.empty()) {
        json[name]["Units"] = units;
      }
    };
    if (is_direction) {
      json["x_coordinate"]["Description"] = "Azimuth to the right";
      json["y_coordinate"]["Description"] = "Elevation";
    }
    if (has_pupil_) {
      add_pupil(json);
    }
    add("validity", "", "ok, low_confidence, blink, lost, off_screen or interpolated");
    if (has_confidence_) {
      add("confidence", "", "0 to 1");
    }
    if (!is_exact_ && !is_direction) {
      add("display_x", "1", "Fraction of the display from its left edge; every digit of x_coordinate");
      add("display_y", "1", "Fraction of the display from its top edge; every digit of y_coordinate");
    }
    if (is_direction) {
      add("direction_x", "", "Unit vector, to the right");
      add("direction_y", "", "Unit vector, up");
      add("direction_z", "", "Unit vector, backward: forward is -1");
    }
    if (has_origin_) {
      add("origin_x", "mm", "The eye in the head, to the right");
      add("origin_y", "mm", "The eye in the head, up");
      add("origin_z", "mm", "The eye in the head, backward");
    }
    return json;
  }

 private:
  // The standard asks whether it is an area or a diameter. EyeLink's areas and diameters have no unit.
  void add_pupil(Json& json) const {
    const std::string& unit = log_.pupil_unit;
    const bool is_bare = unit == "area" || unit == "diameter";
    json["Columns"].push_back("pupil_size");
    json["pupil_size"] = {{"Description", unit == "area" ? "The area of the pupil, as the tracker gives it"
                                          : unit.empty()
                                              ? "The pupil, as the tracker gives it; the log does not state whether "
                                                "it is an area or a diameter"
                                              : "The diameter of the pupil, as the tracker gives it"}};
    if (!unit.empty()) {
      json["pupil_size"]["Units"] = is_bare ? "arbitrary" : unit;
    }
    if (is_bare) {
      json["pupil_size"]["Measure"] = unit;  // a key of gazetrace's own
    }
  }

  // By the standard's names, which have room for one: the last that was measured for this eye.
  void add_calibration(Json& json) const {
    const GazeCalibration* last = nullptr;
    int count = 0;
    for (const GazeCalibration& c : log_.calibrations) {
      if (c.eye == recording_.eye || c.eye == Eye::cyclopean) {
        last = &c;
        ++count;
      }
    }
    if (last == nullptr) {
      return;
    }
    json["CalibrationCount"] = count;
    if (!std::isnan(last->mean_error_deg)) {
      json["AverageCalibrationError"] = last->mean_error_deg;
    }
    if (!std::isnan(last->max_error_deg)) {
      json["MaximalCalibrationError"] = last->max_error_deg;
    }
  }

  [[nodiscard]] double rate_hz() const {
    // The rate comes from the mean step, because the steps of a frame log have two or three lengths, and the median
    // would be one of these.
    const double measured_hz = measure_timing(log_).mean_rate_hz;
    return log_.nominal_rate_hz > 0 ? log_.nominal_rate_hz : measured_hz > 0 ? measured_hz : 1;
  }

  const GazeLog& log_;
  const Recording& recording_;
  double width_px_, height_px_;
  bool is_exact_;
  bool has_pupil_ = false, has_confidence_ = false, has_origin_ = false;
};

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

// Tabs and line ends would break the table.
std::string one_cell(std::string text) {
  for (char& c : text) {
    c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  }
  return text.empty() ? "n/a" : text;
}

// The recording that an event belongs to: that of its eye, else that of the gaze, else the first. Messages and segments
// belong to no eye.
Eye home_of(const GazeEvent& event, const std::vector<Recording>& recordings, const std::optional<Eye>& chosen) {
  const bool moves = event.type == GazeEventType::fixation || event.type == GazeEventType::saccade ||
                     event.type == GazeEventType::blink;
  const auto has = [&](Eye eye) {
    return std::any_of(recordings.begin(), recordings.end(), [&](const Recording& r) { return r.eye == eye; });
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

EventsOfEye events_of(const GazeLog& log, Eye eye, const std::vector<Recording>& recordings) {
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
// physioevents, as the standard asks.
std::string run_events_table(const GazeLog& log) {
  struct RunEvent {
    std::int64_t begin_ns, end_ns;
    std::string_view type;
    std::string message;
  };
  std::vector<RunEvent> rows;
  for (const GazeEvent& event : log.events) {
    if (event.type == GazeEventType::segment) {
      rows.push_back({event.begin_ns, event.end_ns, "recording", {}});
    } else if (event.type == GazeEventType::message) {
      rows.push_back({event.begin_ns, event.begin_ns, "message", event.text});
    }
  }
  const std::int64_t first_ns = log.samples.front().t_ns;
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

std::string task_of(const BidsName& name) {
  for (const std::string& entity : name.entities) {
    if (entity.starts_with("task-")) {
      return entity.substr(5);
    }
  }
  return "";
}

// What the standard recommends for every sidecar of a task.
Json with_task(Json json, const BidsName& name) {
  if (const std::string task = task_of(name); !task.empty()) {
    json["TaskName"] = task;
  }
  return json;
}

Json events_sidecar(Eye eye, bool has_stated) {
  Json json{{kBidsWriterKey, kBidsWriter},
            {"Columns", {"onset", "duration", "trial_type", "blink", "message"}},
            {"Description", fmt::format("What the log states of the movements of the {} eye", to_string(eye))},
            {"OnsetSource", "timestamp"},
            {"duration", {{"Units", "s"}}},
            {"trial_type", {{"Description", "fixation, saccade, segment or aoi; n/a of blinks and messages"}}},
            {"blink", {{"Description", "1 for a blink, else 0"}}},
            {"message", {{"Description", "The words of a message, or the name of an area of interest"}}}};
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
  json["trial_type"] = {{"Description", "What happened"},
                        {"Levels",
                         {{"recording", "Gaze was recorded without a pause"},
                          {"message", "A message of the experiment or of the tracker"}}}};
  json["message"] = {{"Description", "The words of a message"}};
  return json;
}

std::string label_of(Eye eye) {
  return eye == Eye::left ? "eye1" : eye == Eye::right ? "eye2" : "cyclopean";
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

struct File {
  std::string path, bytes;
};

std::string path_of(const BidsName& name, const std::string& recording, const std::string& ending) {
  std::string file;
  for (const std::string& entity : name.entities) {
    file += entity.starts_with("recording-") ? "" : entity + "_";
  }
  file += recording.empty() ? "" : "recording-" + recording + "_";
  return (std::filesystem::path(name.folder) / (file + ending)).string();
}

std::vector<File> files_of(const GazeLog& log, const std::string& path) {
  const BidsName name = parse_bids_name(path);
  if (!is_bids_file_name(path)) {
    throw Error(ErrorKind::usage, path, "is no name of a BIDS recording",
                "give one such as sub-01_task-view_physio.tsv.gz");
  }
  if (log.kind == GazeKind::scene_camera) {
    throw Error(ErrorKind::input, log.source, "gaze on a scene camera's picture has no coordinate system in BIDS",
                "convert to gazetrace CSV, or use `gaze-frame` head");
  }
  std::vector<File> files;
  const std::vector<Recording> recordings = recordings_of(log);
  const PixelScale scale = pixel_scale(log);
  const bool is_exact = are_pixels_exact(recordings, log.kind, scale);
  for (const Recording& recording : recordings) {
    const RecordingWriter writer(log, recording, scale, is_exact);
    const std::string label = label_of(recording.eye);
    files.push_back({path_of(name, label, "physio.tsv.gz"), pack_gzip(writer.table())});
    files.push_back({path_of(name, label, "physio.json"), json_text(with_task(writer.sidecar(), name))});
    if (const EventsOfEye events = events_of(log, recording.eye, recordings); !events.events.empty()) {
      files.push_back({path_of(name, label, "physioevents.tsv.gz"), pack_gzip(events_table(events))});
      files.push_back({path_of(name, label, "physioevents.json"),
                       json_text(with_task(events_sidecar(recording.eye, events.has_stated), name))});
    }
  }
  files.push_back({path_of(name, "", "events.tsv"), run_events_table(log)});
  files.push_back({path_of(name, "", "events.json"), json_text(with_task(run_events_sidecar(log), name))});
  return files;
}

// Held by one at a time, in any process, until it is destroyed. Where a file system has no locks, nothing is held.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder)
      : descriptor_(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ >= 0) {
      ::flock(descriptor_, LOCK_EX);
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);  // which gives the lock back
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace

bool is_bids_file_name(const std::string& path) {
  const BidsName name = parse_bids_name(path);
  return name.suffix == "physio" && name.extension == ".tsv.gz" && !name.entities.empty();
}

std::vector<std::string> bids_file_names(const GazeLog& log, const std::string& path) {
  std::vector<std::string> names;
  for (const File& file : files_of(log, path)) {
    names.push_back(file.path);
  }
  return names;
}

void write_gaze_bids(const GazeLog& log, const std::string& path) {
  // The files of one conversion belong together: another one into the same folder waits for this one.
  const FolderLock lock(parse_bids_name(path).folder);
  for (const File& file : files_of(log, path)) {
    write_bytes_atomically(file.path, std::as_bytes(std::span(file.bytes)));
  }
}

}  // namespace gazetrace
