// SPDX-License-Identifier: Apache-2.0
#include "gazelog/eyes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "core/nan.hpp"
#include "core/statistics.hpp"
#include "gazelog/screen_angles.hpp"
#include "gazelog/stamps.hpp"

namespace gazetrace {
namespace {

constexpr double kMaxVerticalDisparityDeg = 0.5;
constexpr double kOffsetTimeNs = 1e9;                 // time constant of the running offset
constexpr std::int64_t kShortAbsenceNs = 75'000'000;  // the gap that trackers bridge: Olsen 2012

// Places of the eyes as two angles, azimuth and elevation in radians; where the geometry is not known, the coordinates
// of the log itself.
class AnglePlane {
 public:
  explicit AnglePlane(const GazeLog& log) : is_direction_(log.kind == GazeKind::direction), screen_(log) {}

  [[nodiscard]] bool knows_angles() const { return is_direction_ || screen_.known(); }

  [[nodiscard]] Vec2d angles(const Vec3d& at) const {
    if (is_direction_) {
      return {std::atan2(at.x, -at.z), std::atan2(at.y, std::sqrt(at.x * at.x + at.z * at.z))};
    }
    return screen_.known() ? screen_.angles(at.x, at.y) : Vec2d{at.x, at.y};
  }

  void place(const Vec2d& angles, GazeSample& sample) const {
    if (is_direction_) {
      sample.direction = {std::sin(angles.x) * std::cos(angles.y), std::sin(angles.y),
                          -std::cos(angles.x) * std::cos(angles.y)};
      return;
    }
    const Vec2d at = screen_.known() ? screen_.place_at(angles) : angles;
    sample.u = at.x;
    sample.v = at.y;
  }

 private:
  bool is_direction_;
  ScreenAngles screen_;
};

Vec2d operator-(const Vec2d& a, const Vec2d& b) {
  return {a.x - b.x, a.y - b.y};
}

bool sees_both(const BothEyes& eyes) {
  return is_usable(eyes.left.validity) && is_usable(eyes.right.validity);
}

// Left minus right eye, smoothed over time. Before the first pair the value of the first pairs is used, which is
// possible because the whole log is known.
class RunningOffset {
 public:
  RunningOffset(const GazeLog& log, const AnglePlane& plane) {
    for (std::size_t i = 0; i < log.eyes.size() && count_ < 50; ++i) {
      const BothEyes& eyes = log.eyes[i];
      if (sees_both(eyes)) {
        add(plane.angles(eyes.left.at) - plane.angles(eyes.right.at), log.samples[i].t_ns);
      }
    }
    count_ = 0;
  }

  void add(const Vec2d& difference, std::int64_t t_ns) {
    ++count_;
    const double passed = count_ > 1 ? static_cast<double>(t_ns) - static_cast<double>(last_ns_) : 0;
    if (passed != passed_) {  // nearly always the same, one step of the tracker's clock
      passed_ = passed;
      forgotten_ = 1.0 - std::exp(-passed / kOffsetTimeNs);
    }
    const double weight = std::max(1.0 / static_cast<double>(count_), forgotten_);
    offset_ = {offset_.x + weight * (difference.x - offset_.x), offset_.y + weight * (difference.y - offset_.y)};
    last_ns_ = t_ns;
  }

  [[nodiscard]] const Vec2d& value() const { return offset_; }

 private:
  Vec2d offset_;
  std::size_t count_ = 0;
  std::int64_t last_ns_ = 0;
  double passed_ = 0, forgotten_ = 0;
};

// Left minus right eye while one eye is lost for a short time. It is interpolated linearly from the difference before
// to the one after, so that the gaze jumps at neither end.
class ShortAbsences {
 public:
  ShortAbsences(const GazeLog& log, const AnglePlane& plane) : log_(log), plane_(plane) {}

