// SPDX-License-Identifier: Apache-2.0
#include "gazelog/mapped_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/missing_values.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

constexpr double kClosedOpenness = 0.1;

// One row after another into samples of every source.
class RowReader {
 public:
  RowReader(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan, const GazeColumns& columns,
            ValidityStyle style, const TimeScale& time)
      : plan_(plan),
        columns_(columns),
        style_(style),
        validity_(columns, style),
        rows_(file, table, plan.needed_cells()),
        time_(time) {
    for (const GazeSource& source : plan.sources) {
      has_origins_ = has_origins_ || source.origin[0].has_value();
    }
    has_head_ = plan.head_position[0] && plan.head_rotation[0];
  }

  void read_all(GazeLog& log) {
    while (rows_.next()) {
      rows_.check_length();
      if (repeats_frame()) {
        continue;
      }
      const std::int64_t t_ns = rows_.time_ns(plan_.time, time_);
      EyeOrigins origins{{nan_, nan_, nan_}, {nan_, nan_, nan_}, t_ns};
      for (const GazeSource& source : plan_.sources) {
        log.samples.push_back(read_source(source, t_ns, log.kind, origins));
      }
      if (has_origins_) {
        log.origins.push_back(origins);
      }
      if (has_head_) {
        read_head(t_ns, log);
      }
    }
    repeated_headers = rows_.repeated_headers;
  }

  [[nodiscard]] const ValidityReader& validity() const { return validity_; }
  std::size_t repeated_headers = 0;
  std::size_t repeated_frames = 0;
  std::size_t zero_pairs = 0;  // exactly (0, 0) without a word on their validity

 private:
  bool repeats_frame() {
    if (!plan_.frame) {
      return false;
    }
    const std::string_view frame = rows_.cell(*plan_.frame);
    const bool repeats = !frame.empty() && frame == last_frame_;
    last_frame_ = frame;
    repeated_frames += repeats ? 1 : 0;
    return repeats;
  }

