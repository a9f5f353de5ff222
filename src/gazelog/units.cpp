// SPDX-License-Identifier: Apache-2.0
#include "gazelog/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/text.hpp"

namespace gazetrace {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

struct Statistics {
  Range x, y;
  double share_normalized = 0;  // both coordinates in [-0.2, 1.2]
  double share_small = 0;       // both below 90 in size
  double share_negative = 0;    // either coordinate below 0
  std::size_t count = 0;
};

Statistics measure(const std::vector<GazeSample>& samples) {
  Statistics s;
  std::size_t normalized = 0;
  std::size_t small = 0;
  std::size_t negative = 0;
  for (const GazeSample& sample : samples) {
    if (!is_usable(sample.validity)) {
      continue;
    }
    ++s.count;
    s.x = {std::min(s.x.low, sample.u), std::max(s.x.high, sample.u)};
    s.y = {std::min(s.y.low, sample.v), std::max(s.y.high, sample.v)};
    normalized += sample.u >= -0.2 && sample.u <= 1.2 && sample.v >= -0.2 && sample.v <= 1.2 ? 1 : 0;
    small += std::abs(sample.u) < 90 && std::abs(sample.v) < 90 ? 1 : 0;
    negative += sample.u < 0 || sample.v < 0 ? 1 : 0;
  }
  const auto share = [&](std::size_t n) {
    return s.count > 0 ? static_cast<double>(n) / static_cast<double>(s.count) : 0;
  };
  s.share_normalized = share(normalized);
  s.share_small = share(small);
  s.share_negative = share(negative);
  return s;
}

// Size of the display in the unit of the positions.
Vec2d display_size(PositionUnit unit, const std::optional<DisplayGeometry>& display, const std::string& place) {
  const DisplayGeometry d = display.value_or(DisplayGeometry{});
  const auto missing = [&](std::string_view what, std::string_view remedy) {
    throw Error(
        ErrorKind::input, place,
        fmt::format("positions are in {}, and {} of the display of the recording is not known", to_string(unit), what),
        remedy);
  };
  if (unit == PositionUnit::px) {
    if (d.width_px <= 0 || d.height_px <= 0) {
      missing("the size in pixels", "give --screen-px W,H, or write `# display_px W H` above the header");
    }
    return {static_cast<double>(d.width_px), static_cast<double>(d.height_px)};
  }
  if (!(d.width_cm > 0) || !(d.height_cm > 0)) {
    missing("the size in cm", "give --screen-cm W,H, or write `# display_mm W H` above the header");
  }
  if (unit == PositionUnit::deg && !(d.distance_cm > 0)) {
    missing("the eye's distance", "give --screen-distance-cm, or write `# distance_mm D` above the header");
  }
  const double per_cm = unit == PositionUnit::mm ? 10.0 : 1.0;
  return {d.width_cm * per_cm, d.height_cm * per_cm};
}

// 90 % of the values of usable samples.
struct Extent {
  double low = 0, median = 0, high = 0;
};
// Empty of a few.
std::optional<Extent> extent_of(const std::vector<GazeSample>& samples, double GazeSample::*coordinate) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const GazeSample& sample : samples) {
    if (is_usable(sample.validity) && std::isfinite(sample.*coordinate)) {
      values.push_back(sample.*coordinate);
    }
  }
  if (values.size() < 10) {
    return std::nullopt;
  }
  const auto at = [&](double share) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  return Extent{at(0.05), at(0.5), at(0.95)};
}

bool is_known(const Vec2d& size) {
  return size.x > 0 && size.y > 0;
}

template <class Convert>
void for_known_positions(GazeLog& log, const Convert& convert) {
  for (GazeSample& sample : log.samples) {
    convert(sample.u, sample.v);
  }
}

}  // namespace

std::optional<PositionUnit> position_unit_from(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, PositionUnit>, 20> kSpellings{{
      {"1", PositionUnit::fraction},
      {"norm", PositionUnit::fraction},
      {"normalized", PositionUnit::fraction},
      {"normalised", PositionUnit::fraction},
      {"fraction", PositionUnit::fraction},
      {"px", PositionUnit::px},
      {"pix", PositionUnit::px},
      {"pixel", PositionUnit::px},
      {"pixels", PositionUnit::px},
      {"mm", PositionUnit::mm},
      {"cm", PositionUnit::cm},
      {"deg", PositionUnit::deg},
      {"degree", PositionUnit::deg},
      {"degrees", PositionUnit::deg},
      {"dva", PositionUnit::deg},
      {"degree of visual angle", PositionUnit::deg},
      {"degrees of visual angle", PositionUnit::deg},
      {"\xC2\xB0", PositionUnit::deg},
      {"unit", PositionUnit::unit_vector},
      {"unit vector", PositionUnit::unit_vector},
  }};
  const std::string lower = to_lower(trim(text));
  for (const auto& [spelling, unit] : kSpellings) {
    if (lower == spelling) {
      return unit;
    }
  }
  // Tobii: ADCSpx and DACS px are pixels of the display, ADCSmm millimetres on it.
  if (lower == "adcspx" || lower == "dacspx" || lower == "dacs px") {
    return PositionUnit::px;
  }
  return lower == "adcsmm" ? std::optional(PositionUnit::mm) : std::nullopt;
}

