// SPDX-License-Identifier: Apache-2.0
#include "gazelog/interpret.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "gazelog/conventions_text.hpp"
#include "gazelog/eyes.hpp"
#include "gazelog/row_order.hpp"
#include "gazelog/scene_lens.hpp"

namespace gazetrace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInt16Min = -32768;
constexpr double kLarge = 1e7;
__extension__ using Int128 = __int128;

// Size of the display in the unit of the positions.
Vec2d display_size(PositionUnit unit, const DisplayGeometry& d, const std::string& place) {
  const auto missing = [&](std::string_view what, std::string_view remedy) {
    throw Error(
        ErrorKind::input, place,
        fmt::format("positions are in {}, and {} of the display of the recording is not known", to_string(unit), what),
        remedy);
  };
  if (unit == PositionUnit::px) {
    if (d.width_px <= 0 || d.height_px <= 0) {
      missing("the size in pixels", "give `screen-px` W,H, or write `# display_px W H` above the header");
    }
    return {static_cast<double>(d.width_px), static_cast<double>(d.height_px)};
  }
  if (!(d.width_cm > 0) || !(d.height_cm > 0)) {
    missing("the size in cm", "give `screen-cm` W,H, or write `# display_mm W H` above the header");
  }
  if (unit == PositionUnit::deg && !(d.distance_cm > 0)) {
    missing("the eye's distance", "give `screen-distance-cm`, or write `# distance_mm D` above the header");
  }
  const double per_cm = unit == PositionUnit::mm ? 10.0 : 1.0;
  return {d.width_cm * per_cm, d.height_cm * per_cm};
}

void lose(GazeValidity& validity) {
  validity = is_usable(validity) ? GazeValidity::lost : validity;
}

// Whether the numbers of a row stand for a place that the tracker did not know.
bool is_mark(const Vec3d& at, const Conventions& c) {
  const bool has_three = c.form == PlaceForm::vector;
  // A place on a display is unknown where one of its coordinates is. Zero alone is the display's edge, and a component
  // of a direction may be any number.
  const bool one_is_enough = !has_three && c.missing_value && *c.missing_value != 0;
  const bool is_given =
      c.missing_value && (one_is_enough ? at.x == *c.missing_value || at.y == *c.missing_value
                                        : at.x == *c.missing_value && at.y == at.x && (!has_three || at.z == at.x));
  return is_given || is_missing_marker(at.x) || is_missing_marker(at.y) || (has_three && is_missing_marker(at.z));
}

// x and y of a row of positions, in `c.unit`; NaN where they are a mark.
Vec2d position_of(const RawSample& row, const Vec2d& corner, const Conventions& c, bool& is_missing) {
  Vec2d at{row.at.x - corner.x, row.at.y - corner.y};
  // As the file has it, or counted from the corner of the display.
  const bool is_zero = (row.at.x == 0 && row.at.y == 0) || (at.x == 0 && at.y == 0);
  is_missing = is_mark(row.at, c) || (c.zero_is_missing && is_zero);
  if (is_missing) {
    return {kNan, kNan};
  }
  if (c.swap_xy) {
    std::swap(at.x, at.y);
  }
  return c.unit_scale == 1 ? at : Vec2d{at.x * c.unit_scale, at.y * c.unit_scale};
}

// From positions in a unit to fractions of the display.
class ToFractions {
 public:
  ToFractions(const Conventions& c, const std::string& place) : unit_(c.unit.value), origin_(c.origin.value) {
    const DisplayGeometry display = c.display ? c.display->value : DisplayGeometry{};
    if (unit_ == PositionUnit::deg && origin_ != PositionOrigin::center) {
      throw Error(ErrorKind::usage, place,
                  fmt::format("positions in degrees cannot count from the {}", to_string(origin_)),
                  "degrees count from straight ahead: `gaze-origin` center");
    }
    // Centred fractions count half the display: -1..1.
    size_ = unit_ != PositionUnit::fraction     ? display_size(unit_, display, place)
            : origin_ == PositionOrigin::center ? Vec2d{2, 2}
                                                : Vec2d{1, 1};
    display_ = display;
  }

