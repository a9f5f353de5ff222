// SPDX-License-Identifier: Apache-2.0
#include "gaze/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "core/text.hpp"
#include "gaze/units.hpp"

namespace gazetrace {
namespace {

using Names = std::span<const std::string_view>;

std::string letters_and_digits(std::string_view text) {
  std::string kept;
  for (const char c : to_lower(text)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      kept += c;
    }
  }
  return kept;
}

bool is_known_unit(std::string_view text) {
  return time_exponent(text).has_value() || position_unit_from(text).has_value();
}

std::string listing(const std::vector<ColumnHeading>& headings) {
  std::vector<std::string> texts;
  texts.reserve(headings.size());
  for (const ColumnHeading& heading : headings) {
    texts.push_back(heading.text);
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

class Finder {
 public:
  Finder(const std::vector<ColumnHeading>& headings, const std::string& place) : headings_(headings), place_(place) {}

  // A column that the user names: by its whole text, by its name without the unit, or by its number from 1.
  [[nodiscard]] std::size_t declared(const std::string& name) const {
    const std::string wanted = to_lower(trim(name));
    for (const auto part : {&ColumnHeading::text, &ColumnHeading::name}) {
      for (std::size_t i = 0; i < headings_.size(); ++i) {
        if (to_lower(headings_[i].*part) == wanted) {
          return i;
        }
      }
    }
    std::size_t number = 0;
    const auto [rest, status] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (status == std::errc{} && rest == wanted.data() + wanted.size() && number >= 1 && number <= headings_.size()) {
      return number - 1;
    }
    std::vector<std::string> names;
    for (const ColumnHeading& heading : headings_) {
      names.push_back(heading.text);
    }
    throw Error(ErrorKind::input, place_, unknown_name_message("column", name, names));
  }

  [[nodiscard]] std::optional<std::size_t> by_role(Names names) const {
    for (const std::string_view name : names) {
      for (std::size_t i = 0; i < headings_.size(); ++i) {
        if (letters_and_digits(headings_[i].name) == name) {
          return i;
        }
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::size_t> optional(const std::string& name, Names names) const {
    return name.empty() ? by_role(names) : std::optional(declared(name));
  }

  [[nodiscard]] std::size_t required(const std::string& name, Names names, std::string_view what,
                                     std::string_view option) const {
    if (const auto found = optional(name, names)) {
      return *found;
    }
    throw Error(ErrorKind::input, place_,
                fmt::format("no column for {} is found; the columns are: {}", what, listing(headings_)),
                fmt::format("name it with {}", option));
  }

 private:
  const std::vector<ColumnHeading>& headings_;
  const std::string& place_;
};

using std::string_view_literals::operator""sv;
constexpr std::array kTime{"t"sv, "time"sv, "timestamp"sv, "recordingtimestamp"sv, "gazetimestamp"sv};
constexpr std::array kValidity{"valid"sv, "validity"sv, "isvalid"sv};
constexpr std::array kConfidence{"confidence"sv, "conf"sv};
constexpr std::array kPupil{"pupil"sv, "pupilsize"sv, "pupildiameter"sv};
constexpr std::array kEye{"eye"sv, "recordedeye"sv};
constexpr std::array kDirectionX{"dx"sv, "dirx"sv, "directionx"sv, "gazedirectionx"sv, "gazedirx"sv};
constexpr std::array kDirectionY{"dy"sv, "diry"sv, "directiony"sv, "gazedirectiony"sv, "gazediry"sv};
constexpr std::array kDirectionZ{"dz"sv, "dirz"sv, "directionz"sv, "gazedirectionz"sv, "gazedirz"sv};
constexpr std::array kScreenX{"u"sv,        "x"sv,    "gazex"sv, "xcoordinate"sv, "gazepointx"sv,
                              "gazeposx"sv, "porx"sv, "posx"sv,  "xpos"sv};
constexpr std::array kScreenY{"v"sv,        "y"sv,    "gazey"sv, "ycoordinate"sv, "gazepointy"sv,
                              "gazeposy"sv, "pory"sv, "posy"sv,  "ypos"sv};

void plan_positions(ColumnPlan& plan, const Finder& find, const GazeColumns& declared) {
  const bool directions_named = find.by_role(kDirectionX) && find.by_role(kDirectionY) && find.by_role(kDirectionZ);
  const bool is_direction = !declared.z.empty() || declared.position_unit == PositionUnit::unit_vector ||
                            (directions_named && declared.x.empty() && declared.y.empty());
  if (is_direction) {
    plan.kind = GazeKind::direction;
    plan.x = find.required(declared.x, kDirectionX, "direction x", "--gaze-x-column");
    plan.y = find.required(declared.y, kDirectionY, "direction y", "--gaze-y-column");
    plan.z = find.required(declared.z, kDirectionZ, "direction z", "--gaze-z-column");
    return;
  }
  plan.x = find.required(declared.x, kScreenX, "the horizontal position", "--gaze-x-column");
  plan.y = find.required(declared.y, kScreenY, "the vertical position", "--gaze-y-column");
}

void plan_time_unit(ColumnPlan& plan, const ColumnHeading& heading, const GazeColumns& declared,
                    const std::string& place) {
  if (!heading.unit.empty()) {
    plan.time_exponent = time_exponent(heading.unit);
  }
  const auto flag = time_exponent_of(declared.time_unit);
  if (flag && plan.time_exponent && *flag != *plan.time_exponent) {
    plan.warnings.push_back(
        fmt::format("{}: the header says that '{}' is in {}; --gaze-time-unit {} was given and is used", place,
                    heading.text, time_unit_text(*plan.time_exponent), time_unit_text(*flag)));
  }
  if (flag) {
    plan.time_exponent = flag;
  } else if (!heading.unit.empty() && !plan.time_exponent) {
    throw Error(ErrorKind::input, place,
                fmt::format("unknown unit '{}' of time column '{}'", heading.unit, heading.text),
                "use [s], [ms], [us] or [ns], or give --gaze-time-unit");
  }
}

PositionUnit unit_of(const ColumnHeading& heading, const GazeColumns& declared, const std::string& place) {
  if (heading.unit.empty()) {
    // u and v are nothing but fractions; other names say nothing.
    return heading.name == "u" || heading.name == "v" ? PositionUnit::fraction : PositionUnit::automatic;
  }
  const auto unit = position_unit_from(heading.unit);
  if (!unit && declared.position_unit == PositionUnit::automatic) {
    throw Error(ErrorKind::input, place, fmt::format("unknown unit '{}' of column '{}'", heading.unit, heading.text),
                "use [1], [px], [mm], [cm] or [deg], or give --gaze-unit");
  }
  return unit.value_or(PositionUnit::automatic);
}

void plan_position_unit(ColumnPlan& plan, const std::vector<ColumnHeading>& headings, const GazeColumns& declared,
                        const std::string& place) {
  const PositionUnit flag = declared.position_unit;
  if (plan.kind == GazeKind::direction) {
    if (flag != PositionUnit::automatic && flag != PositionUnit::unit_vector) {
      throw Error(ErrorKind::usage, place, fmt::format("directions of three columns cannot be in {}", to_string(flag)),
                  "leave --gaze-unit out, or name two columns");
    }
    plan.unit = PositionUnit::unit_vector;
    return;
  }
  const PositionUnit x = unit_of(headings[plan.x], declared, place);
  const PositionUnit y = unit_of(headings[plan.y], declared, place);
  if (x != y && flag == PositionUnit::automatic) {
    throw Error(
        ErrorKind::input, place,
        fmt::format("columns '{}' and '{}' are in different units", headings[plan.x].text, headings[plan.y].text),
        "name two columns of one unit, or give --gaze-unit");
  }
  if (flag != PositionUnit::automatic && x != PositionUnit::automatic && x != flag) {
    plan.warnings.push_back(fmt::format("{}: the header says that '{}' is in {}; --gaze-unit {} was given and is used",
                                        place, headings[plan.x].text, to_string(x), to_string(flag)));
  }
  plan.unit = flag != PositionUnit::automatic ? flag : x;
}

}  // namespace

ColumnHeading parse_heading(std::string_view cell) {
  std::string buffer;
  const std::string_view text = cell_text(cell, buffer);
  ColumnHeading heading{std::string(text), std::string(text), ""};
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t at = text.rfind(open);
    if (at != std::string_view::npos && at > 0 && text.back() == close) {
      heading.name = trim(text.substr(0, at));
      heading.unit = trim(text.substr(at + 1, text.size() - at - 2));
      return heading;
    }
  }
  // "x_px", "time_ms": only where the last part is a unit and no column of its own.
  const std::size_t bar = text.rfind('_');
  if (bar != std::string_view::npos && bar > 0 && is_known_unit(text.substr(bar + 1)) && text.substr(bar + 1) != "1") {
    heading.name = text.substr(0, bar);
    heading.unit = text.substr(bar + 1);
  }
  return heading;
}

ColumnPlan plan_columns(const std::vector<ColumnHeading>& headings, const GazeColumns& declared,
                        const std::string& place) {
  const Finder find(headings, place);
  ColumnPlan plan;
  plan.time = find.required(declared.time, kTime, "time", "--gaze-time-column");
  plan_positions(plan, find, declared);
  plan.validity = find.optional(declared.validity, kValidity);
  plan.confidence = find.optional(declared.confidence, kConfidence);
  plan.pupil = find.optional(declared.pupil, kPupil);
  plan.eye = find.optional(declared.eye, kEye);
  plan_time_unit(plan, headings[plan.time], declared, place);
  plan_position_unit(plan, headings, declared, place);
  plan.origin = declared.origin;
  return plan;
}

}  // namespace gazetrace
