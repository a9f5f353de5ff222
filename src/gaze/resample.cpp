// SPDX-License-Identifier: Apache-2.0
// Chooses the rows of a log from which the gaze at a time is taken.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/enum_name.hpp"
#include "gaze/angles.hpp"
#include "gazetrace/gaze.hpp"

namespace gazetrace {
namespace {

__extension__ using Int128 = __int128;

[[noreturn]] void beyond_int64() {
  throw Error(ErrorKind::usage, "", "a time of the gaze log would lie beyond int64 nanoseconds",
              "check `gaze-start`, `gaze-offset` and `gaze-scale`");
}

std::int64_t narrowed(Int128 t_ns) {
  if (t_ns != static_cast<std::int64_t>(t_ns)) {
    beyond_int64();
  }
  return static_cast<std::int64_t>(t_ns);
}

Int128 floor_divide(Int128 a, Int128 b) {  // b > 0
  const Int128 quotient = a / b;
  return quotient * b > a ? quotient - 1 : quotient;
}

// a / scale to the nearest integer, halves up. A double is an integer times a power of two, so this is a quotient of
// integers. Only scales far from those of any clock (below 2^-8 or above 2^52) exceed 128 bits.
Int128 divide_by_scale(Int128 a, double scale) {
  if (scale == 1.0) {
    return a;
  }
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(scale, &exponent), 53));
  const int shift = 53 - exponent;  // scale = mantissa / 2^shift
  if (shift < 0 || shift > 61) {
    const long double quotient = static_cast<long double>(a) / static_cast<long double>(scale);
    if (!(std::abs(quotient) < 9.2e18L)) {
      beyond_int64();
    }
    return static_cast<Int128>(std::floor(quotient + 0.5L));
  }
  // |a| < 2^65 and shift <= 61: twice the shifted numerator fits in 127 bits.
  return floor_divide(2 * (a * (Int128{1} << shift)) + mantissa, Int128{2} * mantissa);
}

std::string milliseconds(std::int64_t t_ns) {
  const double ms = static_cast<double>(t_ns) * 1e-6;
  return std::abs(ms) < 100 ? fmt::format("{:.1f} ms", ms) : fmt::format("{:.0f} ms", ms);
}