  [[nodiscard]] Vec2d operator()(const Vec2d& at) const {
    if (unit_ == PositionUnit::deg) {
      // Azimuth and elevation taken as independent: x = d tan(azimuth), y = d tan(elevation).
      const double right = std::tan(at.x * kRadPerDeg) * display_.distance_cm + display_.eye_x_cm;
      const double up = std::tan(at.y * kRadPerDeg) * display_.distance_cm + display_.eye_y_cm;
      return {0.5 + right / size_.x, 0.5 - up / size_.y};
    }
    const double u = at.x / size_.x;
    const double v = at.y / size_.y;
    switch (origin_) {
      case PositionOrigin::bottom_left:
        return {u, 1.0 - v};
      case PositionOrigin::center:
        return {0.5 + u, 0.5 - v};
      default:
        return {u, v};
    }
  }

 private:
  PositionUnit unit_;
  PositionOrigin origin_;
  Vec2d size_;
  DisplayGeometry display_;
};

GazeSample sample_of(const RawSample& row) {
  GazeSample sample;
  sample.t_ns = row.t_ns;
  sample.validity = row.validity;
  sample.eye = row.eye;
  sample.confidence = row.confidence;
  sample.pupil = row.pupil;
  sample.row = row.row;
  return sample;
}

// Samples of the rows of a log of positions, one by one.
class PositionRows {
 public:
  PositionRows(const RawGaze& raw, const Conventions& c)
      : raw_(raw),
        c_(c),
        to_fractions_(c, raw.place),
        marks_off_screen_(!c.off_screen_is_told && raw.kind == GazeKind::screen) {}

  [[nodiscard]] GazeSample sample(std::size_t row) const {
    GazeSample sample = sample_of(raw_.rows[row]);
    bool is_missing = false;
    const Vec2d at = to_fractions_(position_of(raw_.rows[row], corner_of(raw_, c_, row), c_, is_missing));
    if (is_missing) {
      lose(sample.validity);
    }
    sample.u = c_.flip_x ? 1.0 - at.x : at.x;
    sample.v = c_.flip_y ? 1.0 - at.y : at.y;
    const bool inside = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
    if (marks_off_screen_ && sample.validity == GazeValidity::ok && !inside) {
      sample.validity = GazeValidity::off_screen;
    }
    return sample;
  }

 private:
  const RawGaze& raw_;
  const Conventions& c_;
  ToFractions to_fractions_;
  bool marks_off_screen_;
};

void interpret_positions(const RawGaze& raw, const Conventions& c, GazeLog& log) {
  const PositionRows rows(raw, c);
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    log.samples.push_back(rows.sample(i));
  }
}

bool are_positions(const Conventions& c) {
  return c.form == PlaceForm::position && !(c.degrees_are_directions && c.unit.value == PositionUnit::deg);
}

// The rows of each eye, where they stand in order, several eyes to a time and none of them twice; empty where they do
// not.
std::optional<RowsOfEyes> rows_in_groups(const RawGaze& raw) {
  RowsOfEyes rows;
  unsigned seen = 0;  // the eyes at the time of the row
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    const RawSample& row = raw.rows[i];
    const auto eye = static_cast<std::size_t>(row.eye);
    const bool goes_on = i > 0 && row.t_ns == raw.rows[i - 1].t_ns;
    if ((i > 0 && row.t_ns < raw.rows[i - 1].t_ns) || (goes_on && ((seen >> eye) & 1U) != 0)) {
      return std::nullopt;
    }
    seen = (goes_on ? seen : 0U) | (1U << eye);
    ++rows.of_eye[eye];
  }
  return rows.kinds() > 1 ? std::optional(rows) : std::nullopt;
}

// As interpret_rows, order_samples, drop_duplicates and choose_eyes do in turn, without ever holding a sample for each
// row.
void interpret_in_groups(const RawGaze& raw, const Conventions& c, const RowsOfEyes& rows_of_eyes, GazeLog& log) {
  std::size_t times = 0;
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    times += i == 0 || raw.rows[i].t_ns != raw.rows[i - 1].t_ns ? 1 : 0;
  }
  check_eye_choice(log, rows_of_eyes);
  log.samples.reserve(times);
  log.eyes.reserve(times);
  const PositionRows rows(raw, c);
  RowGrouper grouper(log);
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    grouper.add(rows.sample(i));
  }
  grouper.finish();
  log.order.rows = raw.rows.size();
  choose_grouped_eyes(log, rows_of_eyes);
}

