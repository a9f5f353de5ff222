// SPDX-License-Identifier: Apache-2.0
// Poses as OpenXR defines them and loggers write them: time, gaze_orientation_x .. w (a quaternion xyzw; gaze looks
// along its -z) and, where logged, head_position_x .. and head_orientation_x .. w, flags, the sample's own time. +x
// right, +y up, -z forward. Gaze is in the VIEW space unless a column `space` says otherwise; in that case the head's
// pose of the same row transforms it there. Loggers of Unity and Unreal write a direction in place of gaze's rotation.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "gazelog/mapped_table.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

using RotationColumns = std::array<OptionalColumn, 4>;  // of x, y, z and w

// "gaze_orientation_x", "gaze.rotation.x", "gaze_qx" and the like.
template <class Columns>
Columns find_group(const DelimitedTable& table, std::initializer_list<std::string_view> stems) {
  for (const std::string_view stem : stems) {
    Columns columns;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      columns[i] = table.find(fmt::format("{}{}", stem, "xyzw"[i]));
    }
    if (std::all_of(columns.begin(), columns.end(), [](const OptionalColumn& c) { return c.has_value(); })) {
      return columns;
    }
  }
  return {};
}

struct PoseColumns {
  RotationColumns gaze, head;
  VectorColumns direction, gaze_position, head_position;
  OptionalColumn time, sample_time, tracked, flags, confidence, space;
  bool is_engines = false;  // a rotation, as Unity and Unreal call what OpenXR calls an orientation

  [[nodiscard]] bool has_gaze() const { return gaze[0] || (direction[0] && head[0]); }
};

PoseColumns find_columns(const DelimitedTable& table) {
  PoseColumns c;
  c.gaze = find_group<RotationColumns>(
      table, {"gaze orientation ", "gaze pose orientation ", "eye gaze orientation ", "gaze q", "gaze orientation q"});
  if (!c.gaze[0]) {
    c.gaze = find_group<RotationColumns>(table, {"gaze rotation ", "eye gaze rotation "});
    c.is_engines = c.gaze[0].has_value();
  }
  if (!c.gaze[0]) {
    c.direction = find_group<VectorColumns>(
        table, {"gaze direction ", "gaze dir ", "gaze forward ", "gaze vector ", "eye direction "});
  }
  c.gaze_position = find_group<VectorColumns>(
      table, {"gaze position ", "gaze pose position ", "eye gaze position ", "gaze origin ", "gaze p"});
  c.head = find_group<RotationColumns>(table, {"head orientation ", "head rotation ", "head q", "view orientation ",
                                               "hmd orientation ", "hmd rotation ", "hmd q"});
  c.head_position =
      find_group<VectorColumns>(table, {"head position ", "head p", "view position ", "hmd position ", "hmd p"});
  c.time =
      table.find_any({"time", "timestamp", "xr time", "display time", "predicted display time", "eye data timestamp"});
  c.sample_time = table.find_any({"sample time", "gaze sample time", "gaze time"});
  c.tracked = table.find_any({"gaze tracked", "is tracked", "gaze valid", "is valid", "tracked", "gaze has value"});
  c.flags = table.find_any({"location flags", "gaze location flags", "gaze flags"});
  c.confidence = table.find_any({"confidence", "gaze confidence"});
  c.space = table.find_any({"space", "reference space", "gaze space"});
  return c;
}

Quatd rotation_of(TableRows& rows, const RotationColumns& columns) {
  const Vec3d axis = rows.vector({columns[0], columns[1], columns[2]});
  return {axis.x, axis.y, axis.z, rows.number(columns[3])};
}

// Where a rotation of nothing looks to.
Vec3d ahead_in(GazeAxes axes) {
  return axes == GazeAxes::unreal                              ? Vec3d{1, 0, 0}
         : axes == GazeAxes::gl || axes == GazeAxes::automatic ? Vec3d{0, 0, -1}
                                                               : Vec3d{0, 0, 1};
}

Quatd inverse(const Quatd& q) {
  return {-q.x, -q.y, -q.z, q.w};
}

// A row's gaze as it is written, with the head at that time.
struct PosedGaze {
  std::int64_t t_ns;
  Vec3d direction;
  Quatd head;
};

