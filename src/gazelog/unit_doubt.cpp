// SPDX-License-Identifier: Apache-2.0
// Tests whether the positions of a file can be in the unit and count from the origin under which they were read. Where
// they cannot, they are interpreted again under the convention that fits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/enum_name.hpp"
#include "gazelog/judge.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

bool is_known(const Vec2d& size) {
  return size.x > 0 && size.y > 0;
}

// A unit, and perhaps an origin, that would fit better, and the option that says so.
struct BetterUnit {
  std::string_view name;  // name of the unit, in the plural
  PositionUnit unit = PositionUnit::automatic;
  std::string setting;
  PositionOrigin origin = PositionOrigin::top_left;
};

struct Positions {
  Extent x, y;
  double most = 0, spread = 0;
};

// Tests degrees, and lengths on a display whose size is known.
std::optional<BetterUnit> doubt_angles_and_lengths(const Positions& p, PositionUnit stated, PositionOrigin origin,
                                                   const DisplayGeometry& display) {
  const Vec2d size_cm{display.width_cm, display.height_cm};
  const Vec2d size_mm{10 * size_cm.x, 10 * size_cm.y};
  const Vec2d size_px{static_cast<double>(display.width_px), static_cast<double>(display.height_px)};
  const bool is_deg = stated == PositionUnit::deg;
  const bool is_length = stated == PositionUnit::mm || stated == PositionUnit::cm;
  const bool from_center = origin == PositionOrigin::center;
  if (is_length && !from_center && p.most < 1.5 && p.spread > 0.02) {
    return BetterUnit{"fractions of the display", PositionUnit::fraction, "`unit` fraction"};
  }
  const Vec2d size = stated == PositionUnit::mm ? size_mm : size_cm;
  const Vec2d reach = from_center ? Vec2d{0.5 * size.x, 0.5 * size.y} : size;
  const auto far = [](const Extent& e, double most_of_it, bool both_ways) {
    return e.high > 1.5 * most_of_it && (both_ways ? e.low < -1.5 * most_of_it : e.median > most_of_it);
  };
  // No eye turns by 60 degrees for long, and no gaze lies beside the display for most of the time. Medians are used
  // because the extremes may be marks of missing values.
  const auto turns_too_far = [](const Extent& e) { return std::abs(e.median) > 60 || (e.low < -90 && e.high > 90); };
  const bool is_wrong =
      is_deg ? turns_too_far(p.x) || turns_too_far(p.y)
             : is_length && is_known(size) && (far(p.x, reach.x, from_center) || far(p.y, reach.y, from_center));
  if (!is_wrong) {
    return std::nullopt;
  }

  const bool centered = std::min(p.x.low, p.y.low) < -0.1 * p.most;
  const auto fits = [&](const Vec2d& wanted) {
    const double low = centered ? -0.6 : -0.1;
    const double high = centered ? 0.6 : 1.1;
    return is_known(wanted) && p.x.low >= low * wanted.x && p.x.high <= high * wanted.x && p.y.low >= low * wanted.y &&
           p.y.high <= high * wanted.y;
  };
  const PositionOrigin better_origin = centered ? PositionOrigin::center : PositionOrigin::top_left;
  const std::string_view counts_from = centered == from_center ? ""
                                       : centered              ? " `origin` center"
                                                               : " `origin` top-left";
  if (stated != PositionUnit::mm && fits(size_mm)) {
    return BetterUnit{"millimetres", PositionUnit::mm, fmt::format("`unit` mm{}", counts_from), better_origin};
  }
  if (fits(size_px) || (is_deg && !is_known(size_px))) {
    return BetterUnit{"pixels", PositionUnit::px, fmt::format("`unit` px{}", counts_from), better_origin};
  }
  return is_deg ? std::optional(BetterUnit{"something else", PositionUnit::automatic, ""}) : std::nullopt;
}

// Tests pixels and fractions.
std::optional<BetterUnit> doubt_places(const Positions& p, PositionUnit unit, double width) {
  const auto& [x, y, most, spread] = p;
  const bool both_signs = (x.low < 0 && x.high > 0) || (y.low < 0 && y.high > 0);
  if (unit == PositionUnit::px && most < 1.5 && spread > 0.02) {
    return BetterUnit{"fractions of the display", PositionUnit::fraction, "`unit` fraction"};
  }
  if (unit == PositionUnit::px && both_signs && most < 60 && most < 0.12 * width && spread > 0.5) {
    return BetterUnit{"degrees from straight ahead", PositionUnit::deg, "`unit` deg", PositionOrigin::center};
  }
  if (unit == PositionUnit::fraction && !(most < 5)) {
    return BetterUnit{"pixels", PositionUnit::px, "`unit` px"};
  }
  return std::nullopt;
}