class Resampler {
 public:
  Resampler(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_ns,
            const std::vector<EyeMovement>* movements)
      : samples_(log.samples), log_(log), mapping_(mapping), t_ns_(t_ns), movements_(movements) {
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), t_ns,
                                        [](std::int64_t t, const GazeSample& sample) { return t < sample.t_ns; });
    after_ = static_cast<std::size_t>(after - samples_.begin());
    result_.kind = log.kind;
    result_.t_log_ns = t_ns;
    result_.age_is_known = !log.sample_age_unknown;
    if (movements != nullptr && after_ > 0 && after_ <= movements->size()) {
      const bool unseen = is_unseen(samples_, after_ - 1, t_ns, mapping.max_interpolation_gap_ns);
      result_.movement = unseen ? EyeMovement::lost : (*movements)[after_ - 1];
      result_.since_saccade_ns = since_saccade_ns();
    }
  }

  GazeAtTime run() {
    if (mapping_.interpolation == GazeInterpolation::linear && linear()) {
      return result_;
    }
    if (mapping_.interpolation == GazeInterpolation::nearest && nearest()) {
      return result_;
    }
    if (!hold()) {
      no_gaze();
    }
    return result_;
  }

 private:
  [[nodiscard]] std::optional<std::int64_t> since_saccade_ns() const {
    for (std::size_t row = after_; row-- > 0;) {
      const std::int64_t since = row + 1 == after_ ? 0 : age(samples_[row]);
      if (since > kSaccadeMemoryNs) {
        break;
      }
      if ((*movements_)[row] == EyeMovement::saccade) {
        return since;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::int64_t age(const GazeSample& sample) const { return saturating_difference(t_ns_, sample.t_ns); }
  [[nodiscard]] bool is_gap(std::int64_t age_ns) const {
    // A log of one row stands for a gaze that never moves.
    return samples_.size() > 1 &&
           (age_ns > mapping_.max_interpolation_gap_ns || age_ns < -mapping_.max_interpolation_gap_ns);
  }

  void take(const GazeSample& sample, GazeState state, std::string reason) {
    result_.state = state;
    result_.u = sample.u;
    result_.v = sample.v;
    result_.direction = sample.direction;
    result_.row_before = sample.t_ns <= t_ns_ ? sample.row : 0;
    result_.row_after = sample.t_ns <= t_ns_ ? 0 : sample.row;
    result_.age_ns = age(sample);
    result_.validity = sample.validity;
    result_.reason = std::move(reason);
  }

  // Whether the eye is steady at both rows around the time; true where its movements are not known.
  [[nodiscard]] bool in_one_fixation() const {
    if (movements_ == nullptr || after_ >= movements_->size()) {
      return true;
    }
    const auto is_steady = [](EyeMovement m) { return m == EyeMovement::fixation || m == EyeMovement::pursuit; };
    return is_steady((*movements_)[after_ - 1]) && is_steady((*movements_)[after_]);
  }

  bool linear() {
    if (after_ == 0 || !is_usable(samples_[after_ - 1].validity)) {
      return false;
    }
    const GazeSample& a = samples_[after_ - 1];
    if (a.t_ns == t_ns_) {
      take(a, GazeState::measured, fmt::format("linear: row {}", a.row));
      return true;
    }
    if (after_ == samples_.size() || !is_usable(samples_[after_].validity)) {
      return false;
    }
    const GazeSample& b = samples_[after_];
    const std::int64_t gap = saturating_difference(b.t_ns, a.t_ns);
    if (gap > mapping_.max_interpolation_gap_ns) {
      return false;
    }
    if (!in_one_fixation()) {
      // The gaze jumps halfway between the two rows.
      const bool first = t_ns_ - a.t_ns <= b.t_ns - t_ns_;
      take(first ? a : b, GazeState::measured,
           fmt::format("linear: row {}, the nearer one: not within a fixation", first ? a.row : b.row));
      return true;
    }
    const double s = static_cast<double>(t_ns_ - a.t_ns) / static_cast<double>(gap);
    take(a, GazeState::measured, fmt::format("linear: rows {} and {}", a.row, b.row));
    result_.row_after = b.row;
    if (log_.kind == GazeKind::screen) {
      result_.u = a.u * (1.0 - s) + b.u * s;
      result_.v = a.v * (1.0 - s) + b.v * s;
    } else {
      result_.direction = between_directions(a.direction, b.direction, s);
    }
    return true;
  }

  // Within the log the nearest row is at most half a step later than the time. Before its first row no more than that
  // is accepted either.
  [[nodiscard]] bool is_far_ahead(std::int64_t age_ns) const {
    return after_ == 0 && samples_.size() > 1 &&
           age_ns < -saturating_difference(samples_[1].t_ns, samples_[0].t_ns) / 2;
  }

  bool nearest() {
    const GazeSample* closest = after_ > 0 ? &samples_[after_ - 1] : nullptr;
    if (after_ < samples_.size()) {
      const GazeSample& next = samples_[after_];
      const auto distance = [&](const GazeSample& s) {
        const Int128 d = Int128{t_ns_} - s.t_ns;
        return d < 0 ? -d : d;
      };
      if (closest == nullptr || distance(next) < distance(*closest)) {
        closest = &next;
      }
    }
    if (closest == nullptr || !is_usable(closest->validity)) {
      return false;
    }
    const std::int64_t age_ns = age(*closest);
    if (age_ns > mapping_.max_age_ns || age_ns < -mapping_.max_age_ns || is_gap(age_ns) || is_far_ahead(age_ns)) {
      return false;
    }
    take(*closest, GazeState::measured, fmt::format("nearest: row {}", closest->row));
    return true;
  }

  [[nodiscard]] const GazeSample* last_usable() const {
    for (std::size_t i = after_; i > 0; --i) {
      if (is_usable(samples_[i - 1].validity)) {
        return &samples_[i - 1];
      }
    }
    return nullptr;
  }

  // Why the log has no fresh sample at this time.
  [[nodiscard]] std::string trouble(const GazeSample* held) const {
    if (after_ == 0) {
      return "before the log's first row";
    }
    const GazeSample& last = samples_[after_ - 1];
    if (!is_usable(last.validity)) {
      return fmt::format("{} at row {}", to_string(last.validity), last.row);
    }
    if (after_ == samples_.size()) {
      return fmt::format("{} after the log's last row", milliseconds(age(last)));
    }
    return fmt::format("gap of {}", milliseconds(saturating_difference(samples_[after_].t_ns, held->t_ns)));
  }

  bool hold() {
    const GazeSample* const sample = last_usable();
    if (sample == nullptr || age(*sample) > mapping_.max_age_ns) {
      return false;
    }
    const bool fresh = sample == &samples_[after_ - 1] && !is_gap(age(*sample));
    if (fresh) {
      const bool fell_back = mapping_.interpolation != GazeInterpolation::hold;
      take(*sample, GazeState::measured,
           fell_back ? fmt::format("hold: row {}, no usable row next to it", sample->row)
                     : fmt::format("hold: row {}", sample->row));
    } else {
      take(*sample, GazeState::held, fmt::format("{}: held row {}", trouble(sample), sample->row));
    }
    return true;
  }

  void no_gaze() {
    result_.no_gaze = true;
    const GazeSample* const before = last_usable();
    const auto first_after = std::find_if(samples_.begin() + static_cast<std::ptrdiff_t>(after_), samples_.end(),
                                          [](const GazeSample& s) { return is_usable(s.validity); });
    const GazeSample* const after = first_after == samples_.end() ? nullptr : &*first_after;
    std::string why = samples_.empty() ? "the log is empty" : trouble(before);
    if (before != nullptr) {
      why += fmt::format(", last usable row {} is {} old (limit {})", before->row, milliseconds(age(*before)),
                         milliseconds(mapping_.max_age_ns));
    }
    switch (mapping_.no_gaze) {
      case NoGazePolicy::hold:
        if (before != nullptr) {
          take(*before, GazeState::held, fmt::format("no gaze ({}): held it", why));
        } else if (after != nullptr) {  // gaze that is yet to come must not steer a frame
          result_.state = GazeState::center;
          result_.reason = fmt::format("no gaze ({}): nothing to hold yet, center", why);
        } else {
          result_.reason = "no gaze (the log has no usable row): uniform";
        }
        return;
      case NoGazePolicy::center:
        result_.state = GazeState::center;
        result_.reason = fmt::format("no gaze ({}): center", why);
        return;
      case NoGazePolicy::uniform:
        result_.reason = fmt::format("no gaze ({}): uniform", why);
        return;
      case NoGazePolicy::error:
        break;
    }
    if (before == nullptr && after != nullptr) {
      why += fmt::format(", first usable row {} comes {} later", after->row, milliseconds(-age(*after)));
    }
    throw Error(ErrorKind::input, log_.source, fmt::format("no gaze at log time {} ns ({})", t_ns_, why),
                "choose `gaze-missing` hold, center or uniform, or render other frames");
  }

  const std::vector<GazeSample>& samples_;
  const GazeLog& log_;
  const GazeMapping& mapping_;
  std::int64_t t_ns_;
  const std::vector<EyeMovement>* movements_;
  std::size_t after_ = 0;  // index of the first sample later than the time
  GazeAtTime result_;
};

}  // namespace

std::string_view to_string(GazeState state) {
  return name_of(state, {"measured", "held", "center", "none"});
}

std::int64_t log_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns) {
  if (!(mapping.scale > 0) || !std::isfinite(mapping.scale)) {
    throw Error(ErrorKind::usage, "", fmt::format("a clock scale of {} is not a positive number", mapping.scale),
                "give `gaze-scale` as video seconds per log second, near 1");
  }
  const std::int64_t event = mapping.event_ns.value_or(log.samples.empty() ? 0 : log.samples.front().t_ns);
  return narrowed(event + divide_by_scale(Int128{t_video_ns} - mapping.offset_ns, mapping.scale));
}

std::int64_t video_time_ns(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_log_ns) {
  if (!(mapping.scale > 0) || !std::isfinite(mapping.scale)) {
    return log_time_ns(log, mapping, 0);  // throws the error
  }
  const std::int64_t event = mapping.event_ns.value_or(log.samples.empty() ? 0 : log.samples.front().t_ns);
  const Int128 since = Int128{t_log_ns} - event;
  Int128 scaled = since;
  if (mapping.scale != 1.0) {
    // x87's 64 bits of mantissa hold every int64 exactly; the product is within half a nanosecond over 290 years.
    const long double product = std::round(static_cast<long double>(since) * static_cast<long double>(mapping.scale));
    // The offset may bring back what exceeds int64 by itself, but nothing that is beyond twice of it.
    if (!(std::abs(product) < 0x1p64L)) {
      beyond_int64();
    }
    scaled = static_cast<Int128>(product);
  }
  return narrowed(scaled + mapping.offset_ns);
}

GazeAtTime gaze_at(const GazeLog& log, const GazeMapping& mapping, std::int64_t t_video_ns,
                   const std::vector<EyeMovement>* movements) {
  return Resampler(log, mapping, log_time_ns(log, mapping, t_video_ns), movements).run();
}

}  // namespace gazetrace