  // The difference at sample `i`, at which only one eye is seen. It must be asked in the order of time, and is empty in
  // long absences.
  [[nodiscard]] std::optional<Vec2d> difference(std::size_t i) {
    if (after_ <= i) {
      for (std::size_t k = after_; k < i; ++k) {
        if (sees_both(log_.eyes[k])) {
          before_ = k;
          has_before_ = true;
        }
      }
      after_ = i + 1;
      while (after_ < log_.eyes.size() && !sees_both(log_.eyes[after_])) {
        ++after_;
      }
    }
    if (!has_before_ || after_ == log_.eyes.size()) {
      return std::nullopt;
    }
    const std::int64_t begin_ns = log_.samples[before_].t_ns;
    const std::int64_t absence_ns = log_.samples[after_].t_ns - begin_ns;
    if (absence_ns > kShortAbsenceNs || absence_ns <= 0) {
      return std::nullopt;
    }
    const double s = static_cast<double>(log_.samples[i].t_ns - begin_ns) / static_cast<double>(absence_ns);
    const Vec2d a = difference_of(before_);
    const Vec2d b = difference_of(after_);
    return Vec2d{a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)};
  }

 private:
  [[nodiscard]] Vec2d difference_of(std::size_t i) const {
    return plane_.angles(log_.eyes[i].left.at) - plane_.angles(log_.eyes[i].right.at);
  }

