// SPDX-License-Identifier: Apache-2.0
#include "gazelog/read_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gazelog/missing_values.hpp"
#include "gazelog/recording_geometry.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

void mark_off_screen(std::vector<GazeSample>& samples) {
  for (GazeSample& sample : samples) {
    const bool inside = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
    if (sample.validity == GazeValidity::ok && !inside) {
      sample.validity = GazeValidity::off_screen;
    }
  }
}

// The smallest usual display that holds nearly all places: good enough to look at a log, never to render from one.
void guess_display(GazeLog& log, std::optional<DisplayGeometry>& display, const std::string& place) {
  static constexpr std::array<std::array<int, 2>, 12> kUsual{{{640, 480},
                                                              {800, 600},
                                                              {1024, 768},
                                                              {1280, 720},
                                                              {1280, 1024},
                                                              {1600, 900},
                                                              {1680, 1050},
                                                              {1920, 1080},
                                                              {1920, 1200},
                                                              {2560, 1440},
                                                              {3840, 2160},
                                                              {7680, 4320}}};
  std::size_t usable = 0;
  std::array<std::size_t, kUsual.size()> inside{};
  for (const GazeSample& sample : log.samples) {
    if (!is_usable(sample.validity)) {
      continue;
    }
    ++usable;
    for (std::size_t i = 0; i < kUsual.size(); ++i) {
      inside[i] += sample.u <= kUsual[i][0] && sample.v <= kUsual[i][1] ? 1 : 0;
    }
  }
  std::size_t best = 0;
  while (best + 1 < kUsual.size() && inside[best] * 100 < usable * 98) {
    ++best;
  }
  if (!display) {
    display.emplace();
  }
  display->width_px = kUsual[best][0];
  display->height_px = kUsual[best][1];
  add_fact(log, "display size", fmt::format("{}x{} px", display->width_px, display->height_px), Evidence::statistics,
           "the smallest usual display that holds 98 % of the positions");
  log.warnings.push_back(fmt::format(
      "{}: the size of the display is not stated; {}x{} px were guessed from the positions to look at them; "
      "give --screen-px W,H",
      place, display->width_px, display->height_px));
}

void directions_from_degrees(GazeLog& log, const GazeReadOptions& options) {
  log.kind = GazeKind::direction;
  const double up = options.columns.origin == PositionOrigin::top_left ? -1.0 : 1.0;
  for (GazeSample& sample : log.samples) {
    // Azimuth and elevation taken as independent, as on a flat display: (tan az, tan el, -1).
    const bool known = std::abs(sample.u) < 90 && std::abs(sample.v) < 90;
    sample.direction = known
                           ? normalize(Vec3d{std::tan(sample.u * kRadPerDeg), up * std::tan(sample.v * kRadPerDeg), -1})
                           : Vec3d{kNan, kNan, kNan};
    if (!known && is_usable(sample.validity)) {
      sample.validity = GazeValidity::lost;
    }
    sample.u = sample.v = 0;
  }
}

void add_flip_facts(GazeLog& log, const GazeReadOptions& options) {
  if (options.flip_x) {
    add_fact(log, "left and right", "exchanged", Evidence::option);
  }
  if (options.flip_y) {
    add_fact(log, "top and bottom", "exchanged", Evidence::option);
  }
}

void flip_directions(GazeLog& log, const GazeReadOptions& options) {
  if (options.flip_x || options.flip_y) {
    for (GazeSample& sample : log.samples) {
      sample.direction.x *= options.flip_x ? -1 : 1;
      sample.direction.y *= options.flip_y ? -1 : 1;
    }
    add_flip_facts(log, options);
  }
}

// The witnesses follow what is done to the gaze beside them.
void turn_witnesses(GazeLog& log, const GazeReadOptions& options, bool other_way_up) {
  for (GazeWitness& w : log.witnesses) {
    if (options.swap_xy) {
      std::swap(w.xx, w.yx);
      std::swap(w.yy, w.xy);
    }
    const double x_sign = options.flip_x ? -1 : 1;
    const double y_sign = options.flip_y != other_way_up ? -1 : 1;
    w.xx *= x_sign;
    w.xy *= x_sign;
    w.yy *= y_sign;
    w.yx *= y_sign;
  }
}

