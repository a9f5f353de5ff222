// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gazelog/eyes.hpp"
#include "gazelog/row_samples.hpp"
#include "gazelog/stamps.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {
namespace {

Vec3f turned(const Vec3f& v, GazeAxes axes, bool mirror_x) {
  Vec3f out = to_float(from_axes(to_double(v), axes));
  out.x = mirror_x ? -out.x : out.x;
  return out;
}

// Turns what belongs to directions together with them.
void finish_directions(const RawGaze& raw, const Conventions& c, std::size_t not_unit, GazeLog& log) {
  const bool mirror_x = c.x_is_turned && c.x_is_turned->value;
  for (EyeOrigins& origins : log.origins) {
    origins.left_mm = turned(origins.left_mm, c.axes.value, mirror_x);
    origins.right_mm = turned(origins.right_mm, c.axes.value, mirror_x);
  }
  if (not_unit > 0 && !raw.are_points) {
    log.warnings.push_back(fmt::format("{}: {} of {} directions were not of unit length; normalized", log.source,
                                       not_unit, raw.rows.size()));
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

GazeLog log_without_samples(const RawGaze& raw, const Conventions& conventions) {
  if (conventions.form == PlaceForm::position && conventions.unit.value == PositionUnit::automatic) {
    throw Error(ErrorKind::usage, raw.place, "the unit of the positions is not settled",
                "conclude the conventions of the log before it is interpreted, or state their unit");
  }
  GazeLog log;
  static_cast<GazeRecord&>(log) = raw;
  log.recording_geometry = conventions.recording_geometry;
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

}  // namespace

GazeLog interpret(const RawGaze& raw, const Conventions& conventions) {
  GazeLog log = log_without_samples(raw, conventions);
  if (raw.rows.size() == 0) {
    throw Error(ErrorKind::input, log.source, "holds no sample", "a gaze log needs at least one row below its header");
  }
  RowsOfEyes eyes;
  std::size_t times = 1;
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    ++eyes.of_eye[static_cast<std::size_t>(raw.rows.eye(i))];
    times += i > 0 && raw.rows.t_ns(i) != raw.rows.t_ns(i - 1) ? 1 : 0;
  }
  check_eye_choice(log, eyes);
  const RowSamples sample_of(raw, conventions);
  log.kind = sample_of.kind();
  const std::vector<std::size_t> by_time = rows_by_time(raw.rows, conventions.unordered, log);
  RowGrouper grouper(log, eyes.kinds() > 1, times);
  std::size_t not_unit = 0;
  for (std::size_t k = 0; k < raw.rows.size(); ++k) {
    const std::size_t i = by_time.empty() ? k : by_time[k];
    const GazeSample sample = sample_of(i);
    const bool is_vector = conventions.form != PlaceForm::position && !std::isnan(sample.direction.z);
    not_unit += is_vector && std::abs(length(vector_of(raw.rows[i], conventions)) - 1.0) > 0.01 ? 1 : 0;
    grouper.add(sample);
  }
  grouper.finish(conventions.unordered);
  if (conventions.form != PlaceForm::position) {
    finish_directions(raw, conventions, not_unit, log);
  }
  finish_head(log);
  check_span(log);
  choose_eyes(log, eyes);
  align_origins(log);
  const auto usable = [](const GazeSample& sample) { return is_usable(sample.validity); };
  if (std::none_of(log.samples.begin(), log.samples.end(), usable)) {
    log.warnings.push_back(fmt::format("{}: none of its {} samples is usable", log.source, log.samples.size()));
  }
  log.facts = facts_in_words(raw, log.conventions);
  return log;
}

}  // namespace gazetrace
