// SPDX-License-Identifier: Apache-2.0
// Tobii Pro Lab TSV. `Recording timestamp` is in microseconds where the header is bare or says so, in milliseconds
// where it says [ms]. Rows of several sensors interleave; only those of the eye tracker are gaze. Gaze points are
// pixels of the display, `Gaze point X`, `(DACSpx)` or `[DACS px]`; media coordinates (MCS) do not say where on the
// display the medium was. Exports of glasses hold places on the scene camera's picture under the same names.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

struct EyeInLab {
  Eye eye = Eye::cyclopean;
  OptionalColumn x, y, validity, pupil;
};

struct LabColumns {
  std::size_t time = 0;
  int time_exponent = 3;
  OptionalColumn sensor, event, movement, movement_index, width, height;
  std::vector<EyeInLab> eyes;
  OptionalColumn picture_width, picture_height;  // of the scene camera's picture
  std::array<VectorColumns, 2> direction;        // of the left and the right eye, in the head
  bool is_declared = false, is_glasses = false;
};

// "Gaze point X", "Gaze point X (DACSpx)", "Gaze point X [DACS px]": of the display, or bare.
OptionalColumn display_column(const DelimitedTable& table, std::string_view name, bool is_glasses) {
  const std::string wanted = letters_and_digits(name);
  OptionalColumn bare;
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    const ColumnHeading& heading = table.headings[i];
    if (letters_and_digits(heading.name) != wanted) {
      continue;
    }
    const std::string unit = letters_and_digits(heading.unit);
    if (unit == "dacspx" || (is_glasses && (unit == "mcspx" || unit == "mcsnorm"))) {
      return i;
    }
    if (unit.empty() || unit == "px") {
      bare = i;
    }
  }
  return bare;
}

bool has_prefix(const DelimitedTable& table, std::string_view prefix) {
  return std::any_of(table.headings.begin(), table.headings.end(),
                     [&](const ColumnHeading& heading) { return heading.text.starts_with(prefix); });
}

[[noreturn]] void no_gaze_points(const DelimitedTable& table) {
  if (has_prefix(table, "Gaze point X")) {
    throw Error(ErrorKind::input, table.place,
                "its gaze points are in media coordinates (MCS), relative to what was shown, not to the display",
                "export again with DACS columns, or name the columns with `x-column` and `y-column` and give "
                "the size of the medium with `screen-px`");
  }
  const bool fixations = has_prefix(table, "Fixation point X") || has_prefix(table, "Mapped fixation X");
  throw Error(ErrorKind::input, table.place,
              fmt::format("this export has no gaze points (Gaze point X){}",
                          fixations ? ", only fixations, which leave out every saccade" : ""),
              "export again with gaze points, or name the columns to read as places with `x-column` and "
              "`y-column` and give their picture's size with `screen-px`");
}

// Glasses have an accelerometer and a gyroscope, and gaze in space or mapped onto snapshots.
bool is_of_glasses(const GazeFile& file, const DelimitedTable& table) {
  const std::string_view head = head_of(file);
  const bool has_head_units = std::any_of(table.headings.begin(), table.headings.end(),
                                          [](const ColumnHeading& h) { return to_lower(h.unit).starts_with("hucs"); });
  return has_head_units || has_prefix(table, "Gaze point 3D") || has_prefix(table, "Mapped gaze X") ||
         has_prefix(table, "Gyro") || has_prefix(table, "Accelerometer") ||
         head.find("\tGyroscope\t") != std::string_view::npos ||
         head.find("\tAccelerometer\t") != std::string_view::npos;
}

LabColumns find_columns(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                        UsedColumns& used) {
  LabColumns c;
  c.is_glasses = is_of_glasses(file, table);
  const std::size_t own_time = UsedColumns(table).require("Recording timestamp", "is this a Tobii Pro Lab export?");
  c.time = used.time(options, own_time);
  c.time_exponent = time_exponent(table.headings[c.time].unit).value_or(3);
  c.sensor = used.find("Sensor");
  c.event = used.find("Event");
  c.movement = used.find("Eye movement type");
  c.movement_index = used.find("Eye movement type index");
  c.width = used.find("Recording resolution width");
  c.height = used.find("Recording resolution height");
  if (!options.columns.x.empty()) {
    c.is_declared = true;
    c.eyes.push_back({Eye::cyclopean,
                      used.use(declared_column(table, options.columns.x)),
                      used.use(declared_column(table, options.columns.y)),
                      {},
                      {}});
  } else {
    for (const auto& [part, side, eye] : {std::tuple("", "", Eye::cyclopean), std::tuple("left ", "left", Eye::left),
                                          std::tuple("right ", "right", Eye::right)}) {
      EyeInLab columns{eye,
                       display_column(table, fmt::format("Gaze point {}X", part), c.is_glasses),
                       display_column(table, fmt::format("Gaze point {}Y", part), c.is_glasses),
                       {},
                       {}};
      if (columns.x && columns.y) {
        used.use(columns.x);
        used.use(columns.y);
        if (eye != Eye::cyclopean) {
          columns.validity = used.find(fmt::format("Validity {}", side));
          columns.pupil = used.find(fmt::format("Pupil diameter {}", side));
        }
        c.eyes.push_back(columns);
      }
    }
  }
  if (c.is_glasses) {
    c.picture_width = used.find("Recording media width");
    c.picture_height = used.find("Recording media height");
    for (std::size_t eye = 0; eye < 2; ++eye) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        c.direction[eye][axis] =
            used.find(fmt::format("Gaze direction {} {} [HUCS norm]", eye == 0 ? "left" : "right", "XYZ"[axis]));
      }
    }
  }
  if (c.eyes.empty()) {
    no_gaze_points(table);
  }
  return c;
}

}  // namespace

