// SPDX-License-Identifier: Apache-2.0
// Pupil Invisible's and Neon's gaze.csv from Pupil Cloud: `timestamp [ns]` from 1970, `gaze x [px]` on the scene
// camera's picture from the top left, `azimuth [deg]` and `elevation [deg]` from the scene camera's axis, right and up,
// `worn`, `fixation id`, `blink id`, and `recording id` where several recordings were exported together. During a blink
// the places go on and mean nothing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {

double sniff_gaze_pupil_cloud(const GazeFile& file) {
  const std::string_view head = head_of(file, 4096);
  const std::string_view line = head.substr(0, head.find('\n'));
  const auto has = [&](std::string_view text) { return line.find(text) != std::string_view::npos; };
  // A no-break space may stand before the unit.
  const bool places = has("gaze x") && has("[px]") && has("timestamp") && has("[ns]");
  // Places alone could be of any format.
  return !places ? 0.0 : has("recording id") ? 0.99 : has("worn") || has("azimuth") ? 0.8 : 0.1;
}

RawGaze read_gaze_pupil_cloud(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const std::string place = place_of(file, table.header_line);
  const auto own_time = table.find("timestamp [ns]");
  const auto x = table.find("gaze x [px]");
  const auto y = table.find("gaze y [px]");
  const auto azimuth = table.find("azimuth [deg]");
  const auto elevation = table.find("elevation [deg]");
  if (!own_time || !x || !y) {
    throw Error(ErrorKind::input, place, "there are no columns 'timestamp [ns]', 'gaze x [px]' and 'gaze y [px]'",
                "the columns are: " + column_listing(table));
  }
  if (options.frame == GazeFrame::head && (!azimuth || !elevation)) {
    throw Error(ErrorKind::input, place, "it has no azimuth and elevation, only places on the scene picture",
                "export again from a newer Pupil Cloud");
  }
  const auto worn = table.find("worn");
  const auto blink = table.find("blink id");
  const auto fixation = table.find("fixation id");
  RawGaze raw;
  raw.way_out = "map gaze onto a surface in Pupil Cloud, or take directions from the head with `gaze-frame` head";
  raw.source = file.path;
  raw.format = "pupil-cloud";
  raw.clock = "UTC, from 1970";
  raw.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  const std::size_t time = time_column(table, options, *own_time, place);
  const TimeScale scale = declare_time(raw, options, table.headings[time].text, 0, Evidence::header, place);
  RecordingColumns recordings(table, options.columns.recording, {"recording id"});
  LabelRuns runs;
  WitnessTally angles;
  TableRows rows(
      file, table,
      std::max(recordings.needed_cells(), std::max({time, *x, *y, azimuth.value_or(0), elevation.value_or(0),
                                                    worn.value_or(0), blink.value_or(0), fixation.value_or(0)}) +
                                              1));
  while (rows.next()) {
    rows.check_length();
    if (recordings.note(rows, raw)) {
      runs.end();
    }
    RawSample sample = missing_row(rows.time_ns(time, scale), rows.line(), Eye::cyclopean);
    if (raw.kind == GazeKind::scene_camera && azimuth && elevation) {
      angles.add(rows.number(*x), rows.number(*y), rows.number(*azimuth), -rows.number(*elevation));
    }
    const bool in_head = raw.kind == GazeKind::direction;
    sample.at = {rows.number(in_head ? *azimuth : *x), rows.number(in_head ? *elevation : *y), 0};
    sample.validity = std::isnan(sample.at.x) || std::isnan(sample.at.y) ? GazeValidity::lost : GazeValidity::ok;
    if (worn && rows.number(*worn) == 0) {
      sample.validity = GazeValidity::lost;
    }
    const std::string_view blink_id = rows.cell(blink);
    if (!is_missing(blink_id)) {
      sample.validity = GazeValidity::blink;
      runs.add(GazeEventType::blink, Eye::cyclopean, std::string(blink_id), sample.t_ns, sample.row);
    } else if (const std::string_view id = rows.cell(fixation); !is_missing(id)) {
      runs.add(GazeEventType::fixation, Eye::cyclopean, std::string(id), sample.t_ns, sample.row);
    } else {
      runs.end();
    }
    raw.rows.push_back(sample);
  }
  runs.finish(raw);
  angles.finish(raw, "azimuth and elevation");
  if (raw.kind == GazeKind::direction) {
    declare_directions(raw, {"azimuth [deg], elevation [deg]", Evidence::header}, GazeAxes::gl, Evidence::format,
                       place);
    raw.declared.form = PlaceForm::azimuth_elevation;
    raw.declared.unit = {PositionUnit::deg, Evidence::header, {}};
    return raw;
  }
  // The picture is 1088 x 1080 for Invisible, 1600 x 1200 for Neon; the file does not say.
  double widest = 0;
  for (const RawSample sample : raw.rows) {
    widest = sample.at.x > widest && sample.at.x < 1600 ? sample.at.x : widest;
  }
  raw.picture_px = widest > 1100 ? Vec2d{1600, 1200} : Vec2d{1088, 1080};
  add_note(raw, "picture size", fmt::format("{}x{} px", raw.picture_px->x, raw.picture_px->y), Evidence::statistics,
           fmt::format("places reach {:.0f} px", widest));
  declare_places(raw, {PositionUnit::px, PositionOrigin::top_left, Evidence::header, "gaze x [px], gaze y [px]"},
                 place);
  return raw;
}

}  // namespace gazetrace
