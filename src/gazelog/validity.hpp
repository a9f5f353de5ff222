// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/gaze_read.hpp"

namespace gazetrace {

enum class ValidityStyle { any, names };  // names: only the names of GazeValidity, 0 and 1

std::optional<GazeValidity> validity_by_name(std::string_view text);  // "ok", "low_confidence", "blink", ...

// Reads the texts of a column as validities.
class ValidityReader {
 public:
  ValidityReader(const GazeColumns& columns, ValidityStyle style);
  // Empty where the text is not a validity.
  std::optional<GazeValidity> read(std::string_view text);
  [[nodiscard]] const std::vector<std::string>& seen() const { return seen_; }

 private:
  std::optional<GazeValidity> interpret(const std::string& text);

  ValidityStyle style_;
  std::int64_t mask_;
  std::vector<std::string> wanted_, seen_;
  std::string last_text_;
  bool has_last_ = false;
  std::optional<GazeValidity> last_;
};

// left, L, both, cyclopean, ...
std::optional<Eye> eye_from(std::string_view text);

}  // namespace gazetrace
