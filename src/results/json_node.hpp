// SPDX-License-Identifier: Apache-2.0
// A value of a results file together with where it stands, so that every complaint names file and path of keys.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace gazetrace {

using Json = nlohmann::ordered_json;

// Refers to `json`, which must outlive it. The readers throw an Error of kind `input` where the value is of another
// kind.
class JsonNode {
 public:
  JsonNode(const Json& json, std::string file, std::string path)
      : json_(json), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& problem) const;

  // Whether this is an object with a value for `key` that is not null.
  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] JsonNode at(const std::string& key) const;
  [[nodiscard]] std::vector<JsonNode> items() const;
  [[nodiscard]] std::vector<std::pair<std::string, JsonNode>> members() const;

  [[nodiscard]] bool is_null() const { return json_.is_null(); }
  [[nodiscard]] bool is_number() const { return json_.is_number(); }
  [[nodiscard]] double number() const;
  template <std::integral T>
  [[nodiscard]] T whole_number() const {
    const double value = number();
    const bool holds = json_.is_number_unsigned()  ? std::in_range<T>(json_.get<std::uint64_t>())
                       : json_.is_number_integer() ? std::in_range<T>(json_.get<std::int64_t>())
                                                   : std::floor(value) == value &&
                                                         value >= static_cast<double>(std::numeric_limits<T>::min()) &&
                                                         value < std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!holds) {
      fail("is no such whole number");
    }
    return json_.get<T>();
  }
  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool truth() const;
  // A value of any kind for people to read: texts without quotes, lists with commas.
  [[nodiscard]] std::string shown() const;

 private:
  const Json& json_;
  std::string file_, path_;
};

}  // namespace gazetrace