double sniff_gaze_tobii_pro_lab(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  if (!has("Recording timestamp") || !has("\t")) {
    return 0.0;
  }
  return has("Participant name") && (has("Sensor") || has("Gaze point") || has("Eye movement type")) ? 0.99 : 0.8;
}

RawGaze read_gaze_tobii_pro_lab(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const LabColumns c = find_columns(file, table, options, used);
  RawGaze raw = raw_of(file, "recording, from its start", "mm");
  const auto is_there = [](const VectorColumns& columns) { return columns[0] && columns[1] && columns[2]; };
  const bool has_directions = is_there(c.direction[0]) && is_there(c.direction[1]);
  const bool takes_directions = c.is_glasses && options.frame == GazeFrame::head && has_directions;
  if (takes_directions) {
    raw.kind = GazeKind::direction;
  } else if (!c.is_declared && c.is_glasses) {
    raw.way_out = has_directions
                      ? "take directions from the head with `frame` head"
                      : "export directions of gaze (HUCS), or read the glasses' own files (gazedata.gz) with "
                        "`frame` head";
    raw.kind = GazeKind::scene_camera;
  }
  const bool unit_stated = !table.headings[c.time].unit.empty();
  const TimeScale scale = declare_time(raw, options, table.headings[c.time].text, c.time_exponent,
                                       unit_stated ? Evidence::header : Evidence::format, table.place);
  RecordingColumns recordings(table, options.columns.recording, {"Participant name", "Recording name"});
  LabelRuns runs;
  std::size_t others = 0;
  TableRows rows(file, table, std::max(used.needed(), recordings.needed_cells()));
  while (rows.next()) {
    rows.check_length();
    if (recordings.note(rows, raw)) {
      runs.end();
    }
    const std::int64_t t_ns = rows.time_ns(c.time, scale);
    if (const std::string_view event = rows.cell(c.event); !event.empty()) {
      add_message(raw, t_ns, std::string(event), rows.line());
    }
    if (c.sensor && rows.cell(*c.sensor) != "Eye Tracker") {
      ++others;
      continue;
    }
    if (c.width && c.height && !raw.recording_geometry) {
      state_display_px(raw, rows.number(*c.width), rows.number(*c.height), Evidence::header,
                       "Recording resolution width and height");
    }
    if (c.picture_width && c.picture_height && !raw.picture_px) {
      const Vec2d picture{rows.number(*c.picture_width), rows.number(*c.picture_height)};
      if (picture.x >= 1 && picture.y >= 1 && picture.x < 1e5 && picture.y < 1e5) {
        raw.picture_px = picture;
      }
    }
    for (std::size_t eye = 0; takes_directions && eye < 2; ++eye) {
      RawSample sample = missing_row(t_ns, rows.line(), eye == 0 ? Eye::left : Eye::right);
      sample.at = rows.vector(c.direction[eye]);
      sample.validity = length(sample.at) > 0 ? GazeValidity::ok : GazeValidity::lost;
      raw.rows.push_back(sample);
    }
    for (const EyeInLab& eye : takes_directions ? std::vector<EyeInLab>() : c.eyes) {
      const double pupil = rows.number(eye.pupil);
      RawSample sample = position_row(t_ns, rows.line(), eye.eye, {rows.number(eye.x), rows.number(eye.y)}, pupil);
      sample.pupil = static_cast<float>(pupil);
      const std::string validity = to_lower(rows.cell(eye.validity));
      if (eye.validity && validity != "valid" && validity != "1") {
        sample.validity = GazeValidity::lost;
      }
      raw.rows.push_back(sample);
    }
    const std::string movement(rows.cell(c.movement));
    runs.add_named(movement, Eye::cyclopean, rows.cell(c.movement_index), t_ns, rows.line());
  }
  runs.finish(raw);
  if (others > 0) {
    add_note(raw, "rows left out", std::to_string(others), Evidence::header, "of other sensors, and of events");
  }
  if (takes_directions) {
    declare_directions(raw, {"Gaze direction left X, ...", Evidence::header}, GazeAxes::sranipal, Evidence::format,
                       table.place);
    return raw;
  }
  const std::string columns = table.headings[*c.eyes.front().x].text + ", " + table.headings[*c.eyes.front().y].text;
  const bool is_norm = letters_and_digits(table.headings[*c.eyes.front().x].unit) == "mcsnorm";
  declare_places(raw,
                 {is_norm && c.is_glasses ? PositionUnit::fraction : PositionUnit::px, PositionOrigin::top_left,
                  Evidence::format, columns},
                 table.place);
  return raw;
}

}  // namespace gazetrace