void note_mark(GazeLog& log, const std::vector<FrequentPlace>& frequent) {
  if (const auto mark = find_mark(log, frequent)) {
    log.recurring_place = RecurringPlace{mark->raw.x, mark->raw.y, mark->rows};
  }
}

// Of directions only those that loggers write: three times one number, and straight ahead.
void note_mark_of_directions(GazeLog& log, const std::vector<FrequentPlace>& frequent) {
  if (const auto mark = find_mark(log, frequent)) {
    const Vec3d& raw = mark->raw;
    if ((raw.x == raw.y && raw.y == raw.z) || (raw.x == 0 && raw.y == 0)) {
      log.recurring_place = RecurringPlace{raw.x, raw.y, mark->rows};
    }
  }
}

bool grows_up(const PlaceSpace& space) {
  return space.unit == PositionUnit::deg || space.origin == PositionOrigin::bottom_left ||
         space.origin == PositionOrigin::center;
}

PlaceSpace overrule(GazeLog& log, const GazeReadOptions& options, const PlaceSpace& space, const std::string& place) {
  PlaceSpace chosen = space;
  const PositionUnit unit = options.columns.position_unit;
  const PositionOrigin origin = options.columns.origin;
  Evidence unit_evidence = space.evidence;
  Evidence origin_evidence = space.origin_evidence.value_or(space.evidence);
  if (unit != PositionUnit::automatic && unit != space.unit) {
    log.warnings.push_back(fmt::format("{}: positions of {} are in {}; --gaze-unit {} was given and is used", place,
                                       log.format, to_string(space.unit), to_string(unit)));
    chosen.unit = unit;
    chosen.origin = unit == PositionUnit::deg ? PositionOrigin::center : space.origin;
    unit_evidence = Evidence::option;
  }
  if (origin != PositionOrigin::automatic && origin != chosen.origin) {
    log.warnings.push_back(fmt::format("{}: positions of {} count from the {}; --gaze-origin {} was given and is used",
                                       place, log.format, to_string(chosen.origin), to_string(origin)));
    chosen.origin = origin;
    origin_evidence = Evidence::option;
  }
  add_fact(log, "position columns", space.columns, Evidence::header);
  add_fact(log, "position unit", std::string(to_string(chosen.unit)), unit_evidence);
  const bool guessed = chosen.origin == PositionOrigin::automatic;
  const PositionOrigin likely = chosen.unit == PositionUnit::deg ? PositionOrigin::center : PositionOrigin::top_left;
  add_fact(log, "origin", std::string(to_string(guessed ? likely : chosen.origin)),
           guessed ? Evidence::statistics : origin_evidence);
  return chosen;
}

}  // namespace

void add_fact(GazeLog& log, std::string what, std::string value, Evidence evidence, std::string detail) {
  log.facts.push_back({std::move(what), std::move(value), evidence, std::move(detail)});
}

TimeScale choose_time_unit(GazeLog& log, const GazeReadOptions& options, std::string_view column, int stated,
                           Evidence evidence, const std::string& place) {
  const auto flag = time_exponent_of(options.columns.time_unit);
  if (flag && *flag != stated) {
    log.warnings.push_back(fmt::format("{}: {} says that '{}' is in {}; --gaze-time-unit {} was given and is used",
                                       place, evidence == Evidence::header ? "the header" : "the format", column,
                                       time_unit_text(stated), time_unit_text(*flag)));
  }
  const int exponent = flag.value_or(stated);
  add_fact(log, "time column", std::string(column), options.columns.time.empty() ? Evidence::header : Evidence::option);
  add_fact(log, "time unit", time_unit_text(exponent), flag ? Evidence::option : evidence);
  return {exponent, 0};
}

