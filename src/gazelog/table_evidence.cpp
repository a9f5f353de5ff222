// SPDX-License-Identifier: Apache-2.0
#include "gazelog/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kRowsLookedAt = 2000;

// A row that is not broken, for a look at a file before it is read: what is wrong with it is told when it is read.
double value_of(TableRows& rows, std::size_t column) {
  return number_from(rows.cell(column)).value_or(kNan);
}

}  // namespace

GazeColumns with_z_beside(const GazeFile& file, const DelimitedTable& table, const GazeColumns& columns) {
  const bool says_places =
      columns.position_unit != PositionUnit::automatic && columns.position_unit != PositionUnit::unit_vector;
  if (says_places || !columns.z.empty() || !columns.left.x.empty() || !columns.right.x.empty()) {
    return columns;
  }
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    std::string name = table.headings[i].text;
    const bool is_x = !name.empty() && (name.back() == 'x' || name.back() == 'X') && table.headings[i].unit.empty();
    if (!is_x || (!columns.x.empty() && columns.x != name) || to_lower(name).find("gaze") == std::string::npos) {
      continue;
    }
    const auto sibling = [&](char step) {
      std::string other = name;
      other.back() = static_cast<char>(other.back() + step);
      return table.find(other);
    };
    const auto y = sibling(1);
    const auto z = sibling(2);
    if (!y || !z) {
      continue;
    }
    std::size_t count = 0;
    std::size_t unit_length = 0;
    TableRows rows(file, table, table.headings.size());
    for (std::size_t row = 0; row < kRowsLookedAt && rows.next(); ++row) {
      const double length = std::hypot(value_of(rows, i), value_of(rows, *y), value_of(rows, *z));
      count += std::isfinite(length) && length > 0 ? 1 : 0;
      unit_length += std::abs(length - 1) < 0.12 ? 1 : 0;  // numbers may have but one decimal
    }
    if (count >= 10 && unit_length * 20 >= count * 19) {
      GazeColumns with_z = columns;
      with_z.x = name;
      with_z.y = table.headings[*y].text;
      with_z.z = table.headings[*z].text;
      return with_z;
    }
  }
  return columns;
}

void find_sum_of_eyes(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan, RawGaze& raw) {
  const std::size_t x = plan.sources.front().x;
  const std::string& name = table.headings[x].text;
  const auto of_eye = [&](const char* side) {
    for (const std::string& other : {name + side, side + name, fmt::format("{}_{}", side, name)}) {
      if (const auto column = table.find(other)) {
        return column;
      }
    }
    return OptionalColumn();
  };
  const auto left = of_eye("Left");
  const auto right = of_eye("Right");
  if (!left || !right) {
    return;
  }
  std::size_t count = 0;
  std::size_t sums = 0;
  TableRows rows(file, table, table.headings.size());
  for (std::size_t row = 0; row < kRowsLookedAt && rows.next(); ++row) {
    const double l = value_of(rows, *left);
    const double r = value_of(rows, *right);
    const double both = value_of(rows, x);
    const double tolerance = 0.01 * std::abs(l + r);
    if (std::isfinite(l + r + both) && tolerance > 0) {
      ++count;
      sums += std::abs(both - (l + r)) < tolerance ? 1 : 0;
    }
  }
  if (count < 10 || sums * 10 < count * 9) {
    return;
  }
  const std::string y = table.headings[plan.sources.front().y].text;
  const std::string setting = fmt::format("`x-column` {} `y-column` {}", table.headings[*left].text,
                                          y + table.headings[*left].text.substr(name.size()));
  const std::string problem = fmt::format("'{}' is the sum of '{}' and '{}', not their mean, in {} of {} rows", name,
                                          table.headings[*left].text, table.headings[*right].text, sums, count);
  raw.faults.push_back(
      {"sum-of-eyes", table.place, problem, "take the columns of one eye: " + setting, setting, problem});
}

void find_other_things(const DelimitedTable& table, const ColumnPlan& plan, RawGaze& raw) {
  const std::string& x = table.headings[plan.sources.front().x].text;
  const std::string& y = table.headings[plan.sources.front().y].text;
  const std::string name = letters_and_digits(table.headings[plan.sources.front().x].name);
  const auto names = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  if (plan.kind != GazeKind::screen || plan.sources.size() > 1 || names("gaze") || names("eye") || names("por")) {
    return;
  }
  std::string beside = name;
  const bool turns = name == "yaw" || name == "azimuth";
  if (turns) {
    beside = "roll";
  } else if (const std::size_t at = beside.rfind('x'); at != std::string::npos) {
    beside[at] = 'z';
  }
  const auto third = beside == name ? std::nullopt : table.find(beside);
  if (third) {
    const std::string problem =
        fmt::format("'{}' and '{}' stand beside '{}': {}", x, y, table.headings[*third].text,
                    turns ? "so the head's rotation is written, and an eye does not roll"
                          : "three numbers are a place in space or a direction, and no place on a display");
    raw.faults.push_back({"look-alike", table.place, problem,
                          "name the columns of gaze with `x-column` and `y-column`, with `z-column` if they are "
                          "directions",
                          "`x-column` and `y-column`", problem});
  }
}