// How fast gaze moves in the world while the head turns, in degrees a second, in the median: small under the right
// reading, since eyes hold on to things at rest.
double world_speed_deg_s(const std::vector<PosedGaze>& gazes, bool is_in_world) {
  constexpr std::int64_t kSpanNs = 50'000'000;
  constexpr double kLeastHeadDegS = 5;
  std::vector<double> speeds;
  std::size_t ahead = 0;
  for (const PosedGaze& a : gazes) {
    while (ahead < gazes.size() && gazes[ahead].t_ns - a.t_ns < kSpanNs) {
      ++ahead;
    }
    if (ahead == gazes.size()) {
      break;
    }
    const PosedGaze& b = gazes[ahead];
    const double seconds = static_cast<double>(b.t_ns - a.t_ns) * 1e-9;
    const double head = angle_between_rad(rotate(a.head, {0, 0, -1}), rotate(b.head, {0, 0, -1})) * kDegPerRad;
    if (head / seconds > kLeastHeadDegS) {
      const Vec3d from = is_in_world ? a.direction : rotate(a.head, a.direction);
      const Vec3d to = is_in_world ? b.direction : rotate(b.head, b.direction);
      speeds.push_back(angle_between_rad(from, to) * kDegPerRad / seconds);
    }
  }
  constexpr std::size_t kFewest = 20;
  return speeds.size() < kFewest ? kNan : lower_quantile(speeds, 0.5);
}

// How far the places of gaze lie from the origin, and from the head's.
struct GazeDistances {
  std::vector<double> from_origin, from_head;
};

// Whether the poses of gaze stand in the space of the head's poses rather than in the head. Decided by the places of
// both, which agree there, and else by how steady gaze is in the world.
std::optional<bool> is_in_world(GazeDistances& places, const std::vector<PosedGaze>& gazes, std::string& evidence) {
  constexpr double kNearM = 0.2;
  if (!places.from_head.empty()) {
    const double origin_m = lower_quantile(places.from_origin, 0.5);
    const double head_m = lower_quantile(places.from_head, 0.5);
    if ((origin_m < kNearM) != (head_m < kNearM)) {
      evidence =
          fmt::format("gaze begins {:.2f} m from the origin and {:.2f} m from the head's place", origin_m, head_m);
      return head_m < kNearM;
    }
  }
  const double as_head = world_speed_deg_s(gazes, false);
  const double as_world = world_speed_deg_s(gazes, true);
  evidence = fmt::format(
      "while the head turns, gaze in the world moves by {:.1f} deg/s if it stands in the head, by "
      "{:.1f} deg/s if in the world",
      as_head, as_world);
  constexpr double kClear = 2;
  const bool is_clear = as_head > kClear * as_world || as_world > kClear * as_head;
  return is_clear ? std::optional(as_head > as_world) : std::nullopt;
}

bool is_rotation(const Quatd& q) {
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return std::isfinite(norm) && norm > 1e-6;
}

constexpr std::int64_t kOrientationTracked = 4;  // XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT

bool is_tracked(TableRows& rows, const PoseColumns& c) {
  if (c.flags) {
    std::int64_t flags = 0;
    return scaled_integer(rows.cell(*c.flags), 0, flags) == NumberStatus::ok && (flags & kOrientationTracked) != 0;
  }
  if (c.tracked) {
    const std::string text = to_lower(rows.cell(*c.tracked));
    return text == "1" || text == "true";
  }
  return true;
}

// Turns gaze that stands in the world into the head.
void settle_space(RawGaze& raw, const GazeReadOptions& options, const PoseColumns& c, bool has_head,
                  const std::vector<PosedGaze>& gazes, GazeDistances& places, const std::string& place) {
  if (c.space || !has_head) {
    return;
  }
  bool is_world = options.frame == GazeFrame::world;
  std::string evidence;
  if (options.frame != GazeFrame::world && options.frame != GazeFrame::head) {
    const std::optional<bool> found = is_in_world(places, gazes, evidence);
    if (!found) {
      raw.faults.push_back({"gaze-space", place,
                            "whether the poses of gaze stand in the head or in the world of the head's poses is "
                            "undecided: " +
                                evidence,
                            "say it with `frame` head or `frame` world", "`frame` head or world",
                            "whether gaze stands in the head or in the world is undecided: " + evidence});
    }
    is_world = found.value_or(false);
  }
  add_note(raw, "space of gaze", is_world ? "world, turned into the head" : "head",
           evidence.empty() ? Evidence::option : Evidence::statistics, evidence);
  if (!is_world) {
    return;
  }
  raw.rows.change_each([&](std::size_t i, RawSample sample) {
    sample.at = rotate(inverse(gazes[i].head), sample.at);
    return sample;
  });
}

}  // namespace

double sniff_gaze_openxr(const GazeFile& file) {
  const std::string_view head = head_of(file, 8192);
  if (head.find("gaze") == std::string_view::npos && head.find("Gaze") == std::string_view::npos) {
    return 0.0;
  }
  const GazeFile start{file.path, std::string(head)};
  const DelimitedTable table = open_table(start);
  const PoseColumns c = find_columns(table);
  return table.has_header && c.has_gaze() && c.time ? c.head[0] ? 0.9 : 0.8 : 0.0;
}

