// SPDX-License-Identifier: Apache-2.0
#include "gazelog/mapped_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

constexpr double kClosedOpenness = 0.1;

// Makes samples of every source from one row after another.
class RowReader {
 public:
  RowReader(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan, const GazeColumns& columns,
            ValidityStyle style, const TimeScale& time)
      : table_(table),
        plan_(plan),
        columns_(columns),
        style_(style),
        validity_(columns, style),
        recordings_(table, columns.recording,
                    {"participant", "participant name", "participant id", "subject", "subject id", "session",
                     "session id", "recording", "recording name", "recording id"}),
        others_(file, table, plan),
        rows_(file, table, std::max(plan.needed_cells(table), recordings_.needed_cells())),
        time_(time) {
    has_origins_ = std::any_of(plan.sources.begin(), plan.sources.end(),
                               [](const GazeSource& source) { return source.origin[0].has_value(); });
    has_head_ = plan.head_position[0] && plan.head_rotation[0];
  }

  void read_all(RawGaze& raw) {
    while (rows_.next()) {
      if (is_message(raw) || others_.is_other(rows_)) {
        continue;
      }
      rows_.check_length();
      if (recordings_.note(rows_, raw)) {
        last_frame_.clear();
      }
      if (repeats_frame()) {
        continue;
      }
      const std::int64_t t_ns = rows_.time_ns(plan_.time, time_);
      EyeOrigins origins{{nan_, nan_, nan_}, {nan_, nan_, nan_}, t_ns};
      for (const GazeSource& source : plan_.sources) {
        raw.rows.push_back(read_source(source, t_ns, raw.kind, origins));
      }
      if (has_origins_) {
        raw.origins.push_back(origins);
      }
      if (has_head_) {
        read_head(t_ns, raw);
      }
    }
  }

  void add_warnings(RawGaze& raw) const {
    if (rows_.repeated_headers > 0) {
      raw.warnings.push_back(
          fmt::format("{}: rows that repeat the header are skipped: {}", raw.source, rows_.repeated_headers));
    }
    if (repeated_frames_ > 0) {
      raw.warnings.push_back(fmt::format("{}: {} rows repeat the sample counter '{}' of the row before; dropped",
                                         raw.source, repeated_frames_, table_.headings[*plan_.frame].text));
    }
    if (messages_ > 0) {
      add_note(raw, "messages", std::to_string(messages_), Evidence::header, "rows of a time and a text");
    }
    if (others_.left_out > 0) {
      add_note(raw, "rows left out", std::to_string(others_.left_out), Evidence::header,
               fmt::format("of other sensors, by column '{}'", others_.name()));
    }
    const OptionalColumn& validity = plan_.sources.front().validity;
    if (const std::string good = validity ? tally_.reversed() : ""; !good.empty()) {
      const std::string setting = fmt::format("`valid-values` {}", good);
      const std::string problem = tally_.in_words(table_.headings[*validity].text);
      raw.faults.push_back({"validity", table_.place, problem, "give " + setting, setting, problem});
    }
    const auto is_good = [](const RawSample& s) { return s.validity != GazeValidity::lost; };
    if (validity && std::none_of(raw.rows.begin(), raw.rows.end(), is_good)) {
      raw.warnings.push_back(
          fmt::format("{}: no row is valid by column '{}', which holds: {}; say with "
                      "`valid-values` which of them are good",
                      raw.source, table_.headings[*validity].text, fmt::join(validity_.seen(), ", ")));
    }
  }

 private:
  // Rows of a time and a text are messages, which loggers write between those of gaze.
  bool is_message(RawGaze& raw) {
    std::size_t time = plan_.time;
    const std::string_view text = rows_.is_short() ? text_of_message(rows_, time) : "";
    std::int64_t t_ns = 0;
    if (text.empty() || scaled_integer(rows_.cell(time), time_.exponent, t_ns) != NumberStatus::ok) {
      return false;
    }
    add_message(raw, t_ns, std::string(text), rows_.line());
    ++messages_;
    return true;
  }

