// SPDX-License-Identifier: Apache-2.0
#include "gaze/delimited.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "gaze/units.hpp"

namespace gazetrace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool is_missing(std::string_view text) {
  if (text.empty() || text == "." || text == "-") {
    return true;
  }
  const std::string lower = to_lower(text);
  for (const std::string_view marker : {"n/a", "na", "nan", "-nan", "-nan(ind)", "nan(ind)", "none", "null"}) {
    if (lower == marker) {
      return true;
    }
  }
  return false;
}

std::string place_of(const GazeFile& file, std::int64_t line) {
  return fmt::format("{}:{}", file.path, line);
}

char choose_separator(std::string_view header) {
  for (const char separator : {'\t', ';'}) {
    if (header.find(separator) != std::string_view::npos) {
      return separator;
    }
  }
  return ',';
}

// "# display_px 1920 1080", also with a colon or an equals sign after the key.
void read_preamble(std::string_view line, const std::string& place, DelimitedTable& table) {
  line.remove_prefix(std::min(line.find_first_not_of('#'), line.size()));
  line = trim(line);
  const std::size_t key_end = std::min(line.find_first_of(" \t:="), line.size());
  const std::string_view key = line.substr(0, key_end);
  std::string_view rest = line.substr(key_end);
  while (!rest.empty() && (rest.front() == ':' || rest.front() == '=' || rest.front() == ' ' || rest.front() == '\t')) {
    rest.remove_prefix(1);
  }
  std::vector<std::string_view> words;
  split_cells(rest, ' ', words);
  const auto numbers = [&](std::size_t count, bool positive) {
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = i < words.size() ? number_from(words[i]) : std::nullopt;
      if (!value || words.size() != count || (positive && !(*value > 0))) {
        throw Error(ErrorKind::input, place,
                    fmt::format("`# {}` needs {} {}, not '{}'", key, count,
                                positive ? (count == 1 ? "positive number" : "positive numbers") : "numbers", rest));
      }
      values[i] = *value;
    }
    return values;
  };
  const auto geometry = [&]() -> DisplayGeometry& {
    if (!table.geometry) {
      table.geometry.emplace();
    }
    return *table.geometry;
  };
  if (key == "gazetrace-gaze") {
    table.gazetrace_version = static_cast<int>(std::min(numbers(1, true)[0], 1e9));
  } else if (key == "clock") {
    table.clock = rest;
  } else if (key == "display_px") {
    const auto px = numbers(2, true);
    if (px[0] != std::floor(px[0]) || px[1] != std::floor(px[1]) || px[0] > 1e6 || px[1] > 1e6) {
      throw Error(ErrorKind::input, place, fmt::format("`# display_px` needs two whole numbers, not '{}'", rest));
    }
    geometry().width_px = static_cast<int>(px[0]);
    geometry().height_px = static_cast<int>(px[1]);
  } else if (key == "display_mm" || key == "display_cm") {
    const auto size = numbers(2, true);
    const double per_cm = key == "display_mm" ? 10.0 : 1.0;
    geometry().width_cm = size[0] / per_cm;
    geometry().height_cm = size[1] / per_cm;
  } else if (key == "distance_mm" || key == "distance_cm") {
    geometry().distance_cm = numbers(1, true)[0] / (key == "distance_mm" ? 10.0 : 1.0);
  } else if (key == "eye_cm") {
    const auto offset = numbers(2, false);
    geometry().eye_x_cm = offset[0];
    geometry().eye_y_cm = offset[1];
  }
}

bool is_number_row(const std::vector<std::string_view>& cells) {
  std::string buffer;
  bool any = false;
  for (const std::string_view cell : cells) {
    const std::string_view text = cell_text(cell, buffer);
    const bool number = number_from(text).has_value();
    if (!number && !is_missing(text)) {
      return false;
    }
    any = any || number;
  }
  return any;
}

// Only the first `count` cells are wanted; without quotes a cell ends at the next separator.
void split_row(std::string_view line, const DelimitedTable& table, std::size_t count,
               std::vector<std::string_view>& cells) {
  if (table.has_quotes) {
    split_cells(line, table.separator, cells);
    return;
  }
  cells.clear();
  const char* at = line.data();
  const char* const end = at + line.size();
  while (cells.size() < count) {
    const char* stop = at;
    while (stop != end && *stop != table.separator) {
      ++stop;
    }
    cells.emplace_back(at, static_cast<std::size_t>(stop - at));
    if (stop == end) {
      return;
    }
    at = stop + 1;
  }
}

