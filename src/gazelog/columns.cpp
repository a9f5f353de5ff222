// SPDX-License-Identifier: Apache-2.0
#include "gazelog/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/text.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

using RoleNames = std::span<const std::string_view>;

// The eye that a column's name tells: "LGazePos2dx", "left_x", "gaze x right", "ry". Of the words of a name, which a
// capital letter begins as well, one is L, R, left or right.
std::optional<Eye> eye_of_name(std::string_view name) {
  const std::string lower = to_lower(name);
  if (lower == "lx" || lower == "ly" || lower == "rx" || lower == "ry") {
    return lower.front() == 'l' ? Eye::left : Eye::right;
  }
  const auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto is_small = [](char c) { return c >= 'a' && c <= 'z'; };
  std::string word;
  std::optional<Eye> eye;
  const auto end_word = [&] {
    std::string w = to_lower(word);
    if (w.size() > 4 && (w.back() == 'x' || w.back() == 'y')) {
      w.pop_back();  // "Leftx"
    }
    eye = w == "l" || w == "left" ? Eye::left : w == "r" || w == "right" ? Eye::right : eye;
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool begins =
        is_capital(c) && i > 0 && (is_small(name[i - 1]) || (i + 1 < name.size() && is_small(name[i + 1])));
    if (begins || !(is_capital(c) || is_small(c))) {
      end_word();
    }
    word += is_capital(c) || is_small(c) ? std::string(1, c) : "";
  }
  end_word();
  return eye;
}

// In small letters, without what says the eye or the tracker.
std::string name_without_eye(std::string_view name) {
  std::string core = letters_and_digits(name);
  bool says_side = false;
  for (const std::string_view word : {"left", "right", "eye"}) {
    if (const std::size_t at = core.find(word); at != std::string::npos) {
      core.erase(at, word.size());
      says_side = says_side || word != "eye";
    }
  }
  if (!says_side && core.size() > 1) {
    core.erase(0, 1);  // "L_GazeX"
  }
  return core.starts_with("et") ? core.substr(2) : core;
}

class Finder {
 public:
  explicit Finder(const DelimitedTable& table) : table_(table) {}

  [[nodiscard]] OptionalColumn by_role(RoleNames names) const {
    for (const std::string_view name : names) {
      for (std::size_t i = 0; i < table_.headings.size(); ++i) {
        if (letters_and_digits(table_.headings[i].name) == name) {
          table_.check_unique(i);
          return i;
        }
      }
    }
    return std::nullopt;
  }

