// SPDX-License-Identifier: Apache-2.0
// Pupil Invisible's and Neon's gaze.csv from Pupil Cloud: `timestamp [ns]` from 1970, `gaze x [px]` on the scene
// camera's picture from the top left, `azimuth [deg]` and `elevation [deg]` from the scene camera's axis, right and up,
// `worn`, `blink id`. During a blink the places go on and mean nothing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

double sniff_gaze_pupil_cloud(const GazeFile& file) {
  const std::string_view head = head_of(file, 4096);
  const std::string_view line = head.substr(0, head.find('\n'));
  const auto has = [&](std::string_view text) { return line.find(text) != std::string_view::npos; };
  // A no-break space may stand before the unit.
  const bool places = has("gaze x") && has("[px]") && has("timestamp") && has("[ns]");
  // Places alone could be anybody's.
  return !places ? 0.0 : has("recording id") ? 0.99 : has("worn") || has("azimuth") ? 0.8 : 0.1;
}

GazeLog read_gaze_pupil_cloud(const GazeFile& file, const GazeReadOptions& options) {
  refuse_scene_camera(
      file, options, "map gaze onto a surface in Pupil Cloud, or take directions from the head with --gaze-frame head");
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
  GazeLog log;
  log.source = file.path;
  log.format = "pupil-cloud";
  log.clock = "UTC, from 1970";
  log.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  const std::size_t time = time_column(table, options, *own_time, place);
  const TimeScale scale = choose_time_unit(log, options, table.headings[time].text, 0, Evidence::header, place);
  LabelRuns runs;
  WitnessTally angles;
  TableRows rows(file, table,
                 std::max({time, *x, *y, azimuth.value_or(0), elevation.value_or(0), worn.value_or(0),
                           blink.value_or(0), fixation.value_or(0)}) +
                     1);
  while (rows.next()) {
    rows.check_length();
    GazeSample sample = missing_sample(rows.time_ns(time, scale), rows.line(), Eye::cyclopean, log.kind);
    if (log.kind == GazeKind::scene_camera && azimuth && elevation) {
      angles.add(rows.number(*x), rows.number(*y), rows.number(*azimuth), -rows.number(*elevation));
    }
    if (log.kind == GazeKind::direction) {
      const double az = rows.number(*azimuth) * kRadPerDeg;
      const double el = rows.number(*elevation) * kRadPerDeg;
      sample.direction = {std::sin(az) * std::cos(el), std::sin(el), -std::cos(az) * std::cos(el)};
      sample.validity = std::isnan(az) || std::isnan(el) ? GazeValidity::lost : GazeValidity::ok;
    } else {
      sample.u = rows.number(*x);
      sample.v = rows.number(*y);
      sample.validity = std::isnan(sample.u) || std::isnan(sample.v) ? GazeValidity::lost : GazeValidity::ok;
    }
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
    log.samples.push_back(sample);
  }
  runs.finish(log);
  angles.finish(log, "azimuth and elevation");
  if (log.kind == GazeKind::direction) {
    add_fact(log, "position columns", "azimuth [deg], elevation [deg]", Evidence::header);
    add_fact(log, "position unit", "deg", Evidence::header);
    finish_directions(log, options, GazeAxes::gl, Evidence::format, place);
    return log;
  }
  // The picture is 1088 x 1080 for Invisible, 1600 x 1200 for Neon; the file does not say.
  double widest = 0;
  for (const GazeSample& sample : log.samples) {
    widest = sample.u > widest && sample.u < 1600 ? sample.u : widest;
  }
  log.recording_geometry = widest > 1100 ? DisplayGeometry{.width_px = 1600, .height_px = 1200}
                                         : DisplayGeometry{.width_px = 1088, .height_px = 1080};
  add_fact(log, "picture size",
           fmt::format("{}x{} px", log.recording_geometry->width_px, log.recording_geometry->height_px),
           Evidence::statistics, fmt::format("places reach {:.0f} px", widest));
  finish_places(log, options,
                {PositionUnit::px, PositionOrigin::top_left, Evidence::header, "gaze x [px], gaze y [px]"}, place);
  log.recording_geometry.reset();  // a camera's picture is no display
  return log;
}

}  // namespace gazetrace