  GazeSample read_source(const GazeSource& source, std::int64_t t_ns, GazeKind kind, EyeOrigins& origins) {
    GazeSample sample;
    sample.row = rows_.line();
    sample.t_ns = t_ns;
    sample.eye = source.eye;
    sample.confidence = static_cast<float>(rows_.number(source.confidence));
    sample.pupil = static_cast<float>(rows_.number(source.pupil));
    if (columns_.valid_mask != 0 && sample.pupil <= 0) {
      sample.pupil = nan_;  // SDKs with bit masks write -1
    }
    if (plan_.eye && source.eye == Eye::cyclopean) {
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
    read_origin(source, sample.eye, origins);
    return sample;
  }

  void read_position(const GazeSource& source, GazeKind kind, GazeSample& sample) {
    const double x = rows_.number(source.x);
    const double y = rows_.number(source.y);
    const double z = source.z ? rows_.number(*source.z) : 0.0;
    // Loggers write what they do not know as zeros: (0, 0) without validity is missing, not the corner.
    const bool said_bad = !is_usable(sample.validity) || sample.confidence == 0.0F;
    const bool zero = x == 0 && y == 0 && z == 0;
    const bool missing = std::isnan(x) || std::isnan(y) || std::isnan(z) ||
                         (zero && ((said_bad && style_ == ValidityStyle::any) || kind == GazeKind::direction));
    if (missing && is_usable(sample.validity)) {
      sample.validity = GazeValidity::lost;
    }
    zero_pairs += zero && !missing && !source.validity ? 1 : 0;
    if (kind == GazeKind::direction) {
      sample.direction = missing ? Vec3d{kNan, kNan, kNan} : Vec3d{x, y, z};
    } else {
      sample.u = missing ? kNan : x;
      sample.v = missing ? kNan : y;
    }
  }

  void read_origin(const GazeSource& source, Eye eye, EyeOrigins& origins) {
    if (!source.origin[0] || eye == Eye::cyclopean) {
      return;
    }
    const auto scale = columns_.origin_mm_per_unit;
    Vec3f& origin = eye == Eye::left ? origins.left_mm : origins.right_mm;
    origin = {static_cast<float>(scale * rows_.number(source.origin[0])),
              static_cast<float>(scale * rows_.number(source.origin[1])),
              static_cast<float>(scale * rows_.number(source.origin[2]))};
  }

  void read_head(std::int64_t t_ns, GazeLog& log) {
    const auto vector = [&](const auto& c) {
      return Vec3d{rows_.number(c[0]), rows_.number(c[1]), rows_.number(c[2])};
    };
    const Vec3d position = vector(plan_.head_position) * columns_.head_m_per_unit;
    const Vec3d rotation = vector(plan_.head_rotation);
    const Quatd q = plan_.head_rotation[3]
                        ? Quatd{rotation.x, rotation.y, rotation.z, rows_.number(*plan_.head_rotation[3])}
                        : quaternion_from_unity_euler_deg(rotation);
    log.head.push_back(head_pose_from_axes(t_ns, position, q, columns_.head_axes));
  }

  static constexpr float nan_ = std::numeric_limits<float>::quiet_NaN();
  const ColumnPlan& plan_;
  const GazeColumns& columns_;
  ValidityStyle style_;
  ValidityReader validity_;
  TableRows rows_;
  TimeScale time_;
  bool has_origins_ = false;
  bool has_head_ = false;
  std::string last_frame_;
};

int time_exponent_by_statistics(const GazeFile& file, const DelimitedTable& table, std::size_t column, GazeLog& log) {
  const std::string place = place_of(file, table.header_line);
  std::vector<double> times;
  TableRows rows(file, table, column + 1);
  while (times.size() < 2000 && rows.next()) {
    if (const auto value = number_from(rows.cell(column))) {
      times.push_back(*value);
    }
  }
  const auto exponent = guess_time_exponent(times);
  const std::string& name = table.headings[column].text;
  if (!exponent) {
    throw Error(ErrorKind::input, place,
                fmt::format("the unit of time column '{}' is not stated and cannot be guessed from its steps", name),
                "give --gaze-time-unit, or write it into the header: t[ms]");
  }
  log.warnings.push_back(fmt::format("{}: guessed from its steps that '{}' is in {}; state it with --gaze-time-unit",
                                     place, name, time_unit_text(*exponent)));
  return *exponent;
}

// .NET counts 100 ns from the year 1, which is beyond int64 nanoseconds: from 1970 then.
TimeScale time_scale(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan,
                     const GazeColumns& columns, Evidence declared, GazeLog& log) {
  constexpr std::int64_t kTicksTo1970 = 621'355'968'000'000'000;
  TimeScale scale{plan.time_exponent ? *plan.time_exponent : time_exponent_by_statistics(file, table, plan.time, log),
                  0};
  const std::string& name = table.headings[plan.time].text;
  TableRows rows(file, table, plan.time + 1);
  std::int64_t first = 0;
  if (scale.exponent == 2 && rows.next() && scaled_integer(rows.cell(plan.time), 0, first) == NumberStatus::ok &&
      first > kTicksTo1970) {
    scale.subtract = kTicksTo1970;
    log.clock = "computer clock, from 1970";
  }
  add_fact(log, "time column", name, columns.time.empty() ? Evidence::header : declared);
  const Evidence evidence = columns.time_unit != TimeUnit::automatic ? declared
                            : plan.time_exponent                     ? Evidence::header
                                                                     : Evidence::statistics;
  add_fact(log, "time unit", time_unit_text(scale.exponent), evidence,
           scale.subtract == 0 ? "" : ".NET ticks; counted from 1970 here");
  return scale;
}

void add_row_warnings(GazeLog& log, const RowReader& rows, const ColumnPlan& plan, const DelimitedTable& table) {
  const std::size_t count = log.samples.size();
  if (rows.repeated_headers > 0) {
    log.warnings.push_back(
        fmt::format("{}: the header is repeated {} times; skipped", log.source, rows.repeated_headers));
  }
  if (rows.repeated_frames > 0) {
    log.warnings.push_back(fmt::format("{}: {} rows repeat the sample counter '{}' of the row before; dropped",
                                       log.source, rows.repeated_frames, table.headings[*plan.frame].text));
  }
  if (rows.zero_pairs * 20 > count) {
    log.warnings.push_back(
        fmt::format("{}: {} of {} positions are exactly (0, 0): missing values written as zero? Name a validity column",
                    log.source, rows.zero_pairs, count));
  }
  const OptionalColumn& validity = plan.sources.front().validity;
  const auto is_good = [](const GazeSample& s) { return s.validity != GazeValidity::lost; };
  if (validity && std::none_of(log.samples.begin(), log.samples.end(), is_good)) {
    log.warnings.push_back(
        fmt::format("{}: no row is valid by column '{}', which holds: {}; say with "
                    "--gaze-valid-values which of them are good",
                    log.source, table.headings[*validity].text, fmt::join(rows.validity().seen(), ", ")));
  }
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

void finish_positions(GazeLog& log, const ColumnPlan& plan, const GazeFile& file, const DelimitedTable& table,
                      const GazeReadOptions& options, ValidityStyle style, Evidence declared) {
  const std::string place = place_of(file, table.header_line);
  if (log.kind == GazeKind::direction) {
    add_fact(log, "position columns", position_columns(plan, table), Evidence::header);
    add_fact(log, "position unit", "unit-vector", Evidence::header);
    // The axes of a map are part of it, not a contradiction to it.
    GazeReadOptions settled = options;
    settled.columns.axes = GazeAxes::automatic;
    finish_directions(log, settled, options.columns.axes == GazeAxes::automatic ? GazeAxes::gl : options.columns.axes,
                      options.columns.axes == GazeAxes::automatic ? Evidence::format : declared, place);
    return;
  }
  PlaceSpace space{plan.unit, PositionOrigin::top_left,
                   plan.unit_evidence == Evidence::option ? declared : plan.unit_evidence,
                   position_columns(plan, table),
                   // A log that names the state of each sample has said so itself.
                   style == ValidityStyle::names && plan.sources.front().validity.has_value(),
                   options.columns.origin == PositionOrigin::automatic ? Evidence::format : declared};
  if (space.unit == PositionUnit::automatic) {
    mark_missing_values(log, options);  // would widen the range that is guessed from
    std::string evidence;
    space.unit = guess_position_unit(log.samples, evidence);
    space.evidence = Evidence::statistics;
    log.warnings.push_back(
        fmt::format("{}: guessed from its values ({}) that the positions are in {}; state it with "
                    "--gaze-unit",
                    place, evidence, to_string(space.unit)));
  }
  // Fractions of gazetrace CSV count from the top left by definition; of other tables it is only likely.
  const bool defined = style == ValidityStyle::names && space.unit == PositionUnit::fraction;
  space.origin = options.columns.origin != PositionOrigin::automatic ? options.columns.origin
                 : defined                                           ? PositionOrigin::top_left
                                                                     : PositionOrigin::automatic;
  GazeReadOptions settled = options;
  settled.columns.position_unit = PositionUnit::automatic;
  settled.columns.origin = PositionOrigin::automatic;
  finish_places(log, settled, space, place);
}

}  // namespace

GazeLog read_mapped_table(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                          const GazeColumns& columns, ValidityStyle style, Evidence evidence) {
  if (table.headings.empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample",
                "a gaze log needs a header and at least one row below it");
  }
  const std::string place = place_of(file, table.header_line);
  if (table.headings.size() < 3) {
    throw Error(ErrorKind::input, place,
                fmt::format("'{}' is not a table of time and position", trim(table.header).substr(0, 60)),
                "separate the cells by commas, semicolons or tabs");
  }
  if (!table.has_header && (columns.time.empty() || (columns.x.empty() && columns.left.x.empty()))) {
    throw Error(ErrorKind::input, place,
                fmt::format("there is no header, only {} columns of numbers", table.headings.size()),
                "say by number which is which: --gaze-time-column 1 --gaze-x-column 2 --gaze-y-column 3");
  }
  const GazetracePreamble preamble = read_preamble(file, table);
  const ColumnPlan plan = plan_columns(table, columns, place);
  GazeLog log;
  log.source = file.path;
  log.kind = plan.kind;
  log.clock = preamble.clock;
  log.recording_geometry = preamble.geometry;
  log.pixels_per_degree = preamble.pixels_per_degree;
  if (preamble.is_scene_camera) {
    if (options.frame == GazeFrame::automatic) {
      refuse_scene_camera(file, options, "--gaze-frame scene-camera looks at it");
    }
    log.kind = GazeKind::scene_camera;
  }
  log.pupil_unit = plan.pupil_unit;
  log.warnings = plan.warnings;
  if (trim(table.body).empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample", "a gaze log needs at least one row below its header");
  }
  const TimeScale time = time_scale(file, table, plan, columns, evidence, log);
  log.samples.reserve((static_cast<std::size_t>(std::count(table.body.begin(), table.body.end(), '\n')) + 1) *
                      plan.sources.size());
  RowReader rows(file, table, plan, columns, style, time);
  rows.read_all(log);
  GazeReadOptions with_columns = options;
  with_columns.columns = columns;
  finish_positions(log, plan, file, table, with_columns, style, evidence);
  add_row_warnings(log, rows, plan, table);
  finish_head(log);
  return log;
}