std::string_view to_string(PositionUnit unit) {
  switch (unit) {
    case PositionUnit::automatic:
      return "auto";
    case PositionUnit::fraction:
      return "fraction";
    case PositionUnit::px:
      return "px";
    case PositionUnit::mm:
      return "mm";
    case PositionUnit::cm:
      return "cm";
    case PositionUnit::deg:
      return "deg";
    case PositionUnit::unit_vector:
      return "unit-vector";
  }
  return "auto";
}

std::string_view to_string(PositionOrigin origin) {
  switch (origin) {
    case PositionOrigin::automatic:
      return "auto";
    case PositionOrigin::top_left:
      return "top-left";
    case PositionOrigin::bottom_left:
      return "bottom-left";
    case PositionOrigin::center:
      return "center";
  }
  return "auto";
}

std::optional<int> time_exponent_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::automatic:
      return std::nullopt;
    case TimeUnit::ns:
      return 0;
    case TimeUnit::us:
      return 3;
    case TimeUnit::ms:
      return 6;
    case TimeUnit::s:
      return 9;
  }
  return std::nullopt;
}

std::string time_unit_text(int exponent) {
  switch (exponent) {
    case 0:
      return "ns";
    case 2:
      return "100 ns";
    case 3:
      return "us";
    case 6:
      return "ms";
    case 9:
      return "s";
    default:
      return fmt::format("10^{} ns", exponent);
  }
}

std::optional<int> guess_time_exponent(const std::vector<double>& raw_times) {
  std::vector<double> times = raw_times;
  std::sort(times.begin(), times.end());  // of rows out of order the steps would be too long
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] != times[i - 1]) {  // rows of the other eye
      steps.push_back(times[i] - times[i - 1]);
    }
  }
  if (steps.empty()) {
    return std::nullopt;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double step = *middle;
  if (step >= 1e-3 && step <= 0.05) {
    return 9;
  }
  if (step >= 0.5 && step <= 40) {
    return 6;
  }
  if (step >= 500 && step <= 40'000) {
    return 3;
  }
  return step > 4e5 ? std::optional(0) : std::nullopt;
}

PositionUnit guess_position_unit(const std::vector<GazeSample>& samples, std::string& evidence) {
  const Statistics s = measure(samples);
  evidence = s.count == 0 ? "no usable value"
                          : fmt::format("x {:.4g} to {:.4g}, y {:.4g} to {:.4g}", s.x.low, s.x.high, s.y.low, s.y.high);
  if (s.count == 0 || s.share_normalized >= 0.95) {
    return PositionUnit::fraction;
  }
  const auto has_both_signs = [](const Range& range) { return range.low < 0 && range.high > 0; };
  const bool both_signs = has_both_signs(s.x) || has_both_signs(s.y);
  return s.share_small >= 0.95 && both_signs ? PositionUnit::deg : PositionUnit::px;
}