  bool repeats_frame() {
    if (!plan_.frame) {
      return false;
    }
    const std::string_view frame = rows_.cell(*plan_.frame);
    const bool repeats = !frame.empty() && frame == last_frame_;
    last_frame_ = frame;
    repeated_frames_ += repeats ? 1 : 0;
    return repeats;
  }

  RawSample read_source(const GazeSource& source, std::int64_t t_ns, GazeKind kind, EyeOrigins& origins) {
    RawSample sample;
    sample.row = rows_.line();
    sample.t_ns = t_ns;
    sample.eye = source.eye;
    sample.confidence = static_cast<float>(rows_.number(source.confidence));
    sample.pupil = static_cast<float>(rows_.number(source.pupil));
    if (columns_.valid_mask != 0 && sample.pupil <= 0) {
      sample.pupil = nan_;  // SDKs with bit masks write -1
    }
    if (plan_.eye && (source.eye == Eye::cyclopean || plan_.sources.size() == 1)) {
      const std::string_view text = rows_.cell(*plan_.eye);
      const auto eye = eye_from(text);
      if (!eye) {
        rows_.fail(fmt::format("eye '{}' is not left, right or cyclopean", text),
                   "mend the row, or leave the column out");
      }
      sample.eye = *eye;
    }
    if (source.validity) {
      const std::string_view text = rows_.cell(*source.validity);
      const auto validity = validity_.read(text);
      if (!validity) {
        rows_.fail(unknown_name_message("validity", text,
                                        {"ok", "low_confidence", "blink", "lost", "off_screen", "interpolated"}),
                   "");
      }
      sample.validity = *validity;
    }
    if (source.openness && rows_.number(*source.openness) <= kClosedOpenness) {
      sample.validity = GazeValidity::blink;
    }
    read_position(source, kind, sample);
    if (source.validity && columns_.valid_mask == 0) {
      tally_.add(rows_.cell(*source.validity), sample);
    }
    read_origin(source, sample.eye, origins);
    return sample;
  }

  void read_position(const GazeSource& source, GazeKind kind, RawSample& sample) {
    const double x = plan_.x_grows_left ? -rows_.number(source.x) : rows_.number(source.x);
    const double y = rows_.number(source.y);
    const double z = source.z ? rows_.number(*source.z) : 0.0;
    // Loggers write unknown values as zeros: (0, 0) without a validity is a missing value, not the corner.
    const bool said_bad = !is_usable(sample.validity) || sample.confidence == 0.0F;
    const bool zero = x == 0 && y == 0 && z == 0;
    const bool missing = std::isnan(x) || std::isnan(y) || std::isnan(z) ||
                         (zero && ((said_bad && style_ == ValidityStyle::any) || kind == GazeKind::direction));
    if (missing && is_usable(sample.validity)) {
      sample.validity = GazeValidity::lost;
    }
    if (kind == GazeKind::direction) {
      sample.at = missing ? Vec3d{kNan, kNan, kNan} : Vec3d{x, y, z};
    } else {
      sample.at.x = missing ? kNan : x;
      sample.at.y = missing ? kNan : y;
    }
  }

  void read_origin(const GazeSource& source, Eye eye, EyeOrigins& origins) {
    if (!source.origin[0] || eye == Eye::cyclopean) {
      return;
    }
    Vec3f& origin = eye == Eye::left ? origins.left_mm : origins.right_mm;
    origin = to_float(rows_.vector(source.origin) * columns_.origin_mm_per_unit);
  }

  void read_head(std::int64_t t_ns, RawGaze& raw) {
    const Vec3d position = rows_.vector(plan_.head_position) * columns_.head_m_per_unit;
    const Vec3d rotation = rows_.vector(plan_.head_rotation);
    const Quatd q = plan_.head_w ? Quatd{rotation.x, rotation.y, rotation.z, rows_.number(*plan_.head_w)}
                                 : quaternion_from_unity_euler_deg(rotation);
    raw.head.push_back(head_pose_from_axes(t_ns, position, q, columns_.head_axes));
  }