  const GazeLog& log_;
  const AnglePlane& plane_;
  std::size_t before_ = 0;  // the last pair before after_
  bool has_before_ = false;
  std::size_t after_ = 0;  // the first pair after the sample that was asked for last
};

using TakenEye = Conventions::TakenEye;

TakenEye taken_of(Eye eye) {
  return eye == Eye::left ? TakenEye::left : TakenEye::right;
}

void note_taken(GazeLog& log, TakenEye eye, Evidence evidence, bool is_alone = false, std::string detail = {}) {
  log.conventions.eye_taken = {Conventions::Taken{eye, is_alone}, evidence, std::move(detail)};
}

// A time at which the log has no combined gaze of its own.
GazeSample missing_sample(std::int64_t t_ns, std::int64_t row, GazeKind kind) {
  GazeSample sample;
  sample.t_ns = t_ns;
  sample.row = row;
  sample.validity = GazeValidity::lost;
  sample.confidence = sample.pupil = std::numeric_limits<float>::quiet_NaN();
  if (kind == GazeKind::direction) {
    sample.direction = {kNan, kNan, kNan};
  } else {
    sample.u = sample.v = kNan;
  }
  return sample;
}

struct EyeQuality {
  std::size_t usable = 0;
  double step = 0;  // the median of the squared steps between neighbours
};

EyeQuality quality_of(const GazeLog& log, const AnglePlane& plane, EyeGaze BothEyes::*eye) {
  EyeQuality quality;
  std::vector<double> steps;
  const std::size_t stride = std::max<std::size_t>(1, log.eyes.size() / 50'000);
  for (std::size_t i = 0; i < log.eyes.size(); ++i) {
    const EyeGaze& gaze = log.eyes[i].*eye;
    if (!is_usable(gaze.validity)) {
      continue;
    }
    ++quality.usable;
    if (i % stride == 0 && i > 0 && is_usable((log.eyes[i - 1].*eye).validity)) {
      const Vec2d step = plane.angles(gaze.at) - plane.angles((log.eyes[i - 1].*eye).at);
      steps.push_back(step.x * step.x + step.y * step.y);
    }
  }
  quality.step = steps.empty() ? 0 : upper_median(steps);
  return quality;
}

Eye better_eye(const GazeLog& log, const AnglePlane& plane) {
  const EyeQuality left = quality_of(log, plane, &BothEyes::left);
  const EyeQuality right = quality_of(log, plane, &BothEyes::right);
  const auto more = static_cast<double>(std::max(left.usable, right.usable));
  const double difference = static_cast<double>(left.usable) - static_cast<double>(right.usable);
  if (std::abs(difference) > 0.01 * more) {
    return difference > 0 ? Eye::left : Eye::right;
  }
  return left.step <= right.step ? Eye::left : Eye::right;
}

// The median vertical difference, where it is great; empty where angles are not known or the eyes are never seen
// together.
std::optional<double> great_disparity_deg(const GazeLog& log, const AnglePlane& plane) {
  if (!plane.knows_angles()) {
    return std::nullopt;
  }
  std::vector<double> differences;
  const std::size_t stride = std::max<std::size_t>(1, log.eyes.size() / 100'000);
  for (std::size_t i = 0; i < log.eyes.size(); i += stride) {
    const BothEyes& eyes = log.eyes[i];
    if (sees_both(eyes)) {
      differences.push_back((plane.angles(eyes.left.at).y - plane.angles(eyes.right.at).y) * kDegPerRad);
    }
  }
  const double median = upper_median(differences);  // NaN of none
  return std::abs(median) > kMaxVerticalDisparityDeg ? std::optional(median) : std::nullopt;
}

float mean_or_known(float a, float b) {
  return std::isnan(a) ? b : std::isnan(b) ? a : 0.5F * (a + b);
}

void take_mean(GazeSample& sample, const BothEyes& eyes, const Vec2d& left, const Vec2d& right, GazeKind kind,
               const AnglePlane& plane) {
  take_eye(sample, eyes.left, kind);
  plane.place({0.5 * (left.x + right.x), 0.5 * (left.y + right.y)}, sample);
  if (kind != GazeKind::direction && eyes.left.validity != eyes.right.validity) {
    // Where one eye is beside the display and one on it, the mean decides.
    const bool on_display = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
    sample.validity = on_display ? GazeValidity::ok : GazeValidity::off_screen;
  }
  sample.confidence = mean_or_known(eyes.left.confidence, eyes.right.confidence);
  sample.pupil = mean_or_known(eyes.left.pupil, eyes.right.pupil);
}

struct JoinedTimes {
  std::size_t alone = 0, both = 0;  // at which one eye stood in, or both were seen
};

// `preferred` is cyclopean for the mean.
JoinedTimes join_eyes(GazeLog& log, const AnglePlane& plane, Eye preferred) {
  RunningOffset offset(log, plane);
  ShortAbsences short_absences(log, plane);
  JoinedTimes times;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    GazeSample& sample = log.samples[i];
    const BothEyes& eyes = log.eyes[i];
    const bool left = is_usable(eyes.left.validity);
    const bool right = is_usable(eyes.right.validity);
    sample.eye = preferred;
    if (left && right) {
      ++times.both;
      const Vec2d left_angles = plane.angles(eyes.left.at);
      const Vec2d right_angles = plane.angles(eyes.right.at);
      offset.add(left_angles - right_angles, sample.t_ns);
      if (preferred == Eye::cyclopean) {
        take_mean(sample, eyes, left_angles, right_angles, log.kind, plane);
      } else {
        take_eye(sample, preferred == Eye::left ? eyes.left : eyes.right, log.kind);
      }
      continue;
    }
    // With both eyes lost, the eye about which the log says more than that it is lost.
    const bool use_left =
        left || (!right && (eyes.left.validity != GazeValidity::lost || eyes.right.validity == GazeValidity::lost));
    const EyeGaze& used = use_left ? eyes.left : eyes.right;
    take_eye(sample, used, log.kind);
    if (!left && !right) {
      continue;
    }
    ++times.alone;
    const Eye seen = use_left ? Eye::left : Eye::right;
    const double share = seen == preferred ? 0 : preferred == Eye::cyclopean ? 0.5 : 1.0;
    const double sign = seen == Eye::left ? -1.0 : 1.0;  // left minus right is taken from the left eye
    const Vec2d apart = short_absences.difference(i).value_or(offset.value());
    if (share > 0 && (apart.x != 0 || apart.y != 0)) {
      const Vec2d at = plane.angles(used.at);
      plane.place({at.x + sign * share * apart.x, at.y + sign * share * apart.y}, sample);
    }
  }
  return times;
}

void warn_of_disparity(GazeLog& log, double disparity_deg, Eye taken) {
  log.warnings.push_back(
      fmt::format("{}: the eyes differ vertically by {:.2f} deg in the median, as after a poor calibration; the {} eye "
                  "is used, `gaze-eye` mean takes the mean",
                  log.source, disparity_deg, to_string(taken)));
}

void take_one_eye(GazeLog& log, Eye eye) {
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    log.samples[i].eye = eye;
    take_eye(log.samples[i], eye == Eye::left ? log.eyes[i].left : log.eyes[i].right, log.kind);
  }
}

// The eye that was chosen before the log was converted stays chosen.
void take_stated_eye(GazeLog& log, Eye eye, bool has_own_rows, const AnglePlane& plane) {
  if (has_own_rows) {  // the other eye stood in where it was lost, or they were processed
    for (GazeSample& sample : log.samples) {
      sample.eye = eye;
    }
  } else {
    take_one_eye(log, eye);
  }
  note_taken(log, taken_of(eye), Evidence::header, !has_own_rows);
  if (const auto disparity = great_disparity_deg(log, plane)) {
    warn_of_disparity(log, *disparity, eye);
  }
}

}  // namespace

