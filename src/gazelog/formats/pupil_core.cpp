// SPDX-License-Identifier: Apache-2.0
// Pupil Core gaze_positions.csv, from Pupil Player's raw data exporter. gaze_timestamp is in seconds of Pupil's clock;
// norm_pos_x and _y are fractions of the scene camera's picture from the bottom left; gaze_normal0 and 1 are the eyes'
// directions and eye_center their places (mm), +x right, +y down, +z forward. Bad samples have a low confidence and
// erratic places; rows of one eye leave the cells of the other eye empty.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

constexpr double kLeastConfidence = 0.6;  // as Pupil Labs advise

struct CoreColumns {
  std::size_t time = 0, confidence = 0, x = 0, y = 0;
  std::array<VectorColumns, 2> normal, center;
  VectorColumns point;
};

CoreColumns find_columns(const DelimitedTable& table, const GazeReadOptions& options, UsedColumns& used) {
  CoreColumns c;
  // canonical_timestamp_s: Ego4D, which has Pupil's other columns.
  const auto own = table.find_any({"gaze_timestamp", "timestamp", "canonical_timestamp_s"});
  const bool needs_own = !own && options.columns.time.empty();
  c.time = used.time(options, needs_own ? used.require("gaze_timestamp") : own.value_or(0));
  c.confidence = used.require("confidence");
  c.x = used.require("norm_pos_x");
  c.y = used.require("norm_pos_y");
  const auto vector = [&](const std::string& stem) {
    return table.find(stem + "_x")
               ? VectorColumns{used.require(stem + "_x"), used.require(stem + "_y"), used.require(stem + "_z")}
               : VectorColumns{};
  };
  c.point = vector("gaze_point_3d");
  for (std::size_t eye = 0; eye < 2; ++eye) {
    c.normal[eye] = vector(fmt::format("gaze_normal{}", eye));
    c.center[eye] = vector(fmt::format("eye_center{}_3d", eye));
  }
  return c;
}

// Documents disagree on which eye is 0: the one whose center lies further right (+x) is the right one.
bool eye_0_is_right(TableRows rows, const CoreColumns& c, RawGaze& raw) {
  double sum = 0;
  std::size_t count = 0;
  while (count < 2000 && rows.next()) {
    rows.check_length();
    const double difference = rows.vector(c.center[0]).x - rows.vector(c.center[1]).x;
    if (std::isfinite(difference)) {
      sum += difference;
      ++count;
    }
  }
  if (count == 0) {
    add_note(raw, "eye 0", "right", Evidence::format, "Pupil Core's usual order; no center of both eyes confirms it");
    return true;
  }
  const double mean = sum / static_cast<double>(count);
  add_note(
      raw, "eye 0", mean > 0 ? "right" : "left", Evidence::statistics,
      fmt::format("its center lies {:.0f} mm to the {} of the other's", std::abs(mean), mean > 0 ? "right" : "left"));
  return mean > 0;
}

}  // namespace

double sniff_gaze_pupil_core(const GazeFile& file) {
  const WordsIn has{first_line_of(file)};
  return has("norm_pos_x") && has("confidence") && has("timestamp") && !has("x_norm") && !has("dispersion")
             ? has("base_data") ? 0.99 : 0.8
             : 0.0;
}

RawGaze read_gaze_pupil_core(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  UsedColumns used(table);
  const CoreColumns c = find_columns(table, options, used);
  RawGaze raw = raw_of(file, "Pupil, arbitrary zero");
  const bool by_eye = c.normal[0][0] && c.normal[1][0];
  raw.way_out = "export gaze on a surface (gaze_positions_on_surface_....csv)";
  raw.way_out += by_eye ? ", or take directions from the head with `frame` head" : "";
  raw.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  if (raw.kind == GazeKind::direction && !by_eye) {
    throw Error(ErrorKind::input, table.place,
                "it has no directions (gaze_normal0_x, ...), only places on the scene picture",
                "export again with the 3D gaze mapper, or a surface");
  }
  const TimeScale scale = declare_time(raw, options, table.headings[c.time].text, 9, Evidence::format, table.place);
  const double least = least_confidence(options, kLeastConfidence);
  TableRows rows(file, table, used.needed());
  const bool right_first = by_eye && eye_0_is_right(rows, c, raw);
  WitnessTally points;
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(c.time, scale);
    const double confidence = rows.number(c.confidence);
    const GazeValidity validity = confidence >= least ? GazeValidity::ok
                                  : confidence > 0    ? GazeValidity::low_confidence
                                                      : GazeValidity::lost;
    const auto add = [&](RawSample sample, bool known) {
      sample.confidence = static_cast<float>(confidence);
      sample.validity = known ? validity : GazeValidity::lost;
      raw.rows.push_back(sample);
    };
    if (raw.kind == GazeKind::scene_camera) {
      RawSample sample = missing_row(t_ns, rows.line(), Eye::cyclopean);
      sample.at.x = rows.number(c.x);
      sample.at.y = rows.number(c.y);
      if (const Vec3d at = rows.vector(c.point); validity == GazeValidity::ok && at.z > 0) {
        points.add(sample.at.x, sample.at.y, at.x / at.z, -at.y / at.z);
      }
      add(sample, !std::isnan(sample.at.x) && !std::isnan(sample.at.y));
      continue;
    }
    Vec3f origins[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const bool right = (i == 0) == right_first;
      RawSample sample = missing_row(t_ns, rows.line(), right ? Eye::right : Eye::left);
      sample.at = rows.vector(c.normal[i]);
      add(sample, length(sample.at) > 0);
      origins[right ? 1 : 0] = to_float(rows.vector(c.center[i]));
    }
    raw.origins.push_back({origins[0], origins[1], t_ns});
  }
  points.finish(raw, "the gaze point in 3D");
  add_note(raw, "least confidence", fmt::format("{}", least),
           std::isnan(options.min_confidence) ? Evidence::format : Evidence::option);
  if (raw.kind == GazeKind::direction) {
    declare_directions(raw, {"gaze_normal0, gaze_normal1", Evidence::header}, GazeAxes::cv, Evidence::format,
                       table.place);
  } else {
    declare_places(raw,
                   {PositionUnit::fraction, PositionOrigin::bottom_left, Evidence::format, "norm_pos_x, norm_pos_y"},
                   table.place);
  }
  return raw;
}

}  // namespace gazetrace