  static constexpr float nan_ = std::numeric_limits<float>::quiet_NaN();
  const DelimitedTable& table_;
  const ColumnPlan& plan_;
  const GazeColumns& columns_;
  ValidityStyle style_;
  ValidityReader validity_;
  RecordingColumns recordings_;
  OtherSensors others_;
  ValidityTally tally_;
  TableRows rows_;
  TimeScale time_;
  bool has_origins_ = false;
  bool has_head_ = false;
  std::string last_frame_;
  std::size_t repeated_frames_ = 0, messages_ = 0;
};

// .NET counts steps of 100 ns from the year 1, which exceeds int64 nanoseconds, so the stamps are counted from 1970.
TimeScale time_scale(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan,
                     const GazeColumns& columns, Evidence declared, RawGaze& raw) {
  constexpr std::int64_t kTicksTo1970 = 621'355'968'000'000'000;
  TimeScale scale{plan.time_exponent ? *plan.time_exponent : time_exponent_by_statistics(file, table, plan.time, raw),
                  0};
  const std::string& name = table.headings[plan.time].text;
  TableRows rows(file, table, plan.time + 1);
  std::int64_t first = 0;
  if (scale.exponent == 2 && rows.next() && scaled_integer(rows.cell(plan.time), 0, first) == NumberStatus::ok &&
      first > kTicksTo1970) {
    scale.subtract = kTicksTo1970;
    raw.clock = "computer clock, from 1970";
  }
  raw.declared.time_column = {name, columns.time.empty() ? Evidence::header : declared, {}};
  const Evidence evidence = columns.time_unit != TimeUnit::automatic ? declared
                            : plan.time_exponent                     ? Evidence::header
                                                                     : Evidence::statistics;
  raw.declared.time_exponent = {scale.exponent, evidence,
                                scale.subtract == 0 ? "" : ".NET ticks; counted from 1970 here"};
  return scale;
}

std::string position_columns(const ColumnPlan& plan, const DelimitedTable& table) {
  std::string text;
  for (const GazeSource& source : plan.sources) {
    for (const OptionalColumn& column : {OptionalColumn(source.x), OptionalColumn(source.y), source.z}) {
      text += column ? (text.empty() ? "" : ", ") + table.headings[*column].text : "";
    }
  }
  return text;
}

void declare_positions(RawGaze& raw, const ColumnPlan& plan, const GazeFile& file, const DelimitedTable& table,
                       const GazeColumns& columns, ValidityStyle style, Evidence declared) {
  const std::string& place = table.place;
  const std::string names = position_columns(plan, table);
  if (raw.kind == GazeKind::direction) {
    const bool is_default = columns.axes == GazeAxes::automatic;
    declare_directions(raw, {names, Evidence::header}, is_default ? GazeAxes::gl : columns.axes,
                       !is_default                     ? declared
                       : style == ValidityStyle::names ? Evidence::format
                                                       : Evidence::statistics,
                       place);
    raw.declared.unit.evidence = Evidence::header;
    return;
  }
  // Fractions of gazetrace CSV count from the top left by definition; of other tables it is only likely.
  const bool defined = style == ValidityStyle::names && plan.unit == PositionUnit::fraction;
  const bool is_default = columns.origin == PositionOrigin::automatic;
  declare_places(raw,
                 {plan.unit,
                  !is_default ? columns.origin
                  : defined   ? PositionOrigin::top_left
                              : origin_in_column(file, table, raw),
                  plan.unit_evidence == Evidence::option ? declared : plan.unit_evidence, names,
                  // A log that names the state of each sample has stated its validity itself.
                  style == ValidityStyle::names && plan.sources.front().validity.has_value(),
                  !is_default ? declared
                  : defined   ? Evidence::format
                              : Evidence::header},
                 place);
  raw.directions_grow_up = true;
  const std::string x_name = letters_and_digits(table.headings[plan.sources.front().x].name);
  // Angles of the eye, on no display.
  raw.declared.degrees_are_directions = x_name.ends_with("yaw") || x_name.ends_with("azimuth");
  if (plan.x_grows_left) {
    add_note(raw, "frame", "CPF, x to the left; turned to the right", Evidence::header, "Project Aria's");
  }
}

}  // namespace

