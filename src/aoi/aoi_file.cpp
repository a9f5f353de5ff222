// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_problem.hpp"
#include "core/text.hpp"
#include "gazetrace/gaze_aois.hpp"
#include "job/toml_tree.hpp"

namespace gazetrace {
namespace {

// JSON as the same tree, without lines.
TomlNode tree_of_json(const nlohmann::ordered_json& json) {
  TomlNode node;
  if (json.is_object()) {
    node.kind = TomlNode::Kind::table;
    for (const auto& [key, value] : json.items()) {
      node.members.push_back({key, tree_of_json(value)});
    }
  } else if (json.is_array()) {
    node.kind = TomlNode::Kind::array;
    for (const auto& value : json) {
      node.items.push_back(tree_of_json(value));
    }
  } else if (!json.is_null()) {
    node.kind = TomlNode::Kind::scalar;
    node.text = json.is_string() ? json.get<std::string>() : json.dump();
  }
  return node;
}

constexpr int kDeepestJson = 8;

TomlNode read_tree(const std::string& path) {
  const std::string text = read_text_file(path);
  if (!path.ends_with(".json")) {
    return parse_toml(text, path);
  }
  try {
    const auto limit = [](int depth, nlohmann::ordered_json::parse_event_t, nlohmann::ordered_json&) {
      if (depth > kDeepestJson) {
        throw std::runtime_error("nested too deeply");
      }
      return true;
    };
    return tree_of_json(nlohmann::ordered_json::parse(text, limit));
  } catch (const std::exception& error) {
    throw Error(ErrorKind::input, path, "is not valid JSON: " + json_problem(error.what()));
  }
}

class AoiReader {
 public:
  AoiReader(const std::string& path, const std::optional<DisplayGeometry>& display) : path_(path), display_(display) {}

  std::vector<Aoi> read() {
    const TomlNode root = read_tree(path_);
    if (root.kind != TomlNode::Kind::table) {
      fail(root, "is no table", "write [[aoi]] for each area");
    }
    read_unit(root);
    const TomlNode* const list = root.find("aoi");
    if (list == nullptr || list->kind != TomlNode::Kind::array || list->items.empty()) {
      fail(root, "names no area", "write [[aoi]] for each area");
    }
    std::vector<Aoi> areas;
    for (const TomlNode& item : list->items) {
      Aoi area = read_area(item);
      if (std::any_of(areas.begin(), areas.end(), [&](const Aoi& a) { return a.name == area.name; })) {
        fail(item, fmt::format("a second area is called '{}'", area.name), "give each a name of its own");
      }
      areas.push_back(std::move(area));
    }
    return areas;
  }

 private:
  [[noreturn]] void fail(const TomlNode& node, const std::string& problem, const std::string& remedy = {}) const {
    throw Error(ErrorKind::input, node.line > 0 ? toml_place(path_, node) : path_, problem, remedy);
  }

  double number(const TomlNode& node) const {
    const std::optional<double> value =
        node.kind == TomlNode::Kind::scalar ? number_from(node.text) : std::optional<double>{};
    if (!value) {
      fail(node, fmt::format("'{}' is no number", node.text));
    }
    return *value;
  }

  std::vector<double> numbers(const TomlNode& node, std::size_t count, const char* what) const {
    std::vector<double> values;
    for (const TomlNode& item : node.items) {
      TomlNode placed = item;
      placed.line = node.line;
      values.push_back(number(placed));
    }
    if (node.kind != TomlNode::Kind::array || values.size() != count) {
      fail(node, fmt::format("is not {}", what));
    }
    return values;
  }

  void read_unit(const TomlNode& root) {
    for (const auto& [key, value] : root.members) {
      if (key != "aoi" && key != "unit" && key != "display-px") {
        fail(value, unknown_name_message("key", key, {"aoi", "unit", "display-px"}));
      }
    }
    const TomlNode* const unit = root.find("unit");
    if (unit != nullptr && unit->text != "px" && unit->text != "fraction") {
      fail(*unit, unknown_name_message("unit", unit->text, {"fraction", "px"}));
    }
    if (unit == nullptr || unit->text != "px") {
      return;
    }
    if (const TomlNode* const size = root.find("display-px")) {
      const std::vector<double> px = numbers(*size, 2, "width and height in pixels");
      scale_ = {1 / px[0], 1 / px[1]};
    } else if (display_ && display_->width_px > 0 && display_->height_px > 0) {
      scale_ = {1.0 / display_->width_px, 1.0 / display_->height_px};
    } else {
      fail(*unit, "are of a display whose size is not known", "give display-px = [width, height], or fractions");
    }
    if (!(scale_.x > 0) || !(scale_.y > 0) || !std::isfinite(scale_.x) || !std::isfinite(scale_.y)) {
      fail(*root.find("display-px"), "is no size of a display");
    }
  }

  [[nodiscard]] Vec2d scaled(double x, double y) const { return {x * scale_.x, y * scale_.y}; }

  Aoi read_area(const TomlNode& item) const {
    if (item.kind != TomlNode::Kind::table) {
      fail(item, "is no area", "write [[aoi]] for each");
    }
    Aoi area;
    int shapes = 0;
    for (const auto& [key, value] : item.members) {
      if (key == "name") {
        area.name = value.text;
      } else if (key == "rectangle") {
        const std::vector<double> v = numbers(value, 4, "left, top, right, bottom");
        area.shape = AoiShape::rectangle;
        area.points = {scaled(v[0], v[1]), scaled(v[2], v[3])};
        if (!(v[2] > v[0]) || !(v[3] > v[1])) {
          fail(value, "has no area", "write left, top, right, bottom");
        }
        ++shapes;
      } else if (key == "ellipse") {
        const std::vector<double> v = numbers(value, 4, "the centre's x and y and the two radii");
        area.shape = AoiShape::ellipse;
        area.points = {scaled(v[0], v[1]), scaled(v[2], v[3])};
        if (!(v[2] > 0) || !(v[3] > 0)) {
          fail(value, "has a radius that is not positive");
        }
        ++shapes;
      } else if (key == "polygon") {
        area.shape = AoiShape::polygon;
        for (const TomlNode& corner : value.items) {
          TomlNode placed = corner;
          placed.line = value.line;
          const std::vector<double> v = numbers(placed, 2, "the x and y of a corner");
          area.points.push_back(scaled(v[0], v[1]));
        }
        if (area.points.size() < 3) {
          fail(value, "has fewer than three corners");
        }
        ++shapes;
      } else if (key == "node" || key == "material") {
        (key == "node" ? area.node : area.material) = value.text;
        area.shape = AoiShape::object;
      } else {
        fail(value, unknown_name_message("key", key, {"name", "rectangle", "ellipse", "polygon", "node", "material"}));
      }
    }
    const bool is_object = !area.node.empty() || !area.material.empty();
    if (shapes + (is_object ? 1 : 0) != 1) {
      fail(item, "needs one shape",
           "give one of rectangle, ellipse and polygon, or an object of the scene by node or material");
    }
    if (area.name.empty()) {
      fail(item, "has no name", "give one");
    }
    return area;
  }

  std::string path_;
  const std::optional<DisplayGeometry>& display_;
  Vec2d scale_{1, 1};
};

}  // namespace

std::vector<Aoi> load_aois(const std::string& path, const std::optional<DisplayGeometry>& display) {
  return AoiReader(path, display).read();
}

}  // namespace gazetrace