bool is_row(std::string_view line) {
  const std::string_view text = trim(line);
  return !text.empty() && text.front() != '#';
}

class ValidityReader {
 public:
  ValidityReader(const std::vector<std::string>& valid_values, ValidityStyle style) : style_(style) {
    for (const std::string& value : valid_values) {
      wanted_.push_back(to_lower(trim(value)));
    }
    if (wanted_.empty()) {
      wanted_ = {"1", "true", "ok", "valid"};
    }
  }

  // Empty: the text is no validity.
  std::optional<GazeValidity> read(std::string_view text) {
    if (text != last_text_ || !has_last_) {  // mostly the same as in the row before
      last_text_ = text;
      has_last_ = true;
      last_ = interpret(last_text_);
    }
    return last_;
  }

  [[nodiscard]] const std::vector<std::string>& seen() const { return seen_; }

 private:
  std::optional<GazeValidity> interpret(const std::string& text) {
    if (seen_.size() < 6 && std::find(seen_.begin(), seen_.end(), text) == seen_.end()) {
      seen_.push_back(text);
    }
    const std::string lower = to_lower(text);
    const auto number = number_from(lower);
    for (const std::string& value : wanted_) {
      const auto wanted_number = number_from(value);
      if (lower == value || (number && wanted_number && *number == *wanted_number)) {
        return GazeValidity::ok;
      }
    }
    for (const GazeValidity validity : {GazeValidity::ok, GazeValidity::low_confidence, GazeValidity::blink,
                                        GazeValidity::lost, GazeValidity::off_screen, GazeValidity::interpolated}) {
      if (lower == to_string(validity)) {
        return validity;
      }
    }
    const bool understood = style_ == ValidityStyle::any || is_missing(lower) || lower == "0" || lower == "false";
    return understood ? std::optional(GazeValidity::lost) : std::nullopt;
  }

  ValidityStyle style_;
  std::vector<std::string> wanted_, seen_;
  std::string last_text_;
  bool has_last_ = false;
  std::optional<GazeValidity> last_;
};

std::optional<Eye> eye_from(std::string_view text) {
  const std::string lower = to_lower(text);
  if (lower == "left" || lower == "l") {
    return Eye::left;
  }
  if (lower == "right" || lower == "r") {
    return Eye::right;
  }
  for (const std::string_view both : {"cyclopean", "c", "both", "b", "mean", "combined", "average", "binocular"}) {
    if (lower == both) {
      return Eye::cyclopean;
    }
  }
  return std::nullopt;
}

// One row after another into samples; knows its place for messages.
class RowReader {
 public:
  RowReader(const GazeFile& file, const DelimitedTable& table, const ColumnPlan& plan, const GazeReadOptions& options,
            ValidityStyle style, int time_exponent)
      : file_(file),
        table_(table),
        plan_(plan),
        style_(style),
        validity_(options.columns.valid_values, style),
        time_exponent_(time_exponent) {
    for (const auto column : {std::optional(plan.time), std::optional(plan.x), std::optional(plan.y), plan.z,
                              plan.validity, plan.confidence, plan.pupil, plan.eye}) {
      needed_ = std::max(needed_, column ? *column + 1 : 0);
    }
  }

  void read_all(std::vector<GazeSample>& samples) {
    LineReader lines(table_.body);
    for (std::string_view line; lines.next(line);) {
      if (!is_row(line)) {
        continue;
      }
      line_ = table_.lines_above + lines.number();
      if (line == table_.header && table_.has_header) {
        ++repeated_headers;
        continue;
      }
      samples.push_back(read_row(line));
    }
  }

  [[nodiscard]] const ValidityReader& validity() const { return validity_; }
  std::size_t repeated_headers = 0;
  std::size_t zero_pairs = 0;  // exactly (0, 0) without a word on their validity
  std::size_t not_unit = 0;    // directions more than 1 % from unit length

 private:
  [[noreturn]] void fail(const std::string& problem, std::string_view remedy) const {
    throw Error(ErrorKind::input, place_of(file_, line_), problem, remedy);
  }