RawGaze read_gaze_openxr(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const std::string& place = table.place;
  UsedColumns used(table);
  const PoseColumns c = find_columns(table);
  if (!c.has_gaze() || (!c.time && options.columns.time.empty())) {
    throw Error(ErrorKind::input, place, "there are no columns of time and of gaze's orientation, x, y, z, w",
                "the columns are: " + column_listing(table));
  }
  const bool is_own_table = !c.gaze[0];  // a pose's unit and axes are OpenXR's, a direction's are anybody's
  RawGaze raw = raw_of(file, is_own_table ? "" : "XrTime");
  raw.kind = GazeKind::direction;
  raw.is_own_table = is_own_table;
  const std::size_t time = used.time(options, c.time.value_or(0));
  const auto stated = time_exponent(table.headings[time].unit);
  const auto given = time_exponent_of(options.columns.time_unit);
  const int otherwise = !is_own_table ? 0 : given ? *given : time_exponent_by_statistics(file, table, time, raw);
  const TimeScale scale = declare_time(raw, options, table.headings[time].text, stated.value_or(otherwise),
                                       stated         ? Evidence::header
                                       : is_own_table ? Evidence::statistics
                                                      : Evidence::format,
                                       place);
  const GazeAxes axes = is_own_table || c.is_engines ? options.columns.axes : GazeAxes::gl;
  const GazeAxes head_axes = options.columns.head_axes == GazeAxes::automatic ? axes : options.columns.head_axes;
  const bool has_head = c.head[0].has_value();
  std::vector<PosedGaze> gazes;  // of rows that state no space
  GazeDistances places;
  std::string last_sample_time;
  std::size_t repeats = 0;
  TableRows rows(file, table, table.headings.size());
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(time, scale);
    const Quatd head = rotation_of(rows, c.head);
    const bool head_known = has_head && is_rotation(head);
    if (head_known && c.head_position[0]) {
      const Vec3d head_m = rows.vector(c.head_position);
      const Vec3d gaze_m = rows.vector(c.gaze_position);
      if (is_finite(gaze_m) && is_finite(head_m)) {
        places.from_origin.push_back(length(gaze_m));
        places.from_head.push_back(length(gaze_m - head_m));
      }
      raw.head.push_back(head_pose_from_axes(t_ns, head_m, head, head_axes));
    }
    // Runtimes that cannot interpolate clamp the time, which gives the same sample again. 0 is an unknown time.
    const std::string_view sample_time = rows.cell(c.sample_time);
    if (!sample_time.empty() && sample_time != "0" && sample_time == last_sample_time) {
      ++repeats;
      continue;
    }
    last_sample_time = sample_time;
    RawSample sample = missing_row(t_ns, rows.line(), Eye::cyclopean);
    sample.confidence = static_cast<float>(rows.number(c.confidence));
    const Quatd gaze = rotation_of(rows, c.gaze);
    const Vec3d direction = c.gaze[0] ? rotate(normalize(gaze), ahead_in(axes)) : rows.vector(c.direction);
    if (c.gaze[0] ? is_rotation(gaze) : length(direction) > 0) {
      sample.at = direction;
      sample.validity = is_tracked(rows, c) ? GazeValidity::ok : GazeValidity::lost;
      const std::string space = to_lower(rows.cell(c.space));
      if (!space.empty() && space != "view" && space != "head") {
        if (!head_known) {
          rows.fail(fmt::format("gaze is in the space '{}', and the row has no head orientation", space.substr(0, 20)),
                    "log gaze in the VIEW space, or the head's pose with it");
        }
        sample.at = rotate(inverse(normalize(head)), sample.at);
      }
    }
    gazes.push_back({t_ns, sample.at, head_known ? normalize(head) : Quatd{}});
    raw.rows.push_back(sample);
  }
  settle_space(raw, options, c, has_head, gazes, places, place);
  if (repeats > 0) {
    raw.warnings.push_back(
        fmt::format("{}: {} rows repeat the sample of the row before; left out", file.path, repeats));
  }
  if (c.is_engines && axes == GazeAxes::automatic) {
    const std::string problem = fmt::format(
        "the axes of '{}' are undecided: a rotation of Unity looks along +z, of Unreal along +x, of OpenXR along -z, "
        "and nothing in the numbers tells them apart",
        table.headings[*c.gaze[0]].text);
    raw.faults.push_back(
        {"axes", place, problem, "give `axes` unity, unreal or gl", "`axes` unity, unreal or gl", problem});
  }
  const std::size_t first = c.gaze[0] ? *c.gaze[0] : *c.direction[0];
  declare_directions(raw, {table.headings[first].text + ", ...", Evidence::header},
                     axes == GazeAxes::automatic ? GazeAxes::gl : axes,
                     !is_own_table && !c.is_engines ? Evidence::format
                     : axes == GazeAxes::automatic  ? Evidence::statistics
                                                    : Evidence::option,
                     place);
  return raw;
}

}  // namespace gazetrace
