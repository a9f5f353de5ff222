// SPDX-License-Identifier: Apache-2.0
#include "gazelog/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/enum_name.hpp"
#include "core/statistics.hpp"
#include "core/text.hpp"

namespace gazetrace {

std::optional<PositionUnit> position_unit_from(std::string_view text) {
  // Tobii: ADCSpx and DACS px are pixels of the display, ADCSmm millimetres on it.
  static const std::vector<std::pair<PositionUnit, std::vector<std::string_view>>> kSpellings{
      {PositionUnit::fraction, {"1", "norm", "normalized", "normalised", "fraction"}},
      {PositionUnit::px, {"px", "pix", "pixel", "pixels", "adcspx", "dacspx", "dacs px"}},
      {PositionUnit::mm, {"mm", "adcsmm"}},
      {PositionUnit::cm, {"cm"}},
      {PositionUnit::deg,
       {"deg", "degree", "degrees", "dva", "degree of visual angle", "degrees of visual angle", "\xC2\xB0"}},
      {PositionUnit::rad, {"rad", "rads", "radian", "radians"}},
      {PositionUnit::unit_vector, {"unit", "unit vector"}},
  };
  const std::string lower = to_lower(trim(text));
  for (const auto& [unit, spellings] : kSpellings) {
    if (std::find(spellings.begin(), spellings.end(), lower) != spellings.end()) {
      return unit;
    }
  }
  return std::nullopt;
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

std::string_view to_string(TimeUnit unit) {
  return name_of(unit, {"auto", "ns", "us", "ms", "s"});
}

std::optional<int> time_exponent_of(TimeUnit unit) {
  return time_exponent(to_string(unit));
}

std::string time_unit_text(int exponent) {
  for (const TimeUnit unit : {TimeUnit::ns, TimeUnit::us, TimeUnit::ms, TimeUnit::s}) {
    if (time_exponent_of(unit) == exponent) {
      return std::string(to_string(unit));
    }
  }
  return exponent == 2 ? "100 ns" : fmt::format("10^{} ns", exponent);
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
