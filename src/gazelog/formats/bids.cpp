// SPDX-License-Identifier: Apache-2.0
// BIDS 1.11 eye tracking: a ..._recording-<label>_physio.tsv(.gz) without a header line. Names, units and rate come
// from the sidecars, which inherit, and the screen comes from the sidecar of the events. There is one file for each
// eye, so that the file of the other eye beside it is read as well. Drafts of the standard are accepted with a note:
// _eyetrack.tsv, eye1_x_coordinate, sizes in centimetres, a header line.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/text.hpp"
#include "gazelog/bids_recording.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

// A log has one unit and one space. Throws Error(input) where the recording at `path` states others than the first one.
void check_alike(const BidsColumns& columns, const Sidecars& sidecars, const BidsColumns& its, const Sidecars& other,
                 const GazeReadOptions& options, const std::string& path, RawGaze& raw) {
  const auto refuse = [&](const std::string& problem, const char* more = "") {
    throw Error(ErrorKind::input, path, problem, fmt::format("read one of them alone, from another folder{}", more));
  };
  if (its.is_direction != columns.is_direction || its.is_fraction != columns.is_fraction) {
    refuse("says its places in other columns than the recording beside it");
  }
  if (const std::string space = bids_coordinate_system(sidecars), its_space = bids_coordinate_system(other);
      space != its_space) {
    refuse(fmt::format("its SampleCoordinateSystem is '{}', and '{}' of the recording beside it",
                       its_space.substr(0, 40), space.substr(0, 40)));
  }
  if (columns.is_direction || columns.is_fraction) {
    return;
  }
  Evidence evidence = Evidence::format;
  RawGaze unsaid;  // the warnings of the first recording are given where it is finished
  if (stated_bids_unit(other, its, options, path, raw, evidence) !=
          stated_bids_unit(sidecars, columns, options, raw.source, unsaid, evidence) &&
      options.columns.position_unit == PositionUnit::automatic) {
    refuse(fmt::format("its Units of {} are '{}', and '{}' of the recording beside it", its.x_name,
                       other.text(its.x_name + ".Units").substr(0, 40),
                       sidecars.text(columns.x_name + ".Units").substr(0, 40)),
           "; or give the `unit` of both");
  }
}

// The recordings of other eyes beside the one that was opened.
void join_other_eyes(const BidsName& name, const Sidecars& sidecars, const BidsColumns& columns,
                     const GazeReadOptions& options, RawGaze& raw) {
  std::vector<Eye> read{recorded_eye(sidecars)};
  for (const std::string& path : sibling_recordings(name, name.suffix)) {
    if (!options.allow_outside) {
      check_in_data_set(raw.source, path);
    }
    const Sidecars other(parse_bids_name(path), name.suffix, options.allow_outside);
    const BidsSignal signal = recorded_signal(other, options.columns.x);
    if (signal == BidsSignal::mislabeled) {
      raw.warnings.push_back(fmt::format("{}: has positions, but its PhysioType is '{}', not eyetrack; not read", path,
                                         other.text("PhysioType").substr(0, 40)));
    }
    const Eye eye = recorded_eye(other);
    if (signal != BidsSignal::gaze) {
      continue;
    }
    if (std::find(read.begin(), read.end(), eye) != read.end()) {
      raw.warnings.push_back(
          fmt::format("{}: is a recording of the {} eye as well, and is not read; name it to read it in place of {}",
                      path, to_string(eye), file_name(raw.source)));
      continue;
    }
    read.push_back(eye);
    const GazeFile sibling{path, read_bids_table(path, options.most_unpacked_bytes)};
    RawGaze second;
    second.nominal_rate_hz = raw.nominal_rate_hz;
    const BidsColumns its = read_bids_samples(sibling, other, options, second);
    check_alike(columns, sidecars, its, other, options, path, raw);
    if (!raw.pupil_unit.empty() && !second.pupil_unit.empty() && second.pupil_unit != raw.pupil_unit) {
      raw.warnings.push_back(
          fmt::format("{}: its pupils are in '{}', and in '{}' in the recording beside it; they are "
                      "not converted",
                      path, second.pupil_unit.substr(0, 40), raw.pupil_unit.substr(0, 40)));
    }
    raw.pupil_unit = raw.pupil_unit.empty() ? second.pupil_unit : raw.pupil_unit;
    read_bids_events(other, path, raw);
    raw.origins.insert(raw.origins.end(), second.origins.begin(), second.origins.end());
    raw.rows.append(second.rows);
    raw.rows.sort_by_time();
    add_note(raw, "other eye", file_name(path), Evidence::sidecar, "RecordedEye");
  }
}