Vec3d place_of(const GazeSample& sample, GazeKind kind) {
  return kind == GazeKind::direction ? sample.direction : Vec3d{sample.u, sample.v, 0};
}

EyeGaze eye_gaze(const GazeSample& sample, GazeKind kind) {
  return {place_of(sample, kind), sample.confidence, sample.pupil, sample.validity};
}

void take_eye(GazeSample& sample, const EyeGaze& eye, GazeKind kind) {
  if (kind == GazeKind::direction) {
    sample.direction = eye.at;
  } else {
    sample.u = eye.at.x;
    sample.v = eye.at.y;
  }
  sample.validity = eye.validity;
  sample.confidence = eye.confidence;
  sample.pupil = eye.pupil;
}

ChosenEye chosen_eye(const GazeLog& log) {
  if (log.eyes.empty() || log.samples.empty() || log.samples.front().eye == Eye::cyclopean) {
    return {};
  }
  ChosenEye chosen{log.samples.front().eye, true};
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    if (sample.eye != *chosen.eye) {
      return {};
    }
    const EyeGaze a = eye_gaze(sample, log.kind);
    const EyeGaze& b = *chosen.eye == Eye::left ? log.eyes[i].left : log.eyes[i].right;
    chosen.is_alone = chosen.is_alone && a.validity == b.validity && same_or_unknown(a.confidence, b.confidence) &&
                      same_or_unknown(a.pupil, b.pupil) && same_or_unknown(a.at.x, b.at.x) &&
                      same_or_unknown(a.at.y, b.at.y) &&
                      (log.kind != GazeKind::direction || same_or_unknown(a.at.z, b.at.z));
  }
  return chosen;
}

RowGrouper::RowGrouper(GazeLog& log, bool has_several, std::size_t times) : log_(log), has_several_(has_several) {
  log.samples.reserve(times);
  log.eyes.reserve(has_several ? times : 0);
}

void RowGrouper::add(const GazeSample& row) {
  if (first_ && row.t_ns != first_->t_ns) {
    close();
  }
  std::optional<GazeSample>& of_eye = of_eye_[static_cast<std::size_t>(row.eye)];
  if (of_eye) {
    GazeOrder& order = log_.order;
    if (order.duplicates++ == 0) {
      order.first_duplicate_row = row.row;
      order.first_duplicate_ns = row.t_ns;
      order.row_repeated = of_eye->row;
    }
    order.identical_duplicates += is_same_place(eye_gaze(*of_eye, log_.kind).at, eye_gaze(row, log_.kind).at) ? 1 : 0;
  }
  first_ = first_ && first_->eye != row.eye ? *first_ : row;
  of_eye = row;
}