std::size_t time_column(const DelimitedTable& table, const GazeReadOptions& options, std::size_t own,
                        const std::string& place) {
  return options.columns.time.empty() ? own : declared_column(table, options.columns.time, place);
}

void WitnessTally::add(double x, double y, double witness_x, double witness_y) {
  const std::array<double, 4> value{x, y, witness_x, witness_y};
  if (!std::isfinite(x + y + witness_x + witness_y)) {
    return;
  }
  ++count_;
  std::array<double, 4> before{};
  for (std::size_t i = 0; i < 4; ++i) {
    before[i] = value[i] - mean_[i];
    mean_[i] += before[i] / static_cast<double>(count_);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      product_[i][j] += before[i] * (value[j] - mean_[j]);
    }
  }
}

void WitnessTally::finish(GazeLog& log, std::string what, std::optional<Eye> eye) const {
  constexpr std::size_t kLeast = 5;
  if (count_ < kLeast) {
    return;
  }
  const auto correlation = [&](std::size_t i, std::size_t j) {
    const double spread = std::sqrt(product_[i][i]) * std::sqrt(product_[j][j]);
    return spread > 0 ? product_[i][j] / spread : kNan;
  };
  log.witnesses.push_back(
      {std::move(what), count_, correlation(0, 2), correlation(1, 3), correlation(0, 3), correlation(1, 2), eye});
}

void finish_places(GazeLog& log, const GazeReadOptions& options, const PlaceSpace& space, const std::string& place) {
  mark_missing_values(log, options);
  for (GazeSample& sample : log.samples) {
    if (sample.u == 0 && sample.v == 0) {
      if (options.zero_is_missing) {
        sample.u = sample.v = kNan;
        sample.validity = is_usable(sample.validity) ? GazeValidity::lost : sample.validity;
      } else {
        log.zero_positions += is_usable(sample.validity) ? 1 : 0;
      }
    }
    if (options.swap_xy) {
      std::swap(sample.u, sample.v);
    }
  }
  const PlaceSpace chosen = overrule(log, options, space, place);
  const bool is_stated = chosen.unit != space.unit || space.evidence != Evidence::statistics;
  if (options.for_inspection && is_stated && log.kind == GazeKind::screen) {
    const DisplayGeometry display = completed_geometry(options.display.value_or(DisplayGeometry{}),
                                                       log.recording_geometry.value_or(DisplayGeometry{}));
    // Degrees count from straight ahead, whatever else the log's positions count from.
    const PositionOrigin origin = chosen.unit == PositionUnit::deg ? space.origin : chosen.origin;
    if (auto doubt = doubt_position_unit(log.samples, chosen.unit, origin, display)) {
      log.faults.push_back(*std::move(doubt));
    }
  }
  turn_witnesses(log, options, grows_up(chosen) != grows_up(space));
  const bool look_only = options.guess_display || options.for_inspection;
  const std::vector<FrequentPlace> frequent =
      options.for_inspection ? frequent_places(log.samples, GazeKind::screen) : std::vector<FrequentPlace>();
  if (chosen.unit == PositionUnit::deg &&
      (options.frame == GazeFrame::head || (look_only && !options.display && !log.recording_geometry))) {
    directions_from_degrees(log, options);
    flip_directions(log, options);
    note_mark(log, frequent);
    return;
  }
  std::optional<DisplayGeometry> display = conversion_display(log, options, place);
  const bool sized = display && display->width_px > 0 && display->height_px > 0;
  if (chosen.unit == PositionUnit::px && !sized && look_only) {
    guess_display(log, display, place);
  }
  convert_positions(log, chosen.unit, chosen.origin, chosen.unit == PositionUnit::fraction ? std::nullopt : display,
                    place);
  if (options.flip_x || options.flip_y) {
    for (GazeSample& sample : log.samples) {
      sample.u = options.flip_x ? 1.0 - sample.u : sample.u;
      sample.v = options.flip_y ? 1.0 - sample.v : sample.v;
    }
    add_flip_facts(log, options);
  }
  if (!space.validity_is_final && log.kind == GazeKind::screen) {
    mark_off_screen(log.samples);
  }
  note_mark(log, frequent);
}

