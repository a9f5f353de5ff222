// SPDX-License-Identifier: Apache-2.0
// Column maps as JSON, so that a laboratory needs to describe its own table only once.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazelog/json.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

template <class Value, std::size_t N>
using Names = std::array<std::pair<std::string_view, Value>, N>;

constexpr Names<TimeUnit, 5> kTimeUnits{{{"auto", TimeUnit::automatic},
                                         {"ns", TimeUnit::ns},
                                         {"us", TimeUnit::us},
                                         {"ms", TimeUnit::ms},
                                         {"s", TimeUnit::s}}};
constexpr Names<GazeAxes, 5> kAxes{{{"auto", GazeAxes::automatic},
                                    {"gl", GazeAxes::gl},
                                    {"unity", GazeAxes::unity},
                                    {"sranipal", GazeAxes::sranipal},
                                    {"cv", GazeAxes::cv}}};
constexpr Names<PositionUnit, 10> kUnits{{{"auto", PositionUnit::automatic},
                                          {"fraction", PositionUnit::fraction},
                                          {"px", PositionUnit::px},
                                          {"mm", PositionUnit::mm},
                                          {"cm", PositionUnit::cm},
                                          {"deg", PositionUnit::deg},
                                          {"unit-vector", PositionUnit::unit_vector},
                                          {"norm", PositionUnit::norm},
                                          {"height", PositionUnit::height},
                                          {"rad", PositionUnit::rad}}};
constexpr Names<PositionOrigin, 4> kOrigins{{{"auto", PositionOrigin::automatic},
                                             {"top-left", PositionOrigin::top_left},
                                             {"bottom-left", PositionOrigin::bottom_left},
                                             {"center", PositionOrigin::center}}};

// Every member of a map by its name. Saving, loading and merging all walk over this list.
template <class Columns, class Visitor>
void visit(Columns& c, Visitor&& v) {
  v("time", c.time);
  v("x", c.x);
  v("y", c.y);
  v("z", c.z);
  v("validity", c.validity);
  v("confidence", c.confidence);
  v("pupil", c.pupil);
  v("eye", c.eye);
  v("recording", c.recording);
  const auto visit_eye = [&](const std::string& side, auto& e) {
    v(side + ".x", e.x);
    v(side + ".y", e.y);
    v(side + ".z", e.z);
    v(side + ".validity", e.validity);
    v(side + ".confidence", e.confidence);
    v(side + ".pupil", e.pupil);
    v(side + ".openness", e.openness);
    v(side + ".origin_x", e.origin_x);
    v(side + ".origin_y", e.origin_y);
    v(side + ".origin_z", e.origin_z);
  };
  visit_eye("left", c.left);
  visit_eye("right", c.right);
  v("head_x", c.head_x);
  v("head_y", c.head_y);
  v("head_z", c.head_z);
  v("head_rotation_x", c.head_rotation_x);
  v("head_rotation_y", c.head_rotation_y);
  v("head_rotation_z", c.head_rotation_z);
  v("head_rotation_w", c.head_rotation_w);
  v("frame", c.frame);
  v("time_unit", c.time_unit);
  v("position_unit", c.position_unit);
  v("origin", c.origin);
  v("axes", c.axes);
  v("head_axes", c.head_axes);
  v("origin_mm_per_unit", c.origin_mm_per_unit);
  v("head_m_per_unit", c.head_m_per_unit);
  v("valid_values", c.valid_values);
  v("valid_mask", c.valid_mask);
}

class Saver {
 public:
  void operator()(const std::string& path, const std::string& text) {
    if (!text.empty()) {
      values.push_back({path, text, JsonValue::Kind::string, {}});
    }
  }
  void operator()(const std::string& path, const std::vector<std::string>& list) {
    if (!list.empty()) {
      values.push_back({path, "", JsonValue::Kind::list, list});
    }
  }
  void operator()(const std::string& path, double value) {
    if (value != 1) {
      values.push_back({path, fmt::format("{}", value), JsonValue::Kind::number, {}});
    }
  }
  void operator()(const std::string& path, std::int64_t value) {
    if (value != 0) {
      values.push_back({path, std::to_string(value), JsonValue::Kind::number, {}});
    }
  }
  void operator()(const std::string& path, TimeUnit unit) { named(path, kTimeUnits, unit); }
  void operator()(const std::string& path, PositionUnit unit) { named(path, kUnits, unit); }
  void operator()(const std::string& path, PositionOrigin origin) { named(path, kOrigins, origin); }
  void operator()(const std::string& path, GazeAxes axes) { named(path, kAxes, axes); }
  std::vector<JsonValue> values;