GazeLog read_preset(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                    const GazeColumns& preset) {
  return read_mapped_table(file, table, options, merge_gaze_columns(preset, options.columns), ValidityStyle::any,
                           options.columns == GazeColumns{} ? Evidence::format : Evidence::option);
}

void mend_handedness(GazeLog& log) {
  std::vector<float> differences;
  for (const EyeOrigins& origins : log.origins) {
    const float difference = origins.left_mm.x - origins.right_mm.x;
    if (std::isfinite(difference) && difference != 0) {
      differences.push_back(difference);
    }
  }
  if (differences.empty()) {
    return;
  }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  const std::string seen = fmt::format("the left eye lies {:.0f} mm to the {} of the right one in these axes",
                                       std::abs(*middle), *middle < 0 ? "left" : "right");
  add_fact(log, "handedness", *middle < 0 ? "as the format has it" : "x was turned already; turned back",
           Evidence::statistics, seen);
  if (*middle < 0) {
    return;
  }
  for (GazeSample& sample : log.samples) {
    sample.direction.x = -sample.direction.x;
  }
  for (EyeOrigins& origins : log.origins) {
    origins.left_mm.x = -origins.left_mm.x;
    origins.right_mm.x = -origins.right_mm.x;
  }
}

}  // namespace gazetrace