// Degrees from straight ahead, azimuth and elevation taken as independent, as on a flat display: (tan az, tan el, -1).
void interpret_degrees(const RawGaze& raw, const Conventions& c, GazeLog& log) {
  log.kind = GazeKind::direction;
  const double up = c.origin.value == PositionOrigin::top_left && !raw.directions_grow_up ? -1.0 : 1.0;
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    GazeSample sample = sample_of(raw.rows[i]);
    bool is_missing = false;
    const Vec2d at = position_of(raw.rows[i], corner_of(raw, c, i), c, is_missing);
    const bool known = std::abs(at.x) < 90 && std::abs(at.y) < 90;
    sample.direction = known ? normalize(Vec3d{std::tan(at.x * kRadPerDeg), up * std::tan(at.y * kRadPerDeg), -1})
                             : Vec3d{kNan, kNan, kNan};
    if (!known) {
      lose(sample.validity);
    }
    sample.direction.x *= c.flip_x ? -1 : 1;
    sample.direction.y *= c.flip_y ? -1 : 1;
    log.samples.push_back(sample);
  }
}

// The direction that a row holds, in the axes of the file; need not be of unit length.
Vec3d vector_of(const RawSample& row, const Conventions& c) {
  if (is_mark(row.at, c)) {
    return {kNan, kNan, kNan};
  }
  switch (c.form) {
    case PlaceForm::azimuth_elevation: {
      const double az = row.at.x * kRadPerDeg;
      const double el = row.at.y * kRadPerDeg;
      return {std::sin(az) * std::cos(el), std::sin(el), -std::cos(az) * std::cos(el)};
    }
    case PlaceForm::lens_pixel:
      return is_usable(row.validity) && c.lens ? ray_of(*c.lens, {row.at.x, row.at.y}) : Vec3d{kNan, kNan, kNan};
    default:
      return row.at;
  }
}

Vec3f turned(const Vec3f& v, GazeAxes axes, bool mirror_x) {
  Vec3f out = to_float(from_axes(to_double(v), axes));
  out.x = mirror_x ? -out.x : out.x;
  return out;
}