Vec3d from_axes(const Vec3d& v, GazeAxes axes) {
  switch (axes) {
    case GazeAxes::automatic:
    case GazeAxes::gl:
      break;
    case GazeAxes::unity:
      return {v.x, v.y, -v.z};
    case GazeAxes::sranipal:
      return {-v.x, v.y, -v.z};
    case GazeAxes::cv:
      return {v.x, -v.y, -v.z};
  }
  return v;
}

std::string_view to_string(GazeAxes axes) {
  switch (axes) {
    case GazeAxes::automatic:
      return "auto";
    case GazeAxes::gl:
      return "gl";
    case GazeAxes::unity:
      return "unity";
    case GazeAxes::sranipal:
      return "sranipal";
    case GazeAxes::cv:
      return "cv";
  }
  return "auto";
}

void finish_directions(GazeLog& log, const GazeReadOptions& options, GazeAxes own, Evidence evidence,
                       const std::string& place) {
  log.kind = GazeKind::direction;
  const GazeAxes given = options.columns.axes;
  const GazeAxes axes = given == GazeAxes::automatic ? own : given;
  if (given != GazeAxes::automatic && own != GazeAxes::automatic && given != own) {
    log.warnings.push_back(
        fmt::format("{}: directions of this log are in {} axes; --gaze-axes {} was given and is used", place,
                    to_string(own), to_string(given)));
  }
  add_fact(log, "axes", std::string(to_string(axes == GazeAxes::automatic ? GazeAxes::gl : axes)),
           given == GazeAxes::automatic ? evidence : Evidence::option);
  turn_witnesses(log, options, false);
  const std::vector<FrequentPlace> frequent =
      options.for_inspection ? frequent_places(log.samples, GazeKind::direction) : std::vector<FrequentPlace>();
  std::size_t not_unit = 0;
  std::size_t backwards = 0;
  std::size_t usable = 0;
  for (GazeSample& sample : log.samples) {
    const Vec3d& written = sample.direction;
    const bool is_given = options.missing_value && written.x == *options.missing_value && written.y == written.x &&
                          written.z == written.x;
    const bool missing =
        is_given || is_missing_marker(written.x) || is_missing_marker(written.y) || is_missing_marker(written.z);
    Vec3d d = missing ? Vec3d{kNan, kNan, kNan} : from_axes(written, axes);
    if (options.swap_xy) {
      std::swap(d.x, d.y);
    }
    const double norm = length(d);
    if (!(norm > 0) || !std::isfinite(norm)) {
      sample.direction = {kNan, kNan, kNan};
      sample.validity = is_usable(sample.validity) ? GazeValidity::lost : sample.validity;
      continue;
    }
    // A unit vector that was written with all its digits stays as it is, bit by bit.
    if (std::abs(norm - 1.0) > 1e-14) {
      not_unit += std::abs(norm - 1.0) > 0.01 ? 1 : 0;
      d = d / norm;
    }
    sample.direction = d;
    usable += is_usable(sample.validity) ? 1 : 0;
    backwards += is_usable(sample.validity) && d.z > 0 ? 1 : 0;
  }
  flip_directions(log, options);
  note_mark_of_directions(log, frequent);
  for (EyeOrigins& origins : log.origins) {
    origins.left_mm = to_float(from_axes(to_double(origins.left_mm), axes));
    origins.right_mm = to_float(from_axes(to_double(origins.right_mm), axes));
  }
  if (not_unit > 0) {
    log.warnings.push_back(fmt::format("{}: {} of {} directions were not of unit length; normalized", log.source,
                                       not_unit, log.samples.size()));
  }
  if (backwards * 2 > usable) {
    log.warnings.push_back(
        fmt::format("{}: {} of {} directions point backwards (+z): forward is -z here, with +x right and +y up",
                    log.source, backwards, log.samples.size()));
  }
}

