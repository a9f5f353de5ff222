// SPDX-License-Identifier: Apache-2.0
// Tobii Pro Glasses 2 livedata.json(.gz): one JSON object in each line. `ts` is microseconds of the device's clock,
// `gidx` joins the lines of one gaze sample: gd, the direction of each eye; pc, where it is; pd, its pupil; gp, the
// place on the scene video, with s = 0 where valid. Lines of several samples interleave and are not in the order of
// time. Axes: +x to the wearer's left, +y up, +z forward, mm.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "gazelog/json_lines.hpp"

namespace gazetrace {
namespace {

struct GazeOfIndex {
  std::int64_t t_ns = 0, row = 0;
  Vec3d direction[2] = {{kNan, kNan, kNan}, {kNan, kNan, kNan}};
  Vec3d center_mm[2] = {{kNan, kNan, kNan}, {kNan, kNan, kNan}};
  double pupil_mm[2] = {kNan, kNan};
  double u = kNan, v = kNan;
  Vec3d point_mm{kNan, kNan, kNan};
  bool bad[2] = {false, false};
  bool bad_place = false;
  bool has_eyes = false, has_place = false;
};

void add_line(const JsonLeaves& json, std::int64_t t_ns, std::int64_t row, std::map<std::int64_t, GazeOfIndex>& gazes) {
  std::int64_t index = 0;
  const JsonLeaf* const gidx = json.find("gidx");
  if (gidx == nullptr && (json.has("gp") || json.has("gd"))) {
    index = t_ns;  // old firmware: what belongs together has one stamp
  } else if (gidx == nullptr || scaled_integer(gidx->text, 0, index) != NumberStatus::ok) {
    return;
  }
  GazeOfIndex& gaze = gazes[index];
  if (gaze.row == 0) {
    gaze.t_ns = t_ns;
    gaze.row = row;
  }
  const bool bad = json.number("s").value_or(1) != 0;
  const std::size_t side = json.text("eye") == "right" ? 1 : 0;
  if (json.has("gd")) {
    gaze.direction[side] = json_vector(json, "gd");
    gaze.bad[side] = bad;
    gaze.has_eyes = true;
  } else if (json.has("pc")) {
    gaze.center_mm[side] = json_vector(json, "pc");
  } else if (json.has("pd")) {
    const double pupil = json.number("pd").value_or(kNan);
    gaze.pupil_mm[side] = !bad && pupil > 0 ? pupil : kNan;
  } else if (json.has("gp3")) {
    gaze.point_mm = json_vector(json, "gp3");
  } else if (json.has("gp")) {
    const std::vector<double> at = json.numbers("gp");
    if (at.size() == 2) {
      gaze.u = at[0];
      gaze.v = at[1];
    }
    gaze.t_ns = t_ns;
    gaze.row = row;
    gaze.bad_place = bad;
    gaze.has_place = true;
  }
}

void add_event(const JsonLeaves& json, std::int64_t t_ns, std::int64_t row, RawGaze& raw) {
  if (json.number("vts") == 0.0) {
    add_message(raw, t_ns, "scene video starts", row);
  } else if (json.has("sig")) {
    const std::string text = fmt::format("sync port {} {}", json.text("dir"), json.text("sig"));
    add_message(raw, t_ns, text, row);
  }
}

void add_samples(const GazeOfIndex& gaze, RawGaze& raw) {
  if (raw.kind == GazeKind::scene_camera) {
    if (gaze.has_place) {
      RawSample sample = missing_row(gaze.t_ns, gaze.row, Eye::cyclopean);
      if (!gaze.bad_place && !std::isnan(gaze.u)) {
        sample.at.x = gaze.u;
        sample.at.y = gaze.v;
        sample.validity = GazeValidity::ok;
      }
      raw.rows.push_back(sample);
    }
    return;
  }
  if (!gaze.has_eyes) {
    return;
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec3d direction = gaze.bad[side] ? Vec3d{} : gaze.direction[side];
    raw.rows.push_back(direction_row(gaze.t_ns, gaze.row, side, direction, gaze.pupil_mm[side]));
  }
  raw.origins.push_back({to_float(gaze.center_mm[0]), to_float(gaze.center_mm[1]), gaze.t_ns});
}

}  // namespace

double sniff_gaze_tobii_glasses2(const GazeFile& file) {
  const WordsIn has{head_of(file, 4096)};
  const bool known = has("\"gidx\"") || has("\"pts\"") || has("\"gp\"");
  return file.text.starts_with("{\"ts\"") ? known ? 0.99 : 0.7 : 0.0;
}

RawGaze read_gaze_tobii_glasses2(const GazeFile& file, const GazeReadOptions& options) {
  RawGaze raw = raw_of_glasses(file, options, "device");
  const int exponent = declare_time(raw, options, "ts", 3, Evidence::format, file.path).exponent;
  std::map<std::int64_t, GazeOfIndex> gazes;
  for_each_json_line(file, raw.damages, [&](const JsonLeaves& json, std::int64_t row, const std::string& place) {
    if (const auto t_ns = json_time_ns(json, "ts", exponent, place)) {
      add_line(json, *t_ns, row, gazes);
      add_event(json, *t_ns, row, raw);
    }
  });
  std::vector<const GazeOfIndex*> ordered;
  ordered.reserve(gazes.size());
  for (const auto& [index, gaze] : gazes) {
    ordered.push_back(&gaze);
  }
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) { return a->t_ns < b->t_ns; });
  WitnessTally points;
  for (const GazeOfIndex* const gaze : ordered) {
    if (const Vec3d& at = gaze->point_mm; !gaze->bad_place && at.z > 0) {
      points.add(gaze->u, gaze->v, -at.x / at.z, -at.y / at.z);
    }
    add_samples(*gaze, raw);
  }
  declare_glasses(raw, file, "gd", "gp", "gp3", points);
  return raw;
}

}  // namespace gazetrace