  std::string_view cell(std::size_t column) { return cell_text(cells_[column], buffer_); }

  double number(std::size_t column) {
    const std::string_view text = cell(column);
    if (const auto value = number_from(text)) {
      return *value;
    }
    const std::string lower = to_lower(text);
    if (!is_missing(text) && lower != "inf" && lower != "-inf") {
      fail(fmt::format("'{}' in column '{}' is not a number", text, table_.headings[column].text),
           "write missing values as an empty cell or n/a");
    }
    return kNan;
  }

  std::int64_t time() {
    const std::string_view text = cell(plan_.time);
    std::int64_t t_ns = 0;
    switch (scaled_integer(text, time_exponent_, t_ns)) {
      case NumberStatus::ok:
        return t_ns;
      case NumberStatus::overflow:
        fail(fmt::format("time '{}' in {} does not fit int64 nanoseconds", text, time_unit_text(time_exponent_)),
             "check the unit of the time column");
      case NumberStatus::malformed:
        break;
    }
    if (is_missing(text)) {
      fail("this row has no time", "remove the row, or give it a time");
    }
    fail(fmt::format("time '{}' is not a number", text), "remove or mend the row");
  }

  GazeSample read_row(std::string_view line) {
    split_row(line, table_, needed_, cells_);
    if (cells_.size() < needed_) {
      fail(fmt::format("the row has {} of the {} cells that reach to column '{}'", cells_.size(), needed_,
                       table_.headings[needed_ - 1].text),
           "it is short or cut off; remove or mend it");
    }
    GazeSample sample;
    sample.row = line_;
    sample.t_ns = time();
    sample.confidence = static_cast<float>(plan_.confidence ? number(*plan_.confidence) : kNan);
    sample.pupil = static_cast<float>(plan_.pupil ? number(*plan_.pupil) : kNan);
    if (plan_.eye) {
      const std::string_view text = cell(*plan_.eye);
      const auto eye = eye_from(text);
      if (!eye) {
        fail(fmt::format("eye '{}' is not left, right or cyclopean", text), "mend the row, or leave the column out");
      }
      sample.eye = *eye;
    }
    if (plan_.validity) {
      const std::string_view text = cell(*plan_.validity);
      const auto validity = validity_.read(text);
      if (!validity) {
        fail(unknown_name_message("validity", text,
                                  {"ok", "low_confidence", "blink", "lost", "off_screen", "interpolated"}),
             "");
      }
      sample.validity = *validity;
    }
    read_position(sample);
    return sample;
  }

  void read_position(GazeSample& sample) {
    const double x = number(plan_.x);
    const double y = number(plan_.y);
    const double z = plan_.kind == GazeKind::direction ? number(*plan_.z) : 0.0;
    // Loggers write what they do not know as zeros: (0, 0) without validity is missing, not the corner.
    const bool said_bad = !is_usable(sample.validity) || sample.confidence == 0.0F;
    const bool zero = x == 0 && y == 0 && z == 0;
    const bool missing = std::isnan(x) || std::isnan(y) || std::isnan(z) ||
                         (zero && ((said_bad && style_ == ValidityStyle::any) || plan_.kind == GazeKind::direction));
    if (missing && is_usable(sample.validity)) {
      sample.validity = GazeValidity::lost;
    }
    zero_pairs += zero && !missing && !plan_.validity ? 1 : 0;
    if (plan_.kind == GazeKind::screen) {
      sample.u = missing ? kNan : x;
      sample.v = missing ? kNan : y;
      return;
    }
    sample.direction = missing ? Vec3d{kNan, kNan, kNan} : Vec3d{x, y, z};
    const double norm = length(sample.direction);
    // A unit vector that was written with all its digits stays as it is, bit by bit.
    if (!missing && std::abs(norm - 1.0) > 1e-14) {
      not_unit += std::abs(norm - 1.0) > 0.01 ? 1 : 0;
      sample.direction = sample.direction / norm;
    }
  }

  const GazeFile& file_;
  const DelimitedTable& table_;
  const ColumnPlan& plan_;
  ValidityStyle style_;
  ValidityReader validity_;
  int time_exponent_;
  std::size_t needed_ = 0;
  std::int64_t line_ = 0;
  std::vector<std::string_view> cells_;
  std::string buffer_;
};