bool count_from_center(const Positions& p, const Vec2d& size) {
  const auto centred = [](const Extent& e) {
    return e.low < 0 && e.high > 0 && std::abs(e.median) < 0.25 * (e.high - e.low);
  };
  const bool fits = p.x.high - p.x.low <= 1.05 * size.x && p.y.high - p.y.low <= 1.05 * size.y;
  return centred(p.x) && centred(p.y) && fits && p.spread > 0.05 * size.x;
}

std::string_view plural_of(PositionUnit unit) {
  const std::string_view name =
      name_of(unit, {"", "fractions of the display", "pixels", "millimetres", "centimetres", "degrees"});
  return name.empty() ? "such numbers" : name;
}

// How much of the log lies on the display, or can be used, when it is interpreted under other conventions.
std::string read_so(const RawGaze& raw, const RawRows& rows, const Conventions& conventions) {
  if (!are_positions(conventions)) {
    return {};
  }
  try {
    const ToFractions to_fractions(conventions, raw.place);
    std::size_t count = 0;
    for (const RawSample row : rows) {
      const Vec2d at = to_fractions({row.at.x, row.at.y});
      count += is_usable(row.validity) && at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1 ? 1 : 0;
    }
    return fmt::format("; read so, {:.0f} % of the samples lie on the display",
                       100 * static_cast<double>(count) / static_cast<double>(rows.size()));
  } catch (const Error&) {
    return {};  // it would need something that is not known, such as the size of the display
  }
}

}  // namespace

std::optional<ReadingDoubt> doubt_position_unit(const RawGaze& raw, const Conventions& c,
                                                const DisplayGeometry& display) {
  if (c.form != PlaceForm::position || c.unit.evidence == Evidence::statistics) {
    return std::nullopt;
  }
  const RawRows rows = measurable_rows(raw, c);
  const PositionUnit unit = c.unit.value;
  const std::optional<Extent> x = extent_of(rows, &Vec3d::x);
  const std::optional<Extent> y = extent_of(rows, &Vec3d::y);
  // A few rows tell pixels from fractions, since no eye rests many displays away. Their median does, since the extremes
  // may be marks of missing values. All other tests need places all over the display.
  const bool are_few = x && y && (x->is_of_few || y->is_of_few);
  if (!x || !y || (are_few && unit != PositionUnit::fraction)) {
    return std::nullopt;
  }
  const Positions p{
      *x, *y,
      are_few ? std::max(std::abs(x->median), std::abs(y->median)) : std::max({-x->low, x->high, -y->low, y->high}),
      std::max(x->high - x->low, y->high - y->low)};
  const std::string seen =
      fmt::format("90 % of x lie in {:.4g} .. {:.4g}, of y in {:.4g} .. {:.4g}", p.x.low, p.x.high, p.y.low, p.y.high);
  const bool is_place = unit == PositionUnit::px || unit == PositionUnit::fraction;
  const Vec2d size = unit == PositionUnit::px
                         ? Vec2d{static_cast<double>(display.width_px), static_cast<double>(display.height_px)}
                         : Vec2d{1, 1};
  if (is_place && !(size.x > 0)) {
    return std::nullopt;
  }
  std::optional<BetterUnit> better;
  if (is_place) {
    better = doubt_places(p, unit, size.x);
  } else if (raw.kind == GazeKind::screen) {
    // Degrees count from straight ahead, whatever the origin of the log's positions is.
    better = doubt_angles_and_lengths(p, unit, unit == PositionUnit::deg ? raw.declared.origin.value : c.origin.value,
                                      display);
  }
  Conventions other = c;
  if (better) {
    other.unit.value = better->unit;
    other.origin.value = better->origin;
    other.display = Concluded<DisplayGeometry>{display, Evidence::statistics, {}};
    return ReadingDoubt{
        "position-unit", fmt::format("the positions are no {} but {}", plural_of(unit), better->name),
        "statistics: " + seen + (better->unit == PositionUnit::automatic ? "" : read_so(raw, rows, other)),
        better->setting};
  }
  if (is_place && !are_few && c.origin.value == PositionOrigin::top_left && raw.kind == GazeKind::screen &&
      count_from_center(p, size)) {
    other.origin.value = PositionOrigin::center;
    return ReadingDoubt{"origin", "the positions count from the center of the display, not its top left",
                        fmt::format("statistics: {} {}{}", seen, to_string(unit), read_so(raw, rows, other)),
                        "`origin` center"};
  }
  return std::nullopt;
}

}  // namespace gazetrace
