// SPDX-License-Identifier: Apache-2.0
#include "gazelog/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

constexpr double kAboutOne = 1.6;     // beyond it nothing counts fractions of a display
constexpr double kLargestAngle = 60;  // beyond it no eye turns, and no display is seen
constexpr double kFewNegative = 0.05;
constexpr double kLargestPercent = 105;
constexpr std::size_t kMostLookedAt = 60'000;

// Numbers about 1 that lie on both sides of 0.
ReadingDoubt small_numbers_around_zero(const EyeMotion& m) {
  const bool is_as_high_as_wide = std::max(-m.y.low, m.y.high) > 0.55;  // of the display: no height units
  const std::string angles = fmt::format("as degrees {}; as radians {}", m.if_degrees(1), m.if_degrees(kDegPerRad));
  return {"position-unit",
          fmt::format("the unit of x and y is undecided: PsychoPy's {}, degrees or radians?",
                      is_as_high_as_wide ? "norm" : "height or norm units"),
          m.in_words() + "; " + angles,
          is_as_high_as_wide ? "`unit` norm, deg or rad" : "`unit` height, norm, deg or rad"};
}

ReadingDoubt numbers_of_angles(const EyeMotion& m) {
  const bool has_both_signs = m.share_negative >= kFewNegative;
  return {"position-unit",
          fmt::format("the unit of x and y is undecided: {}?",
                      has_both_signs ? "degrees or centimetres" : "pixels, centimetres or degrees"),
          fmt::format("{}; as degrees {}", m.in_words(), m.if_degrees(1)),
          has_both_signs ? "`unit` deg or cm" : "`unit` px, cm or deg"};
}

ReadingDoubt inferred(const UnitReading& reading) {
  return {"unit-inferred",
          fmt::format("the unit of x and y is not stated, only inferred: {}",
                      reading.unit == PositionUnit::px ? "pixels" : "fractions of the display"),
          reading.evidence, fmt::format("`unit` {}", to_string(reading.unit)), false};
}

bool lies_on(const EyeMotion& m, const Vec2d& size) {
  const auto fits = [](const Extent& e, double length) {
    return (e.low > -0.1 * length && e.high < 1.1 * length) || (e.low > -0.6 * length && e.high < 0.6 * length);
  };
  return size.x > 0 && fits(m.x, size.x) && fits(m.y, size.y);
}

class Judge {
 public:
  Judge(const RawGaze& raw, const Conventions& c, const DisplayGeometry& display)
      : raw_(raw), c_(c), display_(display) {}

  std::vector<ReadingDoubt> doubts() {
    if (c_.form == PlaceForm::position) {
      if (c_.unit.evidence != Evidence::statistics) {
        if (auto doubt = doubt_position_unit(raw_, c_, display_)) {
          add(*std::move(doubt), c_.unit.evidence);
        }
      }
      if (doubts_.empty()) {
        places();
        scale();
      }
      zeros();
    } else if (c_.form == PlaceForm::vector) {
      directions();
    }
    return std::move(doubts_);
  }

 private:
  // What is stated of a table of one's own may be a mistake; what a format defines, or the user says, is followed.
  void add(ReadingDoubt doubt, Evidence evidence) {
    doubt.is_open = evidence == Evidence::statistics;
    doubt.refuses = doubt.is_open || (raw_.is_own_table && evidence != Evidence::option);
    doubts_.push_back(std::move(doubt));
  }