int time_exponent_by_statistics(const GazeFile& file, const DelimitedTable& table, std::size_t column,
                                Warnings& warnings) {
  const std::string place = place_of(file, table.header_line);
  std::vector<double> times;
  std::vector<std::string_view> cells;
  std::string buffer;
  LineReader lines(table.body);
  for (std::string_view line; times.size() < 2000 && lines.next(line);) {
    split_row(line, table, column + 1, cells);
    if (is_row(line) && cells.size() > column) {
      if (const auto value = number_from(cell_text(cells[column], buffer))) {
        times.push_back(*value);
      }
    }
  }
  const auto exponent = guess_time_exponent(times);
  if (!exponent) {
    throw Error(ErrorKind::input, place,
                fmt::format("the unit of time column '{}' is not stated and cannot be guessed from its steps",
                            table.headings[column].text),
                "give --gaze-time-unit, or write it into the header: t[ms]");
  }
  warnings.push_back(fmt::format("{}: guessed from its steps that '{}' is in {}; state it with --gaze-time-unit", place,
                                 table.headings[column].text, time_unit_text(*exponent)));
  return *exponent;
}

void mark_off_screen(std::vector<GazeSample>& samples) {
  for (GazeSample& sample : samples) {
    const bool inside = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
    if (sample.validity == GazeValidity::ok && !inside) {
      sample.validity = GazeValidity::off_screen;
    }
  }
}

std::optional<DisplayGeometry> conversion_display(const DelimitedTable& table, const GazeReadOptions& options,
                                                  const std::string& place, Warnings& warnings) {
  if (!options.display) {
    return table.geometry;
  }
  const DisplayGeometry& given = *options.display;
  DisplayGeometry merged = given;
  if (table.geometry) {
    const DisplayGeometry& stated = *table.geometry;
    if (stated.width_px > 0 && given.width_px > 0 &&
        (stated.width_px != given.width_px || stated.height_px != given.height_px)) {
      warnings.push_back(fmt::format("{}: the log states a display of {}x{} px; the given {}x{} px are used", place,
                                     stated.width_px, stated.height_px, given.width_px, given.height_px));
    }
    if (merged.width_px <= 0 || merged.height_px <= 0) {
      merged.width_px = stated.width_px;
      merged.height_px = stated.height_px;
    }
    if (!(merged.width_cm > 0) || !(merged.height_cm > 0)) {
      merged.width_cm = stated.width_cm;
      merged.height_cm = stated.height_cm;
    }
    merged.distance_cm = merged.distance_cm > 0 ? merged.distance_cm : stated.distance_cm;
  }
  return merged;
}

void finish_positions(GazeLog& log, const ColumnPlan& plan, const GazeFile& file, const DelimitedTable& table,
                      const GazeReadOptions& options, ValidityStyle style) {
  const std::string place = place_of(file, table.header_line);
  PositionUnit unit = plan.unit;
  if (unit == PositionUnit::automatic) {
    std::string evidence;
    unit = guess_position_unit(log.samples, evidence);
    log.warnings.push_back(
        fmt::format("{}: guessed from its values ({}) that the positions are in {}; state it with "
                    "--gaze-unit",
                    place, evidence, to_string(unit)));
  }
  const auto display = conversion_display(table, options, place, log.warnings);
  // Fractions of gazetrace CSV count from the top left by definition.
  const bool defined = style == ValidityStyle::names && unit == PositionUnit::fraction;
  const PositionOrigin origin =
      defined && plan.origin == PositionOrigin::automatic ? PositionOrigin::top_left : plan.origin;
  convert_positions(log, unit, origin, unit == PositionUnit::fraction ? std::nullopt : display, place);
  // A log that names the state of each sample has said so itself.
  if (style == ValidityStyle::any || !plan.validity) {
    mark_off_screen(log.samples);
  }
}

