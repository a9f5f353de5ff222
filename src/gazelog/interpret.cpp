// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "gazelog/conventions_text.hpp"
#include "gazelog/eyes.hpp"
#include "gazelog/row_samples.hpp"
#include "gazelog/stamps.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {
namespace {

__extension__ using Int128 = __int128;

// The rows of each eye, where they stand in order, several eyes to a time and none of them twice; empty where they do
// not.
std::optional<RowsOfEyes> rows_in_groups(const RawGaze& raw) {
  RowsOfEyes rows;
  unsigned seen = 0;  // the eyes at the time of the row
  std::int64_t before_ns = 0;
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    const std::int64_t t_ns = raw.rows.t_ns(i);
    const auto eye = static_cast<std::size_t>(raw.rows.eye(i));
    const bool goes_on = i > 0 && t_ns == before_ns;
    if ((i > 0 && t_ns < before_ns) || (goes_on && ((seen >> eye) & 1U) != 0)) {
      return std::nullopt;
    }
    before_ns = t_ns;
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
    times += i == 0 || raw.rows.t_ns(i) != raw.rows.t_ns(i - 1) ? 1 : 0;
  }
  check_eye_choice(log, rows_of_eyes);
  log.samples.reserve(times);
  log.eyes.reserve(times);
  const RowSamples rows(raw, c);
  RowGrouper grouper(log);
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    grouper.add(rows(i));
  }
  grouper.finish();
  log.order.rows = raw.rows.size();
  choose_grouped_eyes(log, rows_of_eyes);
}

Vec3f turned(const Vec3f& v, GazeAxes axes, bool mirror_x) {
  Vec3f out = to_float(from_axes(to_double(v), axes));
  out.x = mirror_x ? -out.x : out.x;
  return out;
}

// Turns what belongs to directions together with them, and says what is odd about them.
void finish_directions(const RawGaze& raw, const Conventions& c, GazeLog& log) {
  const bool mirror_x = c.x_is_turned && c.x_is_turned->value;
  for (EyeOrigins& origins : log.origins) {
    origins.left_mm = turned(origins.left_mm, c.axes.value, mirror_x);
    origins.right_mm = turned(origins.right_mm, c.axes.value, mirror_x);
  }
  std::size_t not_unit = 0;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    not_unit += !std::isnan(sample.direction.z) && std::abs(length(vector_of(raw.rows[i], c)) - 1.0) > 0.01 ? 1 : 0;
  }
  if (not_unit > 0 && !raw.are_points) {
    log.warnings.push_back(fmt::format("{}: {} of {} directions were not of unit length; normalized", log.source,
                                       not_unit, log.samples.size()));
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
        "check the unit of the time column (`time-unit`), or remove the rows with a damaged time");
  }
}

}  // namespace

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

// Keeps the poses whose times increase, and makes them of unit length.
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

// Makes one sample of each row, in the order of the file, and adds what holds for all of them: kind, geometry, origins,
// witnesses, warnings. Rows are neither sorted nor joined. The only thing that is rejected is a unit that needs a
// display which is not known.
GazeLog interpret_rows(const RawGaze& raw, const Conventions& conventions) {
  GazeLog log = log_without_samples(raw, conventions);
  log.samples.reserve(raw.rows.size());
  const RowSamples rows(raw, conventions);
  log.kind = rows.kind();
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    log.samples.push_back(rows(i));
  }
  if (conventions.form != PlaceForm::position) {
    finish_directions(raw, conventions, log);
  }
  recount_times(log, raw.declared.time_exponent.value, conventions.time_exponent.value);
  finish_head(log);
  return log;
}

}  // namespace

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

}  // namespace gazetrace