// Values that gazetrace wrote and for which the standard has no names.
void read_own_keys(const Sidecars& sidecars, RawGaze& raw) {
  if (const std::string chosen = sidecars.text("ChosenEye"); chosen == "left" || chosen == "right") {
    raw.stated_eye = chosen == "left" ? Eye::left : Eye::right;
    add_note(raw, "chosen eye", chosen, Evidence::sidecar, "chosen before it was converted");
  }
  if (const std::string device = sidecars.text("RecordedOn"); !device.empty()) {
    for (const GazeDevice known : {GazeDevice::desktop, GazeDevice::head_mounted}) {
      raw.device = device == to_string(known) ? std::optional(known) : raw.device;
    }
    add_note(raw, "device", device, Evidence::sidecar);
  }
  raw.sample_age_unknown = sidecars.text("SampleAge") == "unknown";
  for (std::size_t i = 0;; ++i) {
    const std::string key = fmt::format("Calibrations.{}.", i);
    const std::string eye = sidecars.text(key + "Eye");
    GazeCalibration calibration;
    if (eye.empty() || scaled_integer(sidecars.text(key + "Time"), 0, calibration.t_ns) != NumberStatus::ok) {
      break;
    }
    calibration.eye = eye == "left" ? Eye::left : eye == "right" ? Eye::right : Eye::cyclopean;
    calibration.mean_error_deg = sidecars.number(key + "MeanError").value_or(kNan);
    calibration.max_error_deg = sidecars.number(key + "MaxError").value_or(kNan);
    raw.calibrations.push_back(calibration);
  }
  // The standard's own names, which other writers use.
  const auto mean = sidecars.number("AverageCalibrationError");
  if (raw.calibrations.empty() && mean) {
    GazeCalibration calibration;
    calibration.eye = recorded_eye(sidecars);
    calibration.mean_error_deg = *mean;
    calibration.max_error_deg = sidecars.number("MaximalCalibrationError").value_or(kNan);
    raw.calibrations.push_back(calibration);
  }
}

}  // namespace

double sniff_gaze_bids(const GazeFile& file) {
  const BidsName name = parse_bids_name(file.path);
  if (!name.is_table() || (name.suffix != "physio" && name.suffix != "eyetrack")) {
    return 0.0;
  }
  const std::string_view head = head_of(file, 4096);
  std::vector<std::string_view> cells;
  split_cells(head.substr(0, head.find('\n')), '\t', cells);
  return cells.size() >= 3 ? 0.98 : 0.5;
}

RawGaze read_gaze_bids(const GazeFile& file, const GazeReadOptions& options) {
  const BidsName name = parse_bids_name(file.path);
  const Sidecars sidecars(name, name.suffix, options.allow_outside);
  RawGaze raw;
  raw.source = file.path;
  raw.nominal_rate_hz = sidecars.number("SamplingFrequency").value_or(0);
  raw.clock = sidecars.text("timestamp.Origin");
  read_own_keys(sidecars, raw);
  const std::string space = bids_coordinate_system(sidecars);
  if (space != "gaze-on-screen" && space != "eye-in-head") {
    throw Error(ErrorKind::input, file.path, fmt::format("its SampleCoordinateSystem is '{}'", space.substr(0, 40)),
                "gaze-on-screen and eye-in-head can be read");
  }
  const Sidecars events(name, "events", options.allow_outside);
  read_bids_screen(events, raw);
  const BidsColumns columns = read_bids_samples(file, sidecars, options, raw);
  read_bids_events(sidecars, file.path, raw);
  join_other_eyes(name, sidecars, columns, options, raw);
  if (raw.pupil_unit == "arbitrary") {  // the standard's word for no unit, told apart from others until here
    raw.pupil_unit.clear();
  }
  if (columns.is_direction) {
    declare_directions(raw, {}, GazeAxes::gl, Evidence::sidecar, file.path);
    return raw;
  }
  PlaceSpace places{PositionUnit::fraction, PositionOrigin::top_left, Evidence::sidecar, "display_x, display_y",
                    columns.validity.has_value()};
  StatedUnit unit{places.unit};
  if (!columns.is_fraction) {
    unit = stated_bids_unit(sidecars, columns, options, file.path, raw, places.evidence);
    places.unit = unit.unit;
    places.origin = unit.unit == PositionUnit::deg ? PositionOrigin::center : bids_screen_origin(events, options);
    places.origin_evidence = unit.unit == PositionUnit::deg ? places.evidence
                             : states_screen_origin(events) ? Evidence::sidecar
                                                            : Evidence::format;
    places.columns = columns.x_name + ", " + columns.y_name;
  }
  if (space == "eye-in-head") {
    raw.declared.degrees_are_directions = true;
    const bool is_given = options.columns.position_unit != PositionUnit::automatic;
    if ((is_given ? options.columns.position_unit : unit.unit) != PositionUnit::deg) {
      throw Error(ErrorKind::input, file.path,
                  fmt::format("its SampleCoordinateSystem is 'eye-in-head', but its places are in {}",
                              to_string(is_given ? options.columns.position_unit : unit.unit)),
                  "gaze in the head is read in deg and rad: mend the sidecar, or give `unit` deg");
    }
  }
  declare_places(raw, places, file.path);
  raw.declared.unit_scale = unit.each;
  return raw;
}

}  // namespace gazetrace
