// SPDX-License-Identifier: Apache-2.0
// Gaze on a surface: Pupil Core's gaze_positions_on_surface_NAME.csv (x_norm, y_norm from the bottom left, on_surf,
// confidence, seconds of Pupil's clock) and Pupil Cloud's marker mapper (gaze position on surface x [normalized] from
// the top left, nanoseconds). Gaze beside the surface is off screen.

#include <algorithm>
#include <cmath>

#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastConfidence = 0.6;  // as Pupil Labs advise

}  // namespace

double sniff_gaze_pupil_surface(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  const bool core = has("x_norm") && has("y_norm") && has("on_surf");
  return (core && has("gaze_timestamp")) || has("gaze position on surface x") ? 0.99 : core ? 0.7 : 0.0;
}

RawGaze read_gaze_pupil_surface(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const bool cloud = table.find("gaze position on surface x").has_value();
  const auto time = cloud ? table.find("timestamp") : table.find_any({"gaze_timestamp", "world_timestamp"});
  const auto x = used.find(cloud ? "gaze position on surface x" : "x_norm");
  const auto y = used.find(cloud ? "gaze position on surface y" : "y_norm");
  if (!time || !x || !y) {
    throw Error(ErrorKind::input, table.place, "there are no columns of time and of places on a surface",
                "the columns are: " + column_listing(table));
  }
  const auto confidence = used.find("confidence");
  const auto blink = used.find("blink id");
  const auto fixation = used.find("fixation id");
  RawGaze raw = raw_of(file, cloud ? "UTC, from 1970" : "Pupil, arbitrary zero");
  const std::size_t time_at = used.time(options, *time);
  const TimeScale scale = declare_time(raw, options, table.headings[time_at].text, cloud ? 0 : 9,
                                       cloud ? Evidence::header : Evidence::format, table.place);
  const double least = least_confidence(options, kLeastConfidence);
  RecordingColumns recordings(table, options.columns.recording, {"recording id"});
  LabelRuns runs;
  TableRows rows(file, table, std::max(used.needed(), recordings.needed_cells()));
  while (rows.next()) {
    rows.check_length();
    if (recordings.note(rows, raw)) {
      runs.end();
    }
    RawSample sample;
    sample.t_ns = rows.time_ns(time_at, scale);
    sample.row = rows.line();
    sample.pupil = static_cast<float>(kNan);
    sample.at.x = rows.number(*x);
    sample.at.y = rows.number(*y);
    sample.confidence = static_cast<float>(rows.number(confidence));
    if (std::isnan(sample.at.x) || std::isnan(sample.at.y) || sample.confidence == 0) {
      sample.validity = GazeValidity::lost;
    } else if (sample.confidence < least) {
      sample.validity = GazeValidity::low_confidence;
    }
    label_by_ids(rows, blink, fixation, sample, runs);
    raw.rows.push_back(sample);
  }
  runs.finish(raw);
  declare_places(raw,
                 {PositionUnit::fraction, cloud ? PositionOrigin::top_left : PositionOrigin::bottom_left,
                  Evidence::format, table.headings[*x].text + ", " + table.headings[*y].text},
                 table.place);
  return raw;
}

}  // namespace gazetrace