void RowGrouper::close() {
  const std::optional<GazeSample>& own = of_eye_[static_cast<std::size_t>(Eye::cyclopean)];
  if (has_several_) {
    log_.samples.push_back(own ? *own : missing_sample(first_->t_ns, first_->row, log_.kind));
    const auto gaze = [&](Eye eye) {
      const auto& sample = of_eye_[static_cast<std::size_t>(eye)];
      return sample ? eye_gaze(*sample, log_.kind) : EyeGaze{};
    };
    log_.eyes.push_back({gaze(Eye::left), gaze(Eye::right)});
  } else {
    log_.samples.push_back(*first_);
  }
  of_eye_ = {};
  first_.reset();
}

void RowGrouper::finish(UnorderedPolicy policy) {
  close();
  refuse_duplicates(policy, log_);
}

void check_eye_choice(const GazeLog& log, const RowsOfEyes& rows) {
  const EyeChoice choice = log.conventions.eye;
  if ((choice == EyeChoice::left && rows.left() == 0) || (choice == EyeChoice::right && rows.right() == 0)) {
    throw Error(ErrorKind::usage, log.source,
                fmt::format("has no rows of the {} eye", choice == EyeChoice::left ? "left" : "right"),
                "leave `gaze-eye` out, or choose another");
  }
}

void choose_eyes(GazeLog& log, const RowsOfEyes& rows) {
  if (rows.kinds() < 2) {  // one eye, or one that stands for both
    note_taken(log,
               rows.own() > 0    ? TakenEye::combined
               : rows.left() > 0 ? TakenEye::left
                                 : TakenEye::right,
               Evidence::format);
    return;
  }
  const EyeChoice choice = log.conventions.eye;
  const AnglePlane plane(log);
  const Evidence evidence = choice == EyeChoice::automatic ? Evidence::format : Evidence::option;
  if (choice == EyeChoice::left || choice == EyeChoice::right) {
    const Eye eye = choice == EyeChoice::left ? Eye::left : Eye::right;
    take_one_eye(log, eye);
    note_taken(log, taken_of(eye), evidence, true);
    return;
  }
  if (const auto& stated = log.stated_eye;
      choice == EyeChoice::automatic && stated && (rows.own() > 0 || (rows.left() > 0 && rows.right() > 0))) {
    take_stated_eye(log, *stated, rows.own() > 0, plane);
    return;
  }
  if (choice == EyeChoice::automatic && rows.own() > 0) {
    note_taken(log, TakenEye::combined, Evidence::format, false, "by the tracker");
    return;
  }
  Eye preferred = Eye::cyclopean;
  if (choice == EyeChoice::automatic) {
    if (const auto disparity = great_disparity_deg(log, plane)) {
      preferred = better_eye(log, plane);
      warn_of_disparity(log, *disparity, preferred);
    }
  }
  const JoinedTimes joined = join_eyes(log, plane, preferred);
  const bool take_turns = joined.both == 0 && joined.alone > 0;
  note_taken(log, preferred == Eye::cyclopean ? TakenEye::mean : taken_of(preferred), evidence, false,
             take_turns             ? "of the one that was recorded: the eyes take turns and are never seen at once"
             : plane.knows_angles() ? "in angle"
                                    : "of the places, since no angles are known");
  if (take_turns) {
    log.warnings.push_back(fmt::format(
        "{}: the recorded eye changes: the eyes are never seen at once, and the gaze is that of the one that is there; "
        "`gaze-eye` left or right takes one",
        log.source));
  } else if (preferred == Eye::cyclopean) {
    log.warnings.push_back(
        fmt::format("{}: rows of several eyes merged to their mean: {} times, {} of them with one usable eye only",
                    log.source, log.samples.size(), joined.alone));
  }
}

}  // namespace gazetrace