 private:
  template <class Value, std::size_t N>
  void named(const std::string& path, const Names<Value, N>& names, Value value) {
    for (const auto& [name, of] : names) {
      if (of == value && name != "auto") {
        values.push_back({path, std::string(name), JsonValue::Kind::string, {}});
      }
    }
  }
};

class Loader {
 public:
  Loader(const JsonLeaves& json, std::string place) : json_(json), place_(std::move(place)) {}

  void operator()(const std::string& path, std::string& text) { text = take(path); }
  void operator()(const std::string& path, std::vector<std::string>& list) {
    known.push_back(path);
    list = json_.texts(path);
  }
  void operator()(const std::string& path, double& value) {
    if (const std::string text = take(path); !text.empty()) {
      const auto number = number_from(text);
      if (!number) {
        fail(path, text, "a number");
      }
      value = *number;
    }
  }
  void operator()(const std::string& path, std::int64_t& value) {
    if (const std::string text = take(path); !text.empty() && scaled_integer(text, 0, value) != NumberStatus::ok) {
      fail(path, text, "a whole number");
    }
  }
  void operator()(const std::string& path, TimeUnit& unit) { named(path, kTimeUnits, unit); }
  void operator()(const std::string& path, PositionUnit& unit) { named(path, kUnits, unit); }
  void operator()(const std::string& path, PositionOrigin& origin) { named(path, kOrigins, origin); }
  void operator()(const std::string& path, GazeAxes& axes) { named(path, kAxes, axes); }
  std::vector<std::string> known;

 private:
  std::string take(const std::string& path) {
    known.push_back(path);
    return json_.text(path);
  }
  [[noreturn]] void fail(const std::string& path, const std::string& text, std::string_view wanted) const {
    throw Error(ErrorKind::input, place_, fmt::format("'{}' of '{}' is not {}", text, path, wanted));
  }
  template <class Value, std::size_t N>
  void named(const std::string& path, const Names<Value, N>& names, Value& value) {
    const std::string text = take(path);
    std::vector<std::string> all;
    for (const auto& [name, of] : names) {
      all.emplace_back(name);
      if (name == text) {
        value = of;
        return;
      }
    }
    if (!text.empty()) {
      throw Error(ErrorKind::input, place_, unknown_name_message("value of '" + path + "'", text, all));
    }
  }

  const JsonLeaves& json_;
  std::string place_;
};

}  // namespace

GazeColumns load_gaze_columns(const std::string& path) {
  const JsonLeaves json(read_text_file(path), path);
  GazeColumns columns;
  Loader loader(json, path);
  visit(columns, loader);
  for (const JsonLeaf& leaf : json.leaves()) {
    std::string name = leaf.path;
    if (name.starts_with("valid_values.")) {
      name = "valid_values";
    }
    if (std::find(loader.known.begin(), loader.known.end(), name) == loader.known.end() && leaf.text != "{}") {
      throw Error(ErrorKind::input, path, unknown_name_message("key", name, loader.known));
    }
  }
  return columns;
}

void save_gaze_columns(const GazeColumns& columns, const std::string& path) {
  Saver saver;
  visit(columns, saver);
  const std::string text = json_text(saver.values);
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

GazeColumns merge_gaze_columns(const GazeColumns& base, const GazeColumns& over) {
  GazeColumns merged = base;
  const GazeColumns untouched;
  // Walks over three maps at once, and takes each member that differs from its default.
  std::vector<const void*> given;
  std::vector<const void*> defaults;
  visit(over, [&](const auto&, const auto& value) { given.push_back(&value); });
  visit(untouched, [&](const auto&, const auto& value) { defaults.push_back(&value); });
  std::size_t i = 0;
  visit(merged, [&](const auto&, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    const Value& wanted = *static_cast<const Value*>(given[i]);
    if (wanted != *static_cast<const Value*>(defaults[i])) {
      value = wanted;
    }
    ++i;
  });
  return merged;
}

}  // namespace gazetrace