void add_row_warnings(GazeLog& log, const RowReader& rows, const ColumnPlan& plan, const DelimitedTable& table) {
  const std::size_t count = log.samples.size();
  if (rows.repeated_headers > 0) {
    log.warnings.push_back(
        fmt::format("{}: the header is repeated {} times; skipped", log.source, rows.repeated_headers));
  }
  if (rows.zero_pairs * 20 > count) {
    log.warnings.push_back(
        fmt::format("{}: {} of {} positions are exactly (0, 0): missing values written as zero? Name a validity column",
                    log.source, rows.zero_pairs, count));
  }
  if (rows.not_unit > 0) {
    log.warnings.push_back(
        fmt::format("{}: {} of {} directions were not of unit length; normalized", log.source, rows.not_unit, count));
  }
  const auto is_good = [](const GazeSample& s) { return s.validity != GazeValidity::lost; };
  if (plan.validity && std::none_of(log.samples.begin(), log.samples.end(), is_good)) {
    log.warnings.push_back(
        fmt::format("{}: no row is valid by column '{}', which holds: {}; say with "
                    "--gaze-valid-values which of them are good",
                    log.source, table.headings[*plan.validity].text, fmt::join(rows.validity().seen(), ", ")));
  }
  if (log.kind == GazeKind::direction) {
    const auto backwards = std::count_if(log.samples.begin(), log.samples.end(), [](const GazeSample& s) {
      return is_usable(s.validity) && s.direction.z > 0;
    });
    if (static_cast<std::size_t>(backwards) * 2 > count) {
      log.warnings.push_back(
          fmt::format("{}: {} of {} directions point backwards (+z): forward is -z here, with +x right and +y up",
                      log.source, backwards, count));
    }
  }
}

}  // namespace

DelimitedTable open_table(const GazeFile& file) {
  DelimitedTable table;
  table.has_quotes = file.text.find('"') != std::string::npos;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty()) {
      continue;
    }
    if (text.front() == '#') {
      read_preamble(text, place_of(file, lines.number()), table);
      continue;
    }
    table.separator = choose_separator(line);
    std::vector<std::string_view> cells;
    split_cells(line, table.separator, cells);
    table.has_header = !is_number_row(cells);
    table.header = line;
    table.header_line = lines.number();
    while (cells.size() > 1 && trim(cells.back()).empty()) {
      cells.pop_back();  // trailing separators
    }
    for (const std::string_view cell : cells) {
      table.headings.push_back(table.has_header ? parse_heading(cell) : ColumnHeading{});
      if (!table.has_header) {
        table.headings.back().text = table.headings.back().name = std::to_string(table.headings.size());
      }
    }
    const char* const body = table.has_header ? lines.rest().data() : line.data();
    table.body = std::string_view(body, static_cast<std::size_t>(file.text.data() + file.text.size() - body));
    table.lines_above = table.has_header ? lines.number() : lines.number() - 1;
    break;
  }
  return table;
}

GazeLog read_table(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                   ValidityStyle style) {
  if (table.headings.empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample",
                "a gaze log needs a header and at least one row below it");
  }
  const std::string place = place_of(file, table.header_line);
  if (table.headings.size() < 3) {
    throw Error(ErrorKind::input, place,
                fmt::format("'{}' is not a table of time and position", trim(table.header).substr(0, 60)),
                "separate the cells by commas, semicolons or tabs");
  }
  const GazeColumns& declared = options.columns;
  if (!table.has_header && (declared.time.empty() || declared.x.empty() || declared.y.empty())) {
    throw Error(ErrorKind::input, place,
                fmt::format("there is no header, only {} columns of numbers", table.headings.size()),
                "say by number which is which: --gaze-time-column 1 --gaze-x-column 2 --gaze-y-column 3");
  }
  const ColumnPlan plan = plan_columns(table.headings, declared, place);
  GazeLog log;
  log.source = file.path;
  log.kind = plan.kind;
  log.clock = table.clock;
  log.recording_geometry = table.geometry;
  log.warnings = plan.warnings;
  if (trim(table.body).empty()) {
    throw Error(ErrorKind::input, file.path, "holds no sample", "a gaze log needs at least one row below its header");
  }
  const int exponent =
      plan.time_exponent ? *plan.time_exponent : time_exponent_by_statistics(file, table, plan.time, log.warnings);
  log.samples.reserve(static_cast<std::size_t>(std::count(table.body.begin(), table.body.end(), '\n')) + 1);
  RowReader rows(file, table, plan, options, style, exponent);
  rows.read_all(log.samples);
  if (log.kind == GazeKind::screen) {
    finish_positions(log, plan, file, table, options, style);
  }
  add_row_warnings(log, rows, plan, table);
  return log;
}

}  // namespace gazetrace