Quatd quaternion_from_unity_euler_deg(const Vec3d& rotation) {
  const auto about = [](double x, double y, double z, double angle_deg) {
    const double half = 0.5 * angle_deg * kRadPerDeg;
    return Quatd{x * std::sin(half), y * std::sin(half), z * std::sin(half), std::cos(half)};
  };
  return about(0, 1, 0, rotation.y) * about(1, 0, 0, rotation.x) * about(0, 0, 1, rotation.z);
}

HeadPose head_pose_from_axes(std::int64_t t_ns, const Vec3d& position_m, const Quatd& orientation, GazeAxes axes) {
  const Quatd& q = orientation;
  switch (axes) {
    case GazeAxes::automatic:
    case GazeAxes::gl:
      return {t_ns, position_m, q};
    case GazeAxes::unity:
      // World and head are both mirrored by diag(1, 1, -1): rotations about x and y turn the other way.
      return {t_ns, from_axes(position_m, axes), {-q.x, -q.y, q.z, q.w}};
    case GazeAxes::sranipal:
      // A turn by 180 degrees about y of world and head: rotations about x and z turn the other way.
      return {t_ns, from_axes(position_m, axes), {-q.x, q.y, -q.z, q.w}};
    case GazeAxes::cv:
      return {t_ns, from_axes(position_m, axes), {q.x, -q.y, -q.z, q.w}};
  }
  return {t_ns, position_m, q};
}

void finish_head(GazeLog& log) {
  std::stable_sort(log.head.begin(), log.head.end(),
                   [](const HeadPose& a, const HeadPose& b) { return a.t_ns < b.t_ns; });
  std::vector<HeadPose> kept;
  kept.reserve(log.head.size());
  for (const HeadPose& pose : log.head) {
    const Quatd& q = pose.orientation;
    const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!is_finite(pose.position_m) || !(norm > 1e-6) || !std::isfinite(norm)) {
      continue;
    }
    if (!kept.empty() && kept.back().t_ns == pose.t_ns) {
      kept.pop_back();
    }
    // Of unit length but for rounding: what was written by gazetrace keeps its bits.
    const bool is_unit = std::abs(norm - 1) <= 8 * std::numeric_limits<double>::epsilon();
    kept.push_back({pose.t_ns, pose.position_m, is_unit ? q : normalize(q)});
  }
  log.head = std::move(kept);
}

void refuse_scene_camera(const GazeFile& file, const GazeReadOptions& options, std::string_view way_out) {
  if (options.frame == GazeFrame::automatic && !options.for_inspection) {
    throw Error(ErrorKind::input, file.path,
                "holds gaze on the picture of a scene camera, which moves with the head: it is no place on a display",
                way_out);
  }
}

void LabelRuns::add(GazeEventType type, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row) {
  if (!open_ || key_ != key || events_.back().type != type) {
    events_.push_back({type, eye, t_ns, t_ns, std::string(), row});
    key_ = key;
    open_ = true;
  }
  events_.back().end_ns = t_ns;
}

void LabelRuns::end() {
  open_ = false;
}

void LabelRuns::finish(GazeLog& log) {
  log.events.insert(log.events.end(), events_.begin(), events_.end());
}

GazeSample missing_sample(std::int64_t t_ns, std::int64_t row, Eye eye, GazeKind kind) {
  GazeSample sample;
  sample.t_ns = t_ns;
  sample.row = row;
  sample.eye = eye;
  sample.validity = GazeValidity::lost;
  sample.confidence = sample.pupil = static_cast<float>(kNan);
  (kind == GazeKind::direction ? sample.direction.x : sample.u) = kNan;
  if (kind == GazeKind::direction) {
    sample.direction = {kNan, kNan, kNan};
  } else {
    sample.v = kNan;
  }
  return sample;
}

}  // namespace gazetrace