int time_exponent_by_statistics(const GazeFile& file, const DelimitedTable& table, std::size_t column, RawGaze& raw) {
  const auto exponent = guess_time_exponent(first_stamps(file, table, column, true));
  const std::string& name = table.headings[column].text;
  if (!exponent) {
    throw Error(ErrorKind::input, table.place,
                fmt::format("the unit of time column '{}' is not stated and cannot be guessed from its steps", name),
                "give `time-unit`, or write it into the header: t[ms]");
  }
  raw.warnings.push_back(fmt::format("{}: guessed from its steps that '{}' is in {}; state it with `time-unit`",
                                     table.place, name, time_unit_text(*exponent)));
  return *exponent;
}

RawGaze read_mapped_table(const GazeFile& file, const DelimitedTable& table, const GazeColumns& columns,
                          ValidityStyle style, Evidence evidence) {
  if (table.headings.empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample",
                "a gaze log needs a header and at least one row below it");
  }
  if (table.headings.size() < 3) {
    throw Error(ErrorKind::input, table.place,
                fmt::format("'{}' is not a table of time and position", trim(table.header).substr(0, 60)),
                "separate the cells by commas, semicolons or tabs");
  }
  if (!table.has_header && (columns.time.empty() || (columns.x.empty() && columns.left.x.empty()))) {
    throw Error(ErrorKind::input, table.place,
                fmt::format("there is no header, only {} columns of numbers", table.headings.size()),
                "say by number which is which: `time-column` 1 `x-column` 2 `y-column` 3");
  }
  const GazetracePreamble preamble = read_preamble(file, table);
  const GazeColumns with_z = style == ValidityStyle::any ? with_z_beside(file, table, columns) : columns;
  const ColumnPlan plan = plan_columns(table, with_z);
  RawGaze raw = raw_of(file, preamble.stated.clock, plan.pupil_unit);
  raw.recording_geometry = preamble.stated.recording_geometry;
  raw.pixels_per_degree = preamble.stated.pixels_per_degree;
  find_sum_of_eyes(file, table, plan, raw);
  if (columns.x.empty() && style == ValidityStyle::any) {
    find_other_things(table, plan, raw);
  }
  raw.kind = plan.kind;
  const std::string sign = style == ValidityStyle::any ? sign_of_scene_camera(table, plan) : "";
  if (preamble.stated.kind == GazeKind::scene_camera || !sign.empty()) {
    raw.way_out = sign.empty() ? "`frame` scene-camera looks at it"
                               : fmt::format(
                                     "column '{}' says so: map gaze onto the display, or look at it with `frame` "
                                     "scene-camera",
                                     sign);
    raw.kind = GazeKind::scene_camera;
  }
  raw.warnings = plan.warnings;
  if (trim(table.body).empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample", "a gaze log needs at least one row below its header");
  }
  const TimeScale time = time_scale(file, table, plan, columns, evidence, raw);
  RowReader rows(file, table, plan, columns, style, time);
  rows.read_all(raw);
  declare_positions(raw, plan, file, table, columns, style, evidence);
  rows.add_warnings(raw);
  return raw;
}

RawGaze read_preset(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                    const GazeColumns& preset) {
  return read_mapped_table(file, table, merge_gaze_columns(preset, options.columns), ValidityStyle::any,
                           options.columns == GazeColumns{} ? Evidence::format : Evidence::option);
}

}  // namespace gazetrace
