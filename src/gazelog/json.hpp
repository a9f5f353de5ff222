// SPDX-License-Identifier: Apache-2.0
// JSON as a flat list of leaves, with numbers as they were written, so that times can be converted to integers digit by
// digit.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

struct JsonLeaf {
  std::string path;  // "data.eyeleft.gazedirection.2"
  std::string
      text;  // the content of a string, the digits of a number, "true", "false", "null", or "{}" and "[]" if empty
  bool is_number = false;
};

class JsonLeaves {
 public:
  // Throws Error(input) at `place` for a text that is not a JSON object.
  JsonLeaves(std::string_view json, const std::string& place);

  [[nodiscard]] const JsonLeaf* find(std::string_view path) const;  // the first one of this path
  [[nodiscard]] bool has(std::string_view path) const;              // whether there is a leaf, or leaves below it
  [[nodiscard]] std::string text(std::string_view path) const;      // empty where there is none
  [[nodiscard]] std::optional<double> number(std::string_view path) const;
  // "path.0", "path.1", ... as far as they are numbers; NaN for null.
  [[nodiscard]] std::vector<double> numbers(std::string_view path) const;
  [[nodiscard]] std::vector<std::string> texts(std::string_view path) const;
  [[nodiscard]] const std::vector<JsonLeaf>& leaves() const { return leaves_; }

 private:
  std::vector<JsonLeaf> leaves_;
};

}  // namespace gazetrace
