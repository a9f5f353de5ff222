// SPDX-License-Identifier: Apache-2.0
#include "gazelog/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/enum_name.hpp"
#include "core/statistics.hpp"
#include "core/text.hpp"

namespace gazetrace {

std::optional<PositionUnit> position_unit_from(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, PositionUnit>, 24> kSpellings{{
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
      {"rad", PositionUnit::rad},
      {"rads", PositionUnit::rad},
      {"radian", PositionUnit::rad},
      {"radians", PositionUnit::rad},
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
  return name_of(unit, {"auto", "fraction", "px", "mm", "cm", "deg", "unit-vector", "norm", "height", "rad"});
}

std::string_view to_string(PositionOrigin origin) {
  return name_of(origin, {"auto", "top-left", "bottom-left", "center"});
}

std::string_view to_string(GazeAxes axes) {
  return name_of(axes, {"auto", "gl", "unity", "sranipal", "cv", "unreal"});
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
  std::sort(times.begin(), times.end());  // for rows out of order the steps would be too long
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] != times[i - 1]) {  // equal times are rows of the other eye
      steps.push_back(times[i] - times[i - 1]);
    }
  }
  if (steps.empty()) {
    return std::nullopt;
  }
  const double step = upper_median(steps);
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

}  // namespace gazetrace
