// SPDX-License-Identifier: Apache-2.0
// Typed access to the JSON of a glTF file, with errors that name the place in it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"

namespace gazetrace {

using Json = nlohmann::json;

// Walks the document and keeps track of the place, such as "meshes[3].primitives[0].attributes".
class Walker {
 public:
  Walker(std::string path, const Json& root) : path_(std::move(path)), root_(root) {}

  class Step {
   public:
    Step(Walker& walker, std::string_view name, std::int64_t index = -1) : walker_(walker) {
      walker_.steps_.emplace_back(name, index);
    }
    ~Step() { walker_.steps_.pop_back(); }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;

   private:
    Walker& walker_;
  };

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = "export the file again") const {
    std::string place = path_;
    std::string separator = ": ";
    for (const auto& [name, index] : steps_) {
      place.append(separator).append(name);
      if (index >= 0) {
        place += "[" + std::to_string(index) + "]";
      }
      separator = ".";
    }
    throw Error(ErrorKind::input, place, problem, remedy);
  }

  const Json* find(const Json& object, const char* key) const {
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
  }

  // The member, which must be an object; nullptr where it is missing.
  const Json* object(const Json& parent, const char* key) {
    const Json* value = find(parent, key);
    if (value != nullptr && !value->is_object()) {
      const Step step(*this, key);
      fail("is not a JSON object");
    }
    return value;
  }

  template <class Body>
  void each_object(const Json& parent, const char* key, Body body) {
    const Json* array = find(parent, key);
    if (array == nullptr) {
      return;
    }
    if (!array->is_array()) {
      const Step step(*this, key);
      fail("is not a JSON array");
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      const Step step(*this, key, static_cast<std::int64_t>(i));
      const Json& item = (*array)[i];
      if (!item.is_object()) {
        fail("is not a JSON object");
      }
      body(item);
    }
  }

  // A whole number from 0 to `maximum`; empty where it is missing and not required.
  std::optional<std::uint64_t> whole(const Json& object, const char* key, bool required = false,
                                     std::uint64_t maximum = std::numeric_limits<std::int64_t>::max()) {
    const Json* value = find(object, key);
    if (value == nullptr) {
      if (required) {
        fail("'" + std::string(key) + "' is missing");
      }
      return std::nullopt;
    }
    const Step step(*this, key);
    if (!value->is_number_unsigned() || value->get<std::uint64_t>() > maximum) {
      fail(value->dump().substr(0, 40) + " is not a whole number from 0 to " + std::to_string(maximum));
    }
    return value->get<std::uint64_t>();
  }

  void reference_value(const Json& value, const char* target) {
    const Json* array = find(root_, target);
    const std::size_t count = array != nullptr && array->is_array() ? array->size() : 0;
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count) {
      fail(value.dump().substr(0, 40) + " is not an index into the " + std::to_string(count) + " " + target);
    }
  }
  void reference(const Json& object, const char* key, const char* target, bool required = false) {
    if (const Json* value = find(object, key)) {
      const Step step(*this, key);
      reference_value(*value, target);
    } else if (required) {
      fail("'" + std::string(key) + "' is missing");
    }
  }
  void references(const Json& object, const char* key, const char* target) {
    const Json* array = find(object, key);
    if (array == nullptr) {
      return;
    }
    if (!array->is_array()) {
      const Step step(*this, key);
      fail("is not a JSON array");
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      const Step step(*this, key, static_cast<std::int64_t>(i));
      reference_value((*array)[i], target);
    }
  }
  void reference_map(const Json& parent, const char* key, const char* target, bool required = false) {
    const Json* map = object(parent, key);
    if (map == nullptr) {
      if (required) {
        fail("'" + std::string(key) + "' is missing");
      }
      return;
    }
    const Step step(*this, key);
    for (const auto& [name, value] : map->items()) {
      const Step attribute(*this, name);
      reference_value(value, target);
    }
  }

  void number(const Json& object, const char* key, bool required = false) {
    const Json* value = find(object, key);
    if ((value == nullptr && required) || (value != nullptr && !value->is_number())) {
      const Step step(*this, key);
      fail(value == nullptr ? "is missing" : "is not a number");
    }
  }
  void numbers(const Json& object, const char* key, std::size_t count) {
    const Json* array = find(object, key);
    if (array == nullptr) {
      return;
    }
    if (!array->is_array() || array->size() != count ||
        !std::all_of(array->begin(), array->end(), [](const Json& value) { return value.is_number(); })) {
      const Step step(*this, key);
      fail("is not an array of " + std::to_string(count) + " numbers");
    }
  }
  void text(const Json& object, const char* key, bool required = false) {
    const Json* value = find(object, key);
    if ((value == nullptr && required) || (value != nullptr && !value->is_string())) {
      const Step step(*this, key);
      fail(value == nullptr ? "is missing" : "is not a text");
    }
  }

 private:
  std::string path_;
  const Json& root_;
  std::vector<std::pair<std::string_view, std::int64_t>> steps_;
};

}  // namespace gazetrace
