// SPDX-License-Identifier: Apache-2.0
// Pupil Invisible's and Neon's gaze.csv from Pupil Cloud: `timestamp [ns]` from 1970, `gaze x [px]` on the scene
// camera's picture from the top left, `azimuth [deg]` and `elevation [deg]` from the scene camera's axis, right and up,
// `worn`, `fixation id`, `blink id`, and `recording id` where several recordings were exported together. During a blink
// the places go on and mean nothing.

#include <algorithm>
#include <cmath>

#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

struct CloudColumns {
  std::size_t time = 0, x = 0, y = 0;
  OptionalColumn azimuth, elevation, worn, blink, fixation;
};

CloudColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, UsedColumns& used) {
  const auto own_time = table.find("timestamp [ns]");
  const auto x = used.find("gaze x [px]");
  const auto y = used.find("gaze y [px]");
  const auto azimuth = used.find("azimuth [deg]");
  const auto elevation = used.find("elevation [deg]");
  if (!own_time || !x || !y) {
    throw Error(ErrorKind::input, table.place, "there are no columns 'timestamp [ns]', 'gaze x [px]' and 'gaze y [px]'",
                "the columns are: " + column_listing(table));
  }
  if (options.frame == GazeFrame::head && (!azimuth || !elevation)) {
    throw Error(ErrorKind::input, table.place, "it has no azimuth and elevation, only places on the scene picture",
                "export again from a newer Pupil Cloud");
  }
  return {used.time(options, *own_time), *x, *y, azimuth, elevation, used.find("worn"), used.find("blink id"),
          used.find("fixation id")};
}

// A row with the direction from the head, or else with the place on the scene camera's picture.
RawSample sample_of(TableRows& rows, const CloudColumns& c, GazeKind kind, std::int64_t t_ns) {
  const bool in_head = kind == GazeKind::direction;
  RawSample sample = missing_row(t_ns, rows.line(), Eye::cyclopean);
  sample.at = {rows.number(in_head ? *c.azimuth : c.x), rows.number(in_head ? *c.elevation : c.y), 0};
  sample.validity = std::isnan(sample.at.x) || std::isnan(sample.at.y) ? GazeValidity::lost : GazeValidity::ok;
  if (c.worn && rows.number(*c.worn) == 0) {
    sample.validity = GazeValidity::lost;
  }
  return sample;
}

}  // namespace

double sniff_gaze_pupil_cloud(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  // A no-break space may stand before the unit.
  const bool places = has("gaze x") && has("[px]") && has("timestamp") && has("[ns]");
  // Places alone could be of any format.
  return !places ? 0.0 : has("recording id") ? 0.99 : has("worn") || has("azimuth") ? 0.8 : 0.1;
}

RawGaze read_gaze_pupil_cloud(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const CloudColumns c = find_columns(table, options, used);
  RawGaze raw = raw_of(file, "UTC, from 1970");
  raw.way_out = "map gaze onto a surface in Pupil Cloud, or take directions from the head with `frame` head";
  raw.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  const TimeScale scale = declare_time(raw, options, table.headings[c.time].text, 0, Evidence::header, table.place);
  RecordingColumns recordings(table, options.columns.recording, {"recording id"});
  LabelRuns runs;
  WitnessTally angles;
  TableRows rows(file, table, std::max(used.needed(), recordings.needed_cells()));
  while (rows.next()) {
    rows.check_length();
    if (recordings.note(rows, raw)) {
      runs.end();
    }
    const std::int64_t t_ns = rows.time_ns(c.time, scale);
    if (raw.kind == GazeKind::scene_camera && c.azimuth && c.elevation) {
      angles.add(rows.number(c.x), rows.number(c.y), rows.number(*c.azimuth), -rows.number(*c.elevation));
    }
    RawSample sample = sample_of(rows, c, raw.kind, t_ns);
    label_by_ids(rows, c.blink, c.fixation, sample, runs);
    raw.rows.push_back(sample);
  }
  runs.finish(raw);
  angles.finish(raw, "azimuth and elevation");
  if (raw.kind == GazeKind::direction) {
    declare_directions(raw, {"azimuth [deg], elevation [deg]", Evidence::header}, GazeAxes::gl, Evidence::format,
                       table.place);
    raw.declared.form = PlaceForm::azimuth_elevation;
    raw.declared.unit = {PositionUnit::deg, Evidence::header, {}};
    return raw;
  }
  guess_picture_size(raw);
  declare_places(raw, {PositionUnit::px, PositionOrigin::top_left, Evidence::header, "gaze x [px], gaze y [px]"},
                 table.place);
  return raw;
}

}  // namespace gazetrace