std::optional<GazeFault> doubt_position_unit(const std::vector<GazeSample>& samples, PositionUnit stated,
                                             PositionOrigin origin, const DisplayGeometry& display) {
  const std::optional<Extent> known_x = extent_of(samples, &GazeSample::u);
  const std::optional<Extent> known_y = extent_of(samples, &GazeSample::v);
  if (!known_x || !known_y) {
    return std::nullopt;
  }
  const Extent& x = *known_x;
  const Extent& y = *known_y;
  const double most = std::max({-x.low, x.high, -y.low, y.high});
  const double spread = std::max(x.high - x.low, y.high - y.low);
  const Vec2d size_cm{display.width_cm, display.height_cm};
  const Vec2d size_mm{10 * size_cm.x, 10 * size_cm.y};
  const Vec2d size_px{static_cast<double>(display.width_px), static_cast<double>(display.height_px)};
  const auto doubt = [&](std::string_view is_not, std::string_view but, std::string flag) {
    return GazeFault{"position-unit",
                     fmt::format("the positions are no {} but {}: 90 % of x lie in {:.4g} .. {:.4g}, of y in {:.4g} .. "
                                 "{:.4g}",
                                 is_not, but, x.low, x.high, y.low, y.high),
                     std::move(flag)};
  };

  const bool is_deg = stated == PositionUnit::deg;
  const bool is_length = stated == PositionUnit::mm || stated == PositionUnit::cm;
  const std::string_view stated_name = is_deg ? "degrees" : stated == PositionUnit::mm ? "millimetres" : "centimetres";
  const bool from_center = origin == PositionOrigin::center;
  if (is_length && !from_center && most < 1.5 && spread > 0.02) {
    return doubt(stated_name, "fractions of the display", "--gaze-unit fraction");
  }
  const Vec2d size = stated == PositionUnit::mm ? size_mm : size_cm;
  const Vec2d reach = from_center ? Vec2d{0.5 * size.x, 0.5 * size.y} : size;
  const auto far = [](const Extent& e, double most_of_it, bool both_ways) {
    return e.high > 1.5 * most_of_it && (both_ways ? e.low < -1.5 * most_of_it : e.median > most_of_it);
  };
  // No eye turns by a right angle, and no gaze is beside the display for most of the time. Medians, because the ends
  // may be marks of missing values.
  const auto turns_too_far = [](const Extent& e) { return std::abs(e.median) > 90 || (e.low < -90 && e.high > 90); };
  const bool is_wrong =
      is_deg ? turns_too_far(x) || turns_too_far(y)
             : is_length && is_known(size) && (far(x, reach.x, from_center) || far(y, reach.y, from_center));
  if (!is_wrong) {
    return std::nullopt;
  }

  const bool centered = std::min(x.low, y.low) < -0.1 * most;
  const auto fits = [&](const Vec2d& wanted) {
    const double low = centered ? -0.6 : -0.1;
    const double high = centered ? 0.6 : 1.1;
    return is_known(wanted) && x.low >= low * wanted.x && x.high <= high * wanted.x && y.low >= low * wanted.y &&
           y.high <= high * wanted.y;
  };
  const std::string_view counts_from = centered == from_center ? ""
                                       : centered              ? " --gaze-origin center"
                                                               : " --gaze-origin top-left";
  if (stated != PositionUnit::mm && fits(size_mm)) {
    return doubt(stated_name, "millimetres", fmt::format("--gaze-unit mm{}", counts_from));
  }
  if (fits(size_px) || (is_deg && !is_known(size_px))) {
    return doubt(stated_name, "pixels", fmt::format("--gaze-unit px{}", counts_from));
  }
  return is_deg ? std::optional(doubt(stated_name, "something else", "")) : std::nullopt;
}

void convert_positions(GazeLog& log, PositionUnit unit, PositionOrigin origin,
                       const std::optional<DisplayGeometry>& display, const std::string& place) {
  if (origin == PositionOrigin::automatic) {
    if (unit != PositionUnit::deg) {
      const Statistics s = measure(log.samples);
      if (s.share_negative > 0.25) {
        log.warnings.push_back(
            fmt::format("{}: {:.0f} % of the positions are negative, counted from the top left: is the origin at the "
                        "center (--gaze-origin center)?",
                        place, 100 * s.share_negative));
      }
    }
    origin = unit == PositionUnit::deg ? PositionOrigin::center : PositionOrigin::top_left;
  }
  if (unit == PositionUnit::deg) {
    if (origin != PositionOrigin::center) {
      throw Error(ErrorKind::usage, place,
                  fmt::format("positions in degrees cannot count from the {}", to_string(origin)),
                  "degrees count from straight ahead: --gaze-origin center");
    }
    // Azimuth and elevation taken as independent: x = d tan(azimuth), y = d tan(elevation).
    const Vec2d size = display_size(unit, display, place);
    for_known_positions(log, [&](double& u, double& v) {
      const double right = std::tan(u * kRadPerDeg) * display->distance_cm + display->eye_x_cm;
      const double up = std::tan(v * kRadPerDeg) * display->distance_cm + display->eye_y_cm;
      u = 0.5 + right / size.x;
      v = 0.5 - up / size.y;
    });
    return;
  }
  // Centred fractions count half the display: -1..1.
  const Vec2d size = unit != PositionUnit::fraction     ? display_size(unit, display, place)
                     : origin == PositionOrigin::center ? Vec2d{2, 2}
                                                        : Vec2d{1, 1};
  for_known_positions(log, [&](double& u, double& v) {
    u /= size.x;
    v /= size.y;
    if (origin == PositionOrigin::bottom_left) {
      v = 1.0 - v;
    } else if (origin == PositionOrigin::center) {
      u = 0.5 + u;
      v = 0.5 - v;
    }
  });
}

}  // namespace gazetrace
