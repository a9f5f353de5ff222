// SPDX-License-Identifier: Apache-2.0
// Column maps as JSON, so that a laboratory needs to describe its own table only once.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <type_traits>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazelog/json.hpp"
#include "gazelog/units.hpp"

namespace gazetrace {
namespace {

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

using Json = nlohmann::ordered_json;

// Members that differ from their defaults.
class Saver {
 public:
  void operator()(const std::string& path, const std::string& text) { put(path, text, !text.empty()); }
  void operator()(const std::string& path, const std::vector<std::string>& list) { put(path, list, !list.empty()); }
  void operator()(const std::string& path, double value) {
    put(path, Json::parse(fmt::format("{}", value)), value != 1);
  }
  void operator()(const std::string& path, std::int64_t value) { put(path, value, value != 0); }
  template <class E>
  requires std::is_enum_v<E>
  void operator()(const std::string& path, E value) { put(path, to_string(value), value != E::automatic); }
  Json root = Json::object();

 private:
  void put(std::string path, const Json& value, bool is_set) {
    if (is_set) {
      std::replace(path.begin(), path.end(), '.', '/');
      root[Json::json_pointer("/" + path)] = value;
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
  template <class E>
  requires std::is_enum_v<E>
  void operator()(const std::string& path, E& value) {
    const std::string text = take(path);
    std::vector<std::string> all;
    for (int i = 0; !to_string(static_cast<E>(i)).empty(); ++i) {
      all.emplace_back(to_string(static_cast<E>(i)));
      if (all.back() == text) {
        value = static_cast<E>(i);
        return;
      }
    }
    if (!text.empty()) {
      throw Error(ErrorKind::input, place_, unknown_name_message("value of '" + path + "'", text, all));
    }
  }
  std::vector<std::string> known;

 private:
  std::string take(const std::string& path) {
    known.push_back(path);
    return json_.text(path);
  }
  [[noreturn]] void fail(const std::string& path, const std::string& text, std::string_view wanted) const {
    throw Error(ErrorKind::input, place_, fmt::format("'{}' of '{}' is not {}", text, path, wanted));
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
  const std::string text = saver.root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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
