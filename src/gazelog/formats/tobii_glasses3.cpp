// SPDX-License-Identifier: Apache-2.0
// Tobii Pro Glasses 3 gazedata(.gz): one JSON object in each line, `timestamp` in seconds from the start of the
// recording, `data` with gaze2d (fractions of the scene video from the top left) and for each eye gazeorigin (mm),
// gazedirection and pupildiameter (mm). A lost sample has no data, and a lost eye has an empty object. Axes: +x to the
// wearer's left, +y up, +z forward.

#include "gazelog/json_lines.hpp"

namespace gazetrace {
namespace {

void add_line(const JsonLeaves& json, std::int64_t t_ns, std::int64_t row, RawGaze& raw, WitnessTally& points) {
  if (raw.kind == GazeKind::scene_camera) {
    RawSample sample = missing_row(t_ns, row, Eye::cyclopean);
    const std::vector<double> at = json.numbers("data.gaze2d");
    if (at.size() == 2) {
      sample.at.x = at[0];
      sample.at.y = at[1];
      sample.validity = GazeValidity::ok;
      if (const Vec3d point = json_vector(json, "data.gaze3d"); point.z > 0) {
        points.add(at[0], at[1], -point.x / point.z, -point.y / point.z);
      }
    }
    raw.rows.push_back(sample);
    return;
  }
  Vec3f origins[2];
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string eye = side == 0 ? "data.eyeleft." : "data.eyeright.";
    raw.rows.push_back(direction_row(t_ns, row, side, json_vector(json, eye + "gazedirection"),
                                     json.number(eye + "pupildiameter").value_or(kNan)));
    origins[side] = to_float(json_vector(json, eye + "gazeorigin"));
  }
  raw.origins.push_back({origins[0], origins[1], t_ns});
}

}  // namespace

double sniff_gaze_tobii_glasses3(const GazeFile& file) {
  const WordsIn has{head_of(file, 4096)};
  const bool is_gaze = file.text.starts_with("{\"type\":") && has("\"type\":\"gaze\"");
  return is_gaze && (has("gaze2d") || has("\"data\":{}")) ? 0.99 : 0.0;
}

RawGaze read_gaze_tobii_glasses3(const GazeFile& file, const GazeReadOptions& options) {
  RawGaze raw = raw_of_glasses(file, options, "recording, from its start");
  const int exponent = declare_time(raw, options, "timestamp", 9, Evidence::format, file.path).exponent;
  WitnessTally points;
  for_each_json_line(file, raw.damages, [&](const JsonLeaves& json, std::int64_t row, const std::string& place) {
    if (json.text("type") != "gaze") {
      return;
    }
    const auto t_ns = json_time_ns(json, "timestamp", exponent, place);
    if (!t_ns) {
      throw Error(ErrorKind::input, place, "this sample has no timestamp", "remove the line");
    }
    add_line(json, *t_ns, row, raw, points);
  });
  declare_glasses(raw, file, "gazedirection", "gaze2d", "gaze3d", points);
  return raw;
}

}  // namespace gazetrace