  // Where the gaze would lie on the display.
  void places() {
    if (!are_positions(c_) || raw_.kind != GazeKind::screen || !raw_.is_own_table) {
      return;
    }
    Conventions c = c_;
    const bool is_known = display_.width_px > 0 && !(c_.display && c_.display->evidence == Evidence::statistics);
    c.display = c.display ? c.display : Concluded<DisplayGeometry>{display_, Evidence::header, {}};
    std::optional<ToFractions> to_fractions;
    try {
      to_fractions.emplace(c, raw_.place);
    } catch (const Error&) {
      return;  // it needs a size that is not known, which will be said
    }
    std::size_t count = 0;
    std::size_t negative = 0;
    std::size_t first_quarter = 0;  // to the right of and above 0
    std::size_t beside = 0;
    std::size_t beside_center = 0;
    std::size_t on_right = 0;  // of the display, on one of its size
    std::size_t on_left = 0;
    const RawRows rows = measurable_rows(raw_, c_);
    for (const RawSample row : rows) {
      const Vec2d at = (*to_fractions)({row.at.x, row.at.y});
      if (!is_usable(row.validity) || !std::isfinite(at.x) || !std::isfinite(at.y)) {
        continue;
      }
      const auto is_beside = [](double u, double v) { return u < 0 || v < 0 || u > 1 || v > 1; };
      ++count;
      negative += row.at.x < 0 || row.at.y < 0 ? 1 : 0;
      first_quarter += row.at.x >= 0 && row.at.y >= 0 ? 1 : 0;
      beside += is_beside(at.x, at.y) ? 1 : 0;
      beside_center += is_beside(at.x + 0.5, at.y + 0.5) ? 1 : 0;
      on_right += is_beside(at.x - 1, at.y) ? 0 : 1;
      on_left += is_beside(at.x + 1, at.y) ? 0 : 1;
    }
    constexpr std::size_t kFewest = 3;
    constexpr std::size_t kEnough = 50;
    if (count < kFewest) {
      return;
    }
    const auto percent = [&](std::size_t n) { return 100 * static_cast<double>(n) / static_cast<double>(count); };
    const bool is_fraction = c_.unit.value == PositionUnit::fraction;
    const bool is_centered = c_.origin.value == PositionOrigin::center;
    const std::string lie =
        is_known || is_fraction
            ? fmt::format("{:.0f} % of them lie beside the display; counted from its center, {:.0f} %", percent(beside),
                          percent(beside_center))
            : "";
    constexpr std::size_t kFew = 10;
    const std::size_t on_other = std::max(on_right, on_left);
    if (is_known && c_.unit.value == PositionUnit::px && !is_centered && count > kEnough && percent(on_other) > 90) {
      const bool is_right = on_right >= on_left;
      add({"beside-the-display",
           fmt::format("the positions lie on a monitor to the {} of the display", is_right ? "right" : "left"),
           fmt::format("{:.0f} % of them, as where two monitors stand beside each other", percent(on_other)),
           fmt::format("`corner` {},0", is_right ? display_.width_px : -display_.width_px)},
          Evidence::header);
    } else if (!is_centered && percent(negative) > (count < kFew ? 50 : 25)) {
      add({"origin", "the positions count from the center of the display rather than from its corner",
           fmt::format("{:.0f} % of them are negative{}{}", percent(negative), lie.empty() ? "" : ", and ", lie),
           "`origin` center"},
          c_.origin.evidence);
    } else if (percent(beside) > 50 && !lie.empty()) {
      add({"beside-the-display", "most positions lie beside the display: its size, the unit or the origin is wrong",
           lie, "another `unit` or `screen-px`, or `origin` top-left"},
          c_.unit.evidence == Evidence::option || c_.origin.evidence == Evidence::option ? Evidence::option
                                                                                         : Evidence::header);
    } else if (is_centered && percent(first_quarter) > 90 && count > kEnough) {
      add({"origin", "gaze would lie in one quarter of the display alone, to the right of its center and above",
           fmt::format("{:.0f} % of the numbers are not negative, though they count from the center",
                       percent(first_quarter)),
           "another `unit`, or `origin` top-left"},
          c_.unit.evidence == Evidence::option ? Evidence::option : c_.origin.evidence);
    }
  }

  // Zeros in both axes that count as good, as loggers write what they do not know.
  void zeros() {
    if (c_.zero_is_missing) {
      return;
    }
    std::size_t zeros = 0;  // counted from the corner of the display
    for (std::size_t i = 0; i < raw_.rows.size(); ++i) {
      const Vec2d corner = corner_of(raw_, c_, i);
      const Vec3d at = raw_.rows.at(i);
      zeros += at.x == corner.x && at.y == corner.y && is_usable(raw_.rows[i].validity) ? 1 : 0;
    }
    // From the center straight ahead is a place like any other: zeros are missing values only where there are many.
    const std::size_t rows_for_one = c_.origin.value == PositionOrigin::center ? 200 : 2000;
    if (zeros >= 3 && zeros < raw_.rows.size() && zeros * rows_for_one >= raw_.rows.size()) {
      add({"zero-missing",
           fmt::format("{} of {} rows are exactly at (0, 0) and count as good: missing values written as zeros", zeros,
                       raw_.rows.size()),
           "statistics: noise never gives exact zeros in both axes that often", "`missing-value` 0"},
          c_.missing_value ? Evidence::option : Evidence::header);
    }
  }

  // How many degrees a unit is about, on a display that is 40 degrees wide where its distance is not known.
  [[nodiscard]] double degrees_of_unit() const {
    const DisplayGeometry& d = display_;
    const bool knows_angle = d.width_cm > 0 && d.distance_cm > 0;
    const double width = knows_angle ? 2 * std::atan2(0.5 * d.width_cm, d.distance_cm) * kDegPerRad : 40;
    switch (c_.unit.value) {
      case PositionUnit::fraction:
        return c_.origin.value == PositionOrigin::center ? 0.5 * width : width;
      case PositionUnit::norm:
        return 0.5 * width;
      case PositionUnit::height:
        return d.width_px > 0 && d.height_px > 0 ? width * d.height_px / d.width_px : 0.6 * width;
      case PositionUnit::px:
        return d.width_px > 0 ? width / d.width_px : 0;
      case PositionUnit::cm:
        return d.width_cm > 0 ? width / d.width_cm : 1;
      case PositionUnit::mm:
        return d.width_cm > 0 ? 0.1 * width / d.width_cm : 0.1;
      default:
        return 1;
    }
  }