  // "left_gaze_x", "ET_GazeLeftx", "GazePointXLeft": a name with the eye in it.
  [[nodiscard]] OptionalColumn by_role_of_eye(RoleNames names, Eye eye) const {
    for (std::size_t i = 0; i < table_.headings.size(); ++i) {
      if (eye_of_name(table_.headings[i].name) != eye) {
        continue;
      }
      const std::string core = name_without_eye(table_.headings[i].name);
      if (std::find(names.begin(), names.end(), core) != names.end()) {
        return i;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] OptionalColumn optional(const std::string& name, RoleNames names = {}) const {
    return name.empty() ? by_role(names) : std::optional(declared_column(table_, name));
  }

  [[nodiscard]] std::size_t required(const std::string& name, RoleNames names, std::string_view what,
                                     std::string_view option) const {
    if (const auto found = optional(name, names)) {
      return *found;
    }
    missing_.push_back({std::string(what), std::string(option)});
    return 0;
  }
  [[nodiscard]] const ColumnHeading& heading(std::size_t column) const { return table_.headings[column]; }
  // All that were not found, in one message.
  void refuse_missing() const {
    if (missing_.empty()) {
      return;
    }
    std::string what;
    std::string options;
    for (std::size_t i = 0; i < missing_.size(); ++i) {
      const std::string_view joint = i == 0 ? "" : i + 1 == missing_.size() ? " and " : ", ";
      what += fmt::format("{}{}", joint, missing_[i].what);
      options += fmt::format("{}{}", joint, missing_[i].option);
    }
    const bool is_one = missing_.size() == 1;
    throw Error(ErrorKind::input, table_.place,
                fmt::format("no {} for {} {} found; the columns are: {}", is_one ? "column" : "columns", what,
                            is_one ? "is" : "are", column_listing(table_)),
                fmt::format("name {} with {}", is_one ? "it" : "them", options));
  }

 private:
  struct Missing {
    std::string what, option;
  };

  const DelimitedTable& table_;
  mutable std::vector<Missing> missing_;
};

using std::string_view_literals::operator""sv;
constexpr std::array kTime{
    "t"sv, "time"sv, "timestamp"sv, "recordingtimestamp"sv, "gazetimestamp"sv, "trackingtimestamp"sv};
constexpr std::array kValidity{"valid"sv, "validity"sv, "isvalid"sv, "status"sv, "trackingstatus"sv};
constexpr std::array kConfidence{"confidence"sv, "conf"sv};
constexpr std::array kPupil{"pupil"sv, "pupilsize"sv, "pupildiameter"sv, "pupilmeasure1"sv};
constexpr std::array kEye{"eye"sv, "recordedeye"sv};
constexpr std::array kDirectionX{"dx"sv,       "dirx"sv,         "directionx"sv, "gazedirectionx"sv,
                                 "gazedirx"sv, "gazeforwardx"sv, "forwardx"sv,   "gazevectorx"sv};
constexpr std::array kDirectionY{"dy"sv,       "diry"sv,         "directiony"sv, "gazedirectiony"sv,
                                 "gazediry"sv, "gazeforwardy"sv, "forwardy"sv,   "gazevectory"sv};
constexpr std::array kDirectionZ{"dz"sv,       "dirz"sv,         "directionz"sv, "gazedirectionz"sv,
                                 "gazedirz"sv, "gazeforwardz"sv, "forwardz"sv,   "gazevectorz"sv};
constexpr std::array kOriginX{"ox"sv};
constexpr std::array kOriginY{"oy"sv};
constexpr std::array kOriginZ{"oz"sv};
constexpr std::array kScreenX{"u"sv,    "x"sv,    "gazex"sv, "xcoordinate"sv, "gazepointx"sv, "gazeposx"sv,
                              "porx"sv, "posx"sv, "xpos"sv,  "yaw"sv,         "azimuth"sv};
constexpr std::array kScreenY{"v"sv,    "y"sv,    "gazey"sv, "ycoordinate"sv, "gazepointy"sv, "gazeposy"sv,
                              "pory"sv, "posy"sv, "ypos"sv,  "pitch"sv,       "elevation"sv};

bool is_declared(const EyeColumns& eye) {
  return !eye.x.empty() || !eye.y.empty();
}

GazeSource eye_source(const Finder& find, const EyeColumns& declared, Eye eye) {
  GazeSource source;
  source.eye = eye;
  const std::string side(to_string(eye));
  source.x = find.required(declared.x, {}, side + " x", side + ".x of the column map");
  source.y = find.required(declared.y, {}, side + " y", side + ".y of the column map");
  source.z = find.optional(declared.z);
  source.validity = find.optional(declared.validity);
  source.confidence = find.optional(declared.confidence);
  source.pupil = find.optional(declared.pupil);
  source.openness = find.optional(declared.openness);
  source.origin = {find.optional(declared.origin_x), find.optional(declared.origin_y),
                   find.optional(declared.origin_z)};
  return source;
}

Eye eye_of_names(const ColumnHeading& x, const ColumnHeading& y) {
  const std::optional<Eye> eye = eye_of_name(x.name);
  return eye && eye == eye_of_name(y.name) ? *eye : Eye::cyclopean;
}

// The columns of each eye, where a table names its eyes alone.
bool plan_eyes(ColumnPlan& plan, const Finder& find, const GazeColumns& declared) {
  for (const Eye eye : {Eye::left, Eye::right}) {
    GazeSource source;
    source.eye = eye;
    OptionalColumn x = find.by_role_of_eye(kDirectionX, eye);
    OptionalColumn y = find.by_role_of_eye(kDirectionY, eye);
    source.z = find.by_role_of_eye(kDirectionZ, eye);
    const bool is_direction = x && y && source.z;
    if (!is_direction) {
      x = find.by_role_of_eye(kScreenX, eye);
      y = find.by_role_of_eye(kScreenY, eye);
      y = y ? y : find.by_role(kScreenY);  // eyes may share their elevation
      source.z = std::nullopt;
    }
    const GazeKind kind = is_direction ? GazeKind::direction : GazeKind::screen;
    if (!x || !y || (!plan.sources.empty() && kind != plan.kind)) {
      continue;
    }
    source.x = *x;
    source.y = *y;
    source.validity =
        declared.validity.empty() ? find.by_role_of_eye(kValidity, eye) : find.optional(declared.validity);
    source.pupil = declared.pupil.empty() ? find.by_role_of_eye(kPupil, eye) : find.optional(declared.pupil);
    plan.kind = kind;
    plan.sources.push_back(source);
  }
  return !plan.sources.empty();
}

void plan_positions(ColumnPlan& plan, const Finder& find, const GazeColumns& declared) {
  const bool by_eye = is_declared(declared.left) || is_declared(declared.right);
  if (by_eye) {
    for (const auto& [columns, eye] : {std::pair(&declared.left, Eye::left), std::pair(&declared.right, Eye::right)}) {
      if (is_declared(*columns)) {
        plan.sources.push_back(eye_source(find, *columns, eye));
        plan.kind = plan.sources.back().z ? GazeKind::direction : GazeKind::screen;
      }
    }
  }
  if (by_eye && declared.x.empty()) {
    return;
  }
  const bool is_named = !declared.x.empty() || !declared.y.empty();
  const auto is_combined = [&] {
    return (find.by_role(kScreenX) && find.by_role(kScreenY)) || find.by_role(kDirectionX);
  };
  if (!is_named && !is_combined() && plan_eyes(plan, find, declared)) {
    return;
  }
  GazeSource source;
  const bool directions_named = find.by_role(kDirectionX) && find.by_role(kDirectionY) && find.by_role(kDirectionZ);
  const bool is_direction = !declared.z.empty() || declared.position_unit == PositionUnit::unit_vector ||
                            (directions_named && declared.x.empty() && declared.y.empty());
  if (is_direction) {
    plan.kind = GazeKind::direction;
    source.x = find.required(declared.x, kDirectionX, "direction x", "`x-column`");
    source.y = find.required(declared.y, kDirectionY, "direction y", "`y-column`");
    source.z = find.required(declared.z, kDirectionZ, "direction z", "`z-column`");
  } else {
    source.x = find.required(declared.x, kScreenX, "the horizontal position", "`x-column`");
    source.y = find.required(declared.y, kScreenY, "the vertical position", "`y-column`");
  }
  source.validity = find.optional(declared.validity, kValidity);
  source.confidence = find.optional(declared.confidence, kConfidence);
  source.pupil = find.optional(declared.pupil, kPupil);
  source.origin = {find.by_role(kOriginX), find.by_role(kOriginY), find.by_role(kOriginZ)};
  source.eye = eye_of_names(find.heading(source.x), find.heading(source.y));
  plan.sources.insert(plan.sources.begin(), source);
}

void plan_head(ColumnPlan& plan, const Finder& find, const GazeColumns& declared) {
  plan.head_position = {find.optional(declared.head_x), find.optional(declared.head_y), find.optional(declared.head_z)};
  plan.head_rotation = {find.optional(declared.head_rotation_x), find.optional(declared.head_rotation_y),
                        find.optional(declared.head_rotation_z)};
  plan.head_w = find.optional(declared.head_rotation_w);
}

void plan_time_unit(ColumnPlan& plan, const DelimitedTable& table, const GazeColumns& declared) {
  const ColumnHeading& heading = table.headings[plan.time];
  if (!heading.unit.empty()) {
    plan.time_exponent = time_exponent(heading.unit);
  }
  const auto flag = time_exponent_of(declared.time_unit);
  if (flag && plan.time_exponent && *flag != *plan.time_exponent) {
    plan.warnings.push_back(fmt::format("{}: the header says that '{}' is in {}; `time-unit` {} was given and is used",
                                        table.place, heading.text, time_unit_text(*plan.time_exponent),
                                        time_unit_text(*flag)));
  }
  if (flag) {
    plan.time_exponent = flag;
  } else if (!heading.unit.empty() && !plan.time_exponent) {
    throw Error(ErrorKind::input, table.place,
                fmt::format("unknown unit '{}' of time column '{}'", heading.unit, heading.text),
                "use [s], [ms], [us] or [ns], or give `time-unit`");
  }
}

PositionUnit unit_of(const ColumnHeading& heading, const GazeColumns& declared, const std::string& place) {
  if (heading.unit.empty()) {
    // u and v always mean fractions; other names tell nothing about the unit.
    return heading.name == "u" || heading.name == "v" ? PositionUnit::fraction : PositionUnit::automatic;
  }
  const auto unit = position_unit_from(heading.unit);
  if (!unit && declared.position_unit == PositionUnit::automatic) {
    throw Error(ErrorKind::input, place, fmt::format("unknown unit '{}' of column '{}'", heading.unit, heading.text),
                "use [1], [px], [mm], [cm] or [deg], or give `unit`");
  }
  return unit.value_or(PositionUnit::automatic);
}

void plan_position_unit(ColumnPlan& plan, const DelimitedTable& table, const GazeColumns& declared) {
  const std::string& place = table.place;
  const PositionUnit flag = declared.position_unit;
  const ColumnHeading& x_heading = table.headings[plan.sources.front().x];
  const ColumnHeading& y_heading = table.headings[plan.sources.front().y];
  if (plan.kind == GazeKind::direction) {
    if (flag != PositionUnit::automatic && flag != PositionUnit::unit_vector) {
      throw Error(ErrorKind::usage, place, fmt::format("directions of three columns cannot be in {}", to_string(flag)),
                  "leave `unit` out, or name two columns");
    }
    plan.unit = PositionUnit::unit_vector;
    return;
  }
  const PositionUnit x = unit_of(x_heading, declared, place);
  const PositionUnit y = unit_of(y_heading, declared, place);
  if (x != y && flag == PositionUnit::automatic) {
    throw Error(ErrorKind::input, place,
                fmt::format("columns '{}' and '{}' are in different units", x_heading.text, y_heading.text),
                "name two columns of one unit, or give `unit`");
  }
  if (flag != PositionUnit::automatic && x != PositionUnit::automatic && x != flag) {
    plan.warnings.push_back(fmt::format("{}: the header says that '{}' is in {}; `unit` {} was given and is used",
                                        place, x_heading.text, to_string(x), to_string(flag)));
  }
  plan.unit = flag != PositionUnit::automatic ? flag : x;
  plan.x_grows_left = x_heading.text.ends_with("_cpf");  // Project Aria's frame: +x to the wearer's left
  plan.unit_evidence = flag != PositionUnit::automatic ? Evidence::option : Evidence::header;
}

}  // namespace

std::size_t ColumnPlan::needed_cells(const DelimitedTable& table) const {
  UsedColumns used(table);
  used.use(time);
  const auto use = [&](const VectorColumns& columns) {
    std::for_each(columns.begin(), columns.end(), [&](const OptionalColumn& column) { used.use(column); });
  };
  for (const GazeSource& source : sources) {
    use({source.x, source.y, source.z});
    use({source.validity, source.confidence, source.pupil});
    use(source.origin);
    used.use(source.openness);
  }
  use(head_position);
  use(head_rotation);
  use({eye, frame, head_w});
  return used.needed();
}

ColumnPlan plan_columns(const DelimitedTable& table, const GazeColumns& declared) {
  const Finder find(table);
  ColumnPlan plan;
  plan.time = find.required(declared.time, kTime, "time", "`time-column`");
  plan_positions(plan, find, declared);
  plan_head(plan, find, declared);
  plan.eye = find.optional(declared.eye, kEye);
  plan.frame = find.optional(declared.frame);
  find.refuse_missing();
  plan_time_unit(plan, table, declared);
  plan_position_unit(plan, table, declared);
  for (const GazeSource& source : plan.sources) {
    if (source.pupil && plan.pupil_unit.empty()) {
      plan.pupil_unit = table.headings[*source.pupil].unit;
    }
  }
  return plan;
}

}  // namespace gazetrace
