// SPDX-License-Identifier: Apache-2.0
// Reads a display from JSON whose keys are the fields of DisplayGeometry.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::json;

struct Field {
  const char* name;
  double DisplayGeometry::*value;
};
constexpr Field kFields[] = {
    {"width_cm", &DisplayGeometry::width_cm},       {"height_cm", &DisplayGeometry::height_cm},
    {"distance_cm", &DisplayGeometry::distance_cm}, {"eye_x_cm", &DisplayGeometry::eye_x_cm},
    {"eye_y_cm", &DisplayGeometry::eye_y_cm},       {"luminance_cd_m2", &DisplayGeometry::luminance_cd_m2}};

std::vector<std::string> known_keys() {
  std::vector<std::string> names{"name", "description", "width_px", "height_px"};
  for (const Field& field : kFields) {
    names.emplace_back(field.name);
  }
  return names;
}

double number_of(const Json& value, const std::string& key, const std::string& path) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw Error(ErrorKind::input, path, fmt::format("'{}' is not a finite number", key));
  }
  return value.get<double>();
}

int pixels_of(const Json& value, const std::string& key, const std::string& path) {
  const double number = number_of(value, key, path);
  if (number != std::floor(number) || number < 1 || number > 1e6) {
    throw Error(ErrorKind::input, path, fmt::format("'{}' is not a whole number of pixels", key));
  }
  return static_cast<int>(number);
}

}  // namespace

DisplayGeometry load_display(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be read", "check the path");
  }
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw Error(
        ErrorKind::input, path, "is not a JSON object that describes a display",
        "give {\"width_px\": 1920, \"height_px\": 1080, \"width_cm\": 53, \"height_cm\": 30, \"distance_cm\": 60}");
  }
  DisplayGeometry display;
  for (const auto& [key, value] : json.items()) {
    bool known = key == "name" || key == "description";
    if (key == "width_px" || key == "height_px") {
      (key == "width_px" ? display.width_px : display.height_px) = pixels_of(value, key, path);
      known = true;
    }
    for (const Field& field : kFields) {
      if (key == field.name) {
        display.*field.value = number_of(value, key, path);
        known = true;
      }
    }
    if (!known) {
      throw Error(ErrorKind::input, path, unknown_name_message("key", key, known_keys()));
    }
  }
  try {
    check_display(display);
  } catch (const Error& error) {
    throw Error(ErrorKind::input, path, error.what());
  }
  if (!(display.luminance_cd_m2 >= 0)) {
    throw Error(ErrorKind::input, path, "'luminance_cd_m2' is negative");
  }
  return display;
}

}  // namespace gazetrace