  // Numbers whose saccades last far too long, or too short, for the size that they would have.
  void scale() {
    if (c_.unit.evidence == Evidence::statistics || raw_.kind != GazeKind::screen) {
      return;
    }
    const auto motion = measure_motion(measurable_rows(raw_, c_), raw_);
    const double degrees = degrees_of_unit() * c_.unit_scale;  // of a number as the file has it
    const auto factor = motion ? motion->degrees_per_unit() : std::nullopt;
    // The beginning and the end of a saccade are lost in noise: they seem shorter than they are, by up to three times.
    constexpr double kFarTooSmall = 2;
    constexpr double kFarTooLarge = 10;
    constexpr double kSmallDeg = 8;
    constexpr double kLargeDeg = 8;
    // Jumps that are tiny beside the way that the eye goes, as in pursuit, are noise and tell nothing.
    constexpr double kLeastShare = 0.1;
    const double spread = motion ? std::max(motion->x.spread(), motion->y.spread()) : 0.0;
    const bool is_too_small = factor && *factor > kFarTooSmall * degrees && degrees_of_unit() * spread < kSmallDeg &&
                              motion->saccades->amplitude > kLeastShare * spread;
    const bool is_too_large =
        factor && *factor * kFarTooLarge < degrees && degrees * motion->saccades->amplitude > kLargeDeg;
    if (is_too_small || is_too_large) {
      add({"position-unit", fmt::format("the positions can hardly be in {}", to_string(c_.unit.value)),
           fmt::format("{}; so {}", motion->in_words(), motion->if_degrees(degrees)), "another `unit`"},
          c_.unit.evidence);
    }
  }

  void directions() {
    std::size_t count = 0;
    std::size_t backwards = 0;
    std::size_t along_x = 0;
    std::size_t coarse = 0;
    std::vector<double> aside;
    std::vector<double> lengths;
    const std::size_t stride = raw_.rows.size() / kMostLookedAt + 1;
    for (std::size_t i = 0; i < raw_.rows.size(); i += stride) {
      const RawSample row = raw_.rows[i];
      const Vec3d v = vector_of(row, c_);
      const Vec3d d = from_axes(v, c_.axes.value);
      if (!is_usable(row.validity) || !is_finite(d) || !(length(d) > 0)) {
        continue;
      }
      ++count;
      backwards += d.z > 0 ? 1 : 0;
      along_x += v.x > std::abs(v.y) && v.x > std::abs(v.z) ? 1 : 0;
      aside.push_back(std::acos(std::clamp(-d.z / length(d), -1.0, 1.0)) * kDegPerRad);
      lengths.push_back(length(d));
      const auto has_one_decimal = [](double value) { return std::abs(10 * value - std::round(10 * value)) < 1e-9; };
      coarse += has_one_decimal(d.x) && has_one_decimal(d.y) && has_one_decimal(d.z) ? 1 : 0;
    }
    constexpr std::size_t kFewest = 10;
    if (count < kFewest && (count < 2 || backwards < count)) {
      return;
    }
    const double length = lower_quantile(lengths, 0.5);
    const double least = lower_quantile(lengths, 0.1);
    const double most = lower_quantile(lengths, 0.9);
    if (!raw_.are_points && count >= kFewest && (least < 0.85 || most > 1.15)) {
      add({"no-unit-vectors", "these are no directions but points or positions",
           fmt::format("their lengths are {:.3g} in the median, 80 % of them {:.3g} to {:.3g}, and a direction has the "
                       "length 1",
                       length, least, most),
           "`x-column` and `y-column`"},
          Evidence::header);
      return;
    }
    if (count >= kFewest && coarse * 10 > count * 9) {
      doubts_.push_back({"coarse",
                         "the log is too coarse for anything but a glance: its directions come in steps of 0.1, which "
                         "are 5.7 degrees",
                         "the numbers have one decimal, as a vector's ToString() writes them; log all digits", "",
                         false, false});
    }
    if (c_.axes.value != GazeAxes::unreal && along_x * 10 > count * 9) {
      add({"axes",
           fmt::format("the axes {}: {} of {} directions point along +x",
                       c_.axes.evidence == Evidence::statistics ? "are undecided" : "can hardly be right", along_x,
                       count),
           fmt::format("to the side in {} axes; +x is ahead in unreal (z up)", to_string(c_.axes.value)),
           "`axes` unreal"},
          c_.axes.evidence);
    } else if (backwards * 2 > count) {
      add({"axes",
           fmt::format("the axis convention {}: {} of {} directions point behind the head",
                       c_.axes.evidence == Evidence::statistics ? "is unknown" : "can hardly be right", backwards,
                       count),
           fmt::format(
               "in {} axes, which were assumed; they look ahead in unity (x to the right, y up), in sranipal (x to "
               "the left, y up) and in cv (x to the right, y down). The program that wrote the file tells which",
               to_string(c_.axes.value)),
           "`axes` unity, sranipal or cv"},
          c_.axes.evidence);
    } else if (const double angle = lower_quantile(aside, 0.5); angle > kLargestAngle) {
      add({"looks-aside", fmt::format("the eye would look {:.0f} degrees aside for most of the time", angle),
           "the angle of the directions from straight ahead, in the median; an eye turns by 30 degrees",
           "`axes`, `x-column` and `z-column`"},
          Evidence::header);
    }
  }

