// SPDX-License-Identifier: Apache-2.0
// Poses as OpenXR defines them and loggers write them: time, gaze_orientation_x .. w (a quaternion xyzw; gaze looks
// along its -z) and, where logged, head_position_x .. and head_orientation_x .. w, flags, the sample's own time. +x
// right, +y up, -z forward. Gaze is in the VIEW space unless a column `space` says otherwise; in that case the head's
// pose of the same row transforms it there.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

using OptionalColumn = std::optional<std::size_t>;
template <std::size_t N>
using Columns = std::array<OptionalColumn, N>;

// "gaze_orientation_x", "gaze.rotation.x", "gaze_qx" and the like.
template <std::size_t N>
Columns<N> find_group(const DelimitedTable& table, std::initializer_list<std::string_view> stems) {
  constexpr std::array<char, 4> kNames{'x', 'y', 'z', 'w'};
  for (const std::string_view stem : stems) {
    Columns<N> columns;
    bool complete = true;
    for (std::size_t i = 0; i < N; ++i) {
      columns[i] = table.find(fmt::format("{}{}", stem, kNames[i]));
      complete = complete && columns[i].has_value();
    }
    if (complete) {
      return columns;
    }
  }
  return {};
}

struct PoseColumns {
  Columns<4> gaze;
  Columns<3> gaze_position, head_position;
  Columns<4> head;
  OptionalColumn time, sample_time, tracked, flags, confidence, space;
};

PoseColumns find_columns(const DelimitedTable& table) {
  PoseColumns c;
  c.gaze = find_group<4>(table, {"gaze orientation ", "gaze rotation ", "gaze pose orientation ",
                                 "eye gaze orientation ", "gaze q", "gaze orientation q"});
  c.gaze_position = find_group<3>(table, {"gaze position ", "gaze pose position ", "eye gaze position ", "gaze p"});
  c.head = find_group<4>(table, {"head orientation ", "head rotation ", "head q", "view orientation ",
                                 "hmd orientation ", "hmd rotation ", "hmd q"});
  c.head_position = find_group<3>(table, {"head position ", "head p", "view position ", "hmd position ", "hmd p"});
  c.time = table.find_any({"time", "timestamp", "xr time", "display time", "predicted display time"});
  c.sample_time = table.find_any({"sample time", "gaze sample time", "gaze time"});
  c.tracked = table.find_any({"gaze tracked", "is tracked", "gaze valid", "is valid", "tracked"});
  c.flags = table.find_any({"location flags", "gaze location flags", "gaze flags"});
  c.confidence = table.find_any({"confidence", "gaze confidence"});
  c.space = table.find_any({"space", "reference space", "gaze space"});
  return c;
}

template <std::size_t N>
std::array<double, N> values(TableRows& rows, const Columns<N>& columns) {
  std::array<double, N> found{};
  for (std::size_t i = 0; i < N; ++i) {
    found[i] = rows.number(columns[i]);
  }
  return found;
}

bool is_rotation(const std::array<double, 4>& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
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

}  // namespace

double sniff_gaze_openxr(const GazeFile& file) {
  const std::string_view head = head_of(file, 8192);
  if (head.find("gaze") == std::string_view::npos && head.find("Gaze") == std::string_view::npos) {
    return 0.0;
  }
  const GazeFile start{file.path, std::string(head)};
  const DelimitedTable table = open_table(start);
  const PoseColumns c = find_columns(table);
  return table.has_header && c.gaze[0] && c.time ? c.head[0] ? 0.9 : 0.8 : 0.0;
}

RawGaze read_gaze_openxr(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const std::string place = place_of(file, table.header_line);
  const PoseColumns c = find_columns(table);
  if (!c.gaze[0] || (!c.time && options.columns.time.empty())) {
    throw Error(ErrorKind::input, place, "there are no columns of time and of gaze's orientation, x, y, z, w",
                "the columns are: " + column_listing(table));
  }
  RawGaze raw;
  raw.source = file.path;
  raw.format = "openxr-pose";
  raw.kind = GazeKind::direction;
  raw.clock = "XrTime";
  const std::size_t time = time_column(table, options, c.time.value_or(0), place);
  const auto stated = time_exponent(table.headings[time].unit);
  const TimeScale scale = declare_time(raw, options, table.headings[time].text, stated.value_or(0),
                                       stated ? Evidence::header : Evidence::format, place);
  const bool has_head = c.head[0].has_value();
  std::string last_sample_time;
  std::size_t repeats = 0;
  TableRows rows(file, table, table.headings.size());
  while (rows.next()) {
    rows.check_length();
    const std::int64_t t_ns = rows.time_ns(time, scale);
    const std::array<double, 4> h = values(rows, c.head);
    const Quatd head{h[0], h[1], h[2], h[3]};
    const bool head_known = has_head && is_rotation(h);
    if (head_known && c.head_position[0]) {
      const auto p = values(rows, c.head_position);
      raw.head.push_back(head_pose_from_axes(t_ns, {p[0], p[1], p[2]}, head, options.columns.head_axes));
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
    const std::array<double, 4> q = values(rows, c.gaze);
    if (is_rotation(q)) {
      sample.at = rotate(normalize(Quatd{q[0], q[1], q[2], q[3]}), {0, 0, -1});
      sample.validity = is_tracked(rows, c) ? GazeValidity::ok : GazeValidity::lost;
      const std::string space = to_lower(rows.cell(c.space));
      if (!space.empty() && space != "view" && space != "head") {
        if (!head_known) {
          rows.fail(fmt::format("gaze is in the space '{}', and the row has no head orientation", space.substr(0, 20)),
                    "log gaze in the VIEW space, or the head's pose with it");
        }
        const Quatd unit = normalize(head);
        sample.at = rotate({-unit.x, -unit.y, -unit.z, unit.w}, sample.at);
      }
    }
    raw.rows.push_back(sample);
  }
  if (repeats > 0) {
    raw.warnings.push_back(
        fmt::format("{}: {} rows repeat the sample of the row before; left out", file.path, repeats));
  }
  declare_directions(raw, {table.headings[*c.gaze[0]].text + ", ...", Evidence::header}, GazeAxes::gl, Evidence::format,
                     place);
  return raw;
}

}  // namespace gazetrace