void interpret_vectors(const RawGaze& raw, const Conventions& c, GazeLog& log) {
  log.kind = GazeKind::direction;
  const GazeAxes axes = c.axes.value;
  const bool mirror_x = c.x_is_turned && c.x_is_turned->value;
  const double x_sign = c.flip_x != mirror_x ? -1 : 1;
  const double y_sign = c.flip_y ? -1 : 1;
  std::size_t not_unit = 0;
  std::size_t backwards = 0;
  std::size_t usable = 0;
  for (const RawSample& row : raw.rows) {
    GazeSample sample = sample_of(row);
    Vec3d d = from_axes(vector_of(row, c), axes);
    if (c.swap_xy) {
      std::swap(d.x, d.y);
    }
    const double norm = length(d);
    if (!(norm > 0) || !std::isfinite(norm)) {
      sample.direction = {kNan, kNan, kNan};
      lose(sample.validity);
      log.samples.push_back(sample);
      continue;
    }
    // A unit vector that was written with all its digits stays as it is, bit by bit.
    if (std::abs(norm - 1.0) > 1e-14) {
      not_unit += std::abs(norm - 1.0) > 0.01 ? 1 : 0;
      d = d / norm;
    }
    usable += is_usable(sample.validity) ? 1 : 0;
    backwards += is_usable(sample.validity) && d.z > 0 ? 1 : 0;
    sample.direction = {d.x * x_sign, d.y * y_sign, d.z};
    log.samples.push_back(sample);
  }
  for (EyeOrigins& origins : log.origins) {
    origins.left_mm = turned(origins.left_mm, axes, mirror_x);
    origins.right_mm = turned(origins.right_mm, axes, mirror_x);
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

bool grows_up(const Conventions& c) {
  return c.form == PlaceForm::position &&
         (c.unit.value == PositionUnit::deg || c.origin.value == PositionOrigin::bottom_left ||
          c.origin.value == PositionOrigin::center);
}

// The witnesses follow what is done to the gaze beside them.
void turn_witnesses(GazeLog& log, const Conventions& c, bool other_way_up) {
  for (GazeWitness& w : log.witnesses) {
    if (c.swap_xy) {
      std::swap(w.xx, w.yx);
      std::swap(w.yy, w.xy);
    }
    const double x_sign = c.flip_x ? -1 : 1;
    const double y_sign = c.flip_y != other_way_up ? -1 : 1;
    w.xx *= x_sign;
    w.xy *= x_sign;
    w.yy *= y_sign;
    w.yx *= y_sign;
  }
}

// t times ten to the power of `exponent`, halves rounded away from zero; what int64 cannot hold becomes its end.
std::int64_t times_power_of_ten(std::int64_t t, int exponent) {
  constexpr int kMostDigits = 19;  // of an int64: by a higher power nothing fits, and nothing but zero is left
  if (exponent < -kMostDigits) {
    return 0;
  }
  Int128 power = 1;
  for (int i = 0; i < std::min(std::abs(exponent), kMostDigits); ++i) {
    power *= 10;
  }
  const Int128 value = t;
  const Int128 result = exponent >= 0 ? value * power : (value + (value < 0 ? -power / 2 : power / 2)) / power;
  return static_cast<std::int64_t>(
      std::clamp<Int128>(result, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()));
}

// Stamps were read under the declared unit; under another one they are counted anew.
void recount_times(GazeLog& log, int declared_exponent, int exponent) {
  if (declared_exponent == exponent) {
    return;
  }
  const auto recount = [&](std::int64_t& t_ns) { t_ns = times_power_of_ten(t_ns, exponent - declared_exponent); };
  for (GazeSample& sample : log.samples) {
    recount(sample.t_ns);
  }
  for (EyeOrigins& origins : log.origins) {
    recount(origins.t_ns);
  }
  for (HeadPose& pose : log.head) {
    recount(pose.t_ns);
  }
  for (GazeEvent& event : log.events) {
    recount(event.begin_ns);
    recount(event.end_ns);
  }
  for (GazeCalibration& calibration : log.calibrations) {
    recount(calibration.t_ns);
  }
  for (GazeRecording& recording : log.recordings) {
    recount(recording.first_ns);
    recount(recording.last_ns);
  }
}

// Differences of stamps are taken everywhere, and must fit into an int64; half of that leaves room for their sums.
void check_span(const GazeLog& log) {
  const auto [first, last] = std::minmax_element(
      log.samples.begin(), log.samples.end(), [](const GazeSample& a, const GazeSample& b) { return a.t_ns < b.t_ns; });
  constexpr std::int64_t kLongest = std::numeric_limits<std::int64_t>::max() / 2;
  std::int64_t span_ns = 0;
  if (__builtin_sub_overflow(last->t_ns, first->t_ns, &span_ns) || span_ns > kLongest) {
    throw Error(
        ErrorKind::input, fmt::format("{}:{}", log.source, std::max(first->row, last->row)),
        fmt::format("the stamps reach from {} to {} ns, over more than a hundred years", first->t_ns, last->t_ns),
        "check the unit of the time column (`gaze-time-unit`), or remove the rows with a damaged time");
  }
}

}  // namespace

bool is_missing_marker(double coordinate) {
  return coordinate == kInt16Min || std::abs(coordinate) >= kLarge;
}

Vec2d corner_of(const RawGaze& raw, const Conventions& conventions, std::size_t row) {
  const auto behind = std::upper_bound(raw.corners.begin(), raw.corners.end(), row,
                                       [](std::size_t r, const CornerFromRow& c) { return r < c.first_row; });
  return behind == raw.corners.begin() ? conventions.corner : (behind - 1)->corner;
}

std::vector<RawSample> measurable_rows(const RawGaze& raw, const Conventions& conventions) {
  // Of a long log some of the rows tell as much, and a copy of all of them would be as large as the log.
  constexpr std::size_t kAllUpTo = 2'000'000;
  std::size_t stride = raw.rows.size() / kAllUpTo + 1;
  while (stride > 1 && (stride % 2 == 0 || stride % 3 == 0)) {
    ++stride;  // or it would meet the same eye of two or three each time
  }
  std::vector<RawSample> rows;
  rows.reserve(raw.rows.size() / stride + 1);
  for (std::size_t i = 0; i < raw.rows.size(); i += stride) {
    RawSample row = raw.rows[i];
    bool is_missing = false;
    const Vec2d at = position_of(row, corner_of(raw, conventions, i), conventions, is_missing);
    row.at = {at.x, at.y, 0};
    if (is_missing) {
      lose(row.validity);
    }
    rows.push_back(row);
  }
  return rows;
}

namespace {

GazeLog log_without_samples(const RawGaze& raw, const Conventions& conventions) {
  if (conventions.form == PlaceForm::position && conventions.unit.value == PositionUnit::automatic) {
    throw Error(ErrorKind::usage, raw.place, "the unit of the positions is not settled",
                "conclude the conventions of the log before it is interpreted, or state their unit");
  }
  GazeLog log;
  log.kind = raw.kind;
  log.source = raw.source;
  log.format = raw.format;
  log.format_confidence = raw.format_confidence;
  log.clock = raw.clock;
  log.pupil_unit = raw.pupil_unit;
  log.recording_geometry = conventions.recording_geometry;
  log.pixels_per_degree = raw.pixels_per_degree;
  log.nominal_rate_hz = raw.nominal_rate_hz;
  log.sample_age_unknown = raw.sample_age_unknown;
  log.stated_eye = raw.stated_eye;
  log.device = raw.device;
  log.origins = raw.origins;
  log.head = raw.head;
  log.events = raw.events;
  log.calibrations = raw.calibrations;
  log.witnesses = raw.witnesses;
  log.recordings = raw.recordings;
  log.recording = raw.recording;
  log.warnings = raw.warnings;
  log.warnings.insert(log.warnings.end(), raw.damages.begin(), raw.damages.end());
  log.warnings.insert(log.warnings.end(), conventions.warnings.begin(), conventions.warnings.end());
  log.conventions = conventions;
  turn_witnesses(log, conventions, grows_up(conventions) != grows_up(raw.declared));
  return log;
}

}  // namespace

GazeLog interpret_rows(const RawGaze& raw, const Conventions& conventions) {
  GazeLog log = log_without_samples(raw, conventions);
  log.samples.reserve(raw.rows.size());
  if (conventions.form != PlaceForm::position) {
    interpret_vectors(raw, conventions, log);
  } else if (conventions.degrees_are_directions && conventions.unit.value == PositionUnit::deg) {
    interpret_degrees(raw, conventions, log);
  } else {
    interpret_positions(raw, conventions, log);
  }
  recount_times(log, raw.declared.time_exponent.value, conventions.time_exponent.value);
  finish_head(log);
  return log;
}

GazeLog interpret(const RawGaze& raw, const Conventions& conventions) {
  const bool keeps_stamps = raw.declared.time_exponent.value == conventions.time_exponent.value;
  const auto groups = keeps_stamps && are_positions(conventions) ? rows_in_groups(raw) : std::nullopt;
  GazeLog log;
  if (groups) {
    log = log_without_samples(raw, conventions);
    interpret_in_groups(raw, conventions, *groups, log);
    finish_head(log);
    check_span(log);
  } else {
    log = interpret_rows(raw, conventions);
    if (log.samples.empty()) {
      throw Error(ErrorKind::input, log.source, "holds no sample",
                  "a gaze log needs at least one row below its header");
    }
    check_span(log);
    order_samples(log, conventions.unordered);
    drop_duplicates(log, conventions.unordered);
    choose_eyes(log);
  }
  align_origins(log);
  const auto usable = [](const GazeSample& sample) { return is_usable(sample.validity); };
  if (std::none_of(log.samples.begin(), log.samples.end(), usable)) {
    log.warnings.push_back(fmt::format("{}: none of its {} samples is usable", log.source, log.samples.size()));
  }
  log.facts = facts_in_words(raw, log.conventions);
  return log;
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

void finish_head(GazeLog& log) {
  if (log.head.empty()) {
    return;
  }
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

}  // namespace gazetrace