  const RawGaze& raw_;
  const Conventions& c_;
  const DisplayGeometry& display_;
  std::vector<ReadingDoubt> doubts_;
};

}  // namespace

UnitReading read_unit(const RawRows& rows, const RawGaze& raw, const DisplayGeometry& display) {
  UnitReading reading;
  const std::optional<EyeMotion> motion = measure_motion(rows, raw);
  if (!motion) {
    reading.unit = PositionUnit::fraction;
    reading.evidence = "no usable value";
    return reading;
  }
  const EyeMotion& m = *motion;
  reading.evidence = m.in_words();
  if (m.most() <= kAboutOne && m.share_negative >= kFewNegative) {
    reading.unit = PositionUnit::norm;
    reading.doubt = small_numbers_around_zero(m);
  } else if (m.most() <= kAboutOne) {
    reading.unit = PositionUnit::fraction;
    reading.evidence += fmt::format("; as pixels the eye would move over {:.2g} of them, as degrees {}",
                                    std::max(m.x.spread(), m.y.spread()), m.if_degrees(1));
    reading.doubt = inferred(reading);
  } else if (m.most() <= kLargestAngle) {
    reading.unit = m.share_negative >= kFewNegative ? PositionUnit::deg : PositionUnit::px;
    reading.doubt = numbers_of_angles(m);
  } else {
    const Vec2d px{static_cast<double>(display.width_px), static_cast<double>(display.height_px)};
    const Vec2d mm{10 * display.width_cm, 10 * display.height_cm};
    reading.unit = PositionUnit::px;
    reading.evidence += fmt::format("; as degrees the eye would turn to {:.0f}", m.most());
    const bool may_be_percent = m.x.low >= 0 && m.y.low >= 0 && m.most() <= kLargestPercent;
    // Millimetres lie in that corner of the display that has as many pixels.
    const bool may_be_mm =
        mm.x > 0 && std::min(m.x.low, m.y.low) >= 0 && m.x.high < 1.1 * mm.x && m.y.high < 1.1 * mm.y;
    reading.is_plain = lies_on(m, px) && !may_be_mm && !may_be_percent;
    if (may_be_percent) {
      reading.doubt = ReadingDoubt{"position-unit", "the unit of x and y is undecided: pixels or per cent?",
                                   m.in_words() + ", and a display has more pixels than a hundred",
                                   "`unit` px (divide per cent by 100 first, for `unit` fraction)"};
    } else if (may_be_mm) {
      reading.doubt = ReadingDoubt{"position-unit", "the unit of x and y is undecided: pixels or millimetres?",
                                   m.in_words() + ", and the display's size is known in both", "`unit` px or mm"};
    } else if (!reading.is_plain) {
      reading.doubt = inferred(reading);
      reading.doubt->setting += px.x > 0 ? "" : " `screen-px` W,H";
    }
  }
  return reading;
}

std::vector<ReadingDoubt> judge_reading(const RawGaze& raw, const Conventions& conventions,
                                        const DisplayGeometry& display) {
  return Judge(raw, conventions, display).doubts();
}

bool are_other_numbers_meant(const RawGaze& raw) {
  return std::any_of(raw.faults.begin(), raw.faults.end(), [](const RawFault& fault) {
    return fault.code == "validity" || fault.code == "sum-of-eyes" || fault.code == "look-alike";
  });
}

void refuse_doubt(const RawGaze& raw, const ReadingDoubt& doubt, const GazeReadOptions& options) {
  const std::string problem = fmt::format("{} ({})", doubt.what, doubt.evidence);
  throw Error(ErrorKind::input, raw.place.empty() ? raw.source : raw.place, problem,
              options.accepts_inferred
                  ? "give " + doubt.setting
                  : fmt::format("state it once: gazetrace gaze import {} -o gaze.csv {}", raw.source, doubt.setting));
}

}  // namespace gazetrace