std::string sign_of_scene_camera(const DelimitedTable& table, const ColumnPlan& plan) {
  const ColumnHeading& x = table.headings[plan.sources.front().x];
  const std::string name = letters_and_digits(x.text);
  for (const std::string_view word : {"normpos", "scenecam", "worldcam", "fieldcam", "fielddata", "scenex"}) {
    if (plan.kind == GazeKind::screen && name.find(word) != std::string::npos) {
      return x.text;
    }
  }
  // Pupil Labs' glasses say whether they are worn.
  const auto worn = plan.kind == GazeKind::screen && plan.unit != PositionUnit::deg ? table.find("worn") : std::nullopt;
  return worn ? table.headings[*worn].text : "";
}

PositionOrigin origin_in_column(const GazeFile& file, const DelimitedTable& table, RawGaze& raw) {
  const auto column = table.find_any({"coordinate_system", "coordinate_origin", "screen_origin", "origin"});
  TableRows rows(file, table, table.headings.size());
  if (!column || !rows.next()) {
    return PositionOrigin::automatic;
  }
  const std::string text(rows.cell(*column));
  const std::string word = letters_and_digits(text);
  const auto says = [&](std::string_view part) { return word.find(part) != std::string::npos; };
  add_note(raw, "coordinates", text.substr(0, 40), Evidence::header, table.headings[*column].text);
  return says("bottom") || says("lowerleft") ? PositionOrigin::bottom_left
         : says("cent")                      ? PositionOrigin::center
         : says("top") || says("upperleft")  ? PositionOrigin::top_left
                                             : PositionOrigin::automatic;
}

std::string_view text_of_message(TableRows& rows, std::size_t& time) {
  constexpr std::size_t kMostCells = 40;
  if (to_lower(rows.cell(std::size_t{0})) == "msg" && !rows.cell(time + 2).empty()) {
    ++time;  // everything stands one column further on
    return rows.cell(time + 1);
  }
  std::size_t text = kMostCells;
  for (std::size_t i = 0; i < kMostCells; ++i) {
    const std::string_view cell = rows.cell(i);
    if (i == time || cell.empty()) {
      continue;
    }
    if (text != kMostCells || number_from(cell)) {
      return "";
    }
    text = i;
  }
  return text == kMostCells ? "" : rows.cell(text);
}

OtherSensors::OtherSensors(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan) {
  column_ = table.find_any({"EventSource", "Sensor", "Sensor name", "Source"});
  if (!column_) {
    return;
  }
  name_ = table.headings[*column_].text;
  std::vector<std::string> with_gaze;
  TableRows rows(file, table, std::max(plan.needed_cells(table), *column_ + 1));
  while (rows.next()) {
    const bool has_gaze = std::any_of(plan.sources.begin(), plan.sources.end(), [&](const GazeSource& source) {
      return !is_missing(rows.cell(source.x)) || !is_missing(rows.cell(source.y));
    });
    std::vector<std::string>& values = has_gaze ? with_gaze : others_;
    const std::string_view value = rows.cell(*column_);
    constexpr std::size_t kMostSensors = 64;
    if (std::find(values.begin(), values.end(), value) == values.end() && values.size() < kMostSensors) {
      values.emplace_back(value);
    }
  }
  std::erase_if(others_, [&](const std::string& value) {
    return std::find(with_gaze.begin(), with_gaze.end(), value) != with_gaze.end();
  });
}

bool OtherSensors::is_other(TableRows& rows) {
  if (others_.empty() || std::find(others_.begin(), others_.end(), rows.cell(*column_)) == others_.end()) {
    return false;
  }
  ++left_out;
  return true;
}

void ValidityTally::add(std::string_view text, const RawSample& sample) {
  constexpr std::size_t kMostValues = 8;
  if (last_ >= values_.size() || values_[last_].text != text) {
    const auto found = std::find_if(values_.begin(), values_.end(), [&](const Value& v) { return v.text == text; });
    last_ = static_cast<std::size_t>(found - values_.begin());
    if (found == values_.end()) {
      if (values_.size() == kMostValues) {
        return;
      }
      values_.push_back({std::string(text), is_usable(sample.validity)});
    }
  }
  Value& value = values_[last_];
  value.is_good = value.is_good || is_usable(sample.validity);
  ++value.rows;
  value.with_place += std::isfinite(sample.at.x) && !(sample.at.x == 0 && sample.at.y == 0) ? 1 : 0;
}

const ValidityTally::Value* ValidityTally::value_with_places(bool is_good) const {
  const Value* most = nullptr;
  for (const Value& value : values_) {
    if (value.is_good == is_good && value.rows >= 10 && value.with_place * 5 >= value.rows * 4 &&
        (most == nullptr || value.rows > most->rows)) {
      most = &value;
    }
  }
  return most;
}

std::string ValidityTally::reversed() const {
  const Value* const lost = value_with_places(false);
  return lost != nullptr && value_with_places(true) == nullptr && !lost->text.empty() ? lost->text : "";
}

std::string ValidityTally::in_words(const std::string& column) const {
  std::string text = fmt::format("column '{}' seems to be read the wrong way round: ", column);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const Value& value = values_[i];
    text += fmt::format("{}{} of {} rows with '{}', which counts as {}, have a place", i == 0 ? "" : ", ",
                        value.with_place, value.rows, value.text, value.is_good ? "good" : "lost");
  }
  return text;
}

}  // namespace gazetrace
