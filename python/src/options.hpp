// SPDX-License-Identifier: Apache-2.0
// Options by their Python names, for every schema of the library: `gaze_start` is the option `gaze-start`.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/option_schema.hpp"

namespace gazetrace::python {

// Values as text by Python names, as the Python side writes them.
using OptionTexts = std::map<std::string, std::vector<std::string>>;

std::string keyword_of(const std::string& option);
// The option of a keyword. Error(usage) for an unknown one, with the nearest known one.
std::string option_of(const std::string& keyword, const OptionList& options);

[[noreturn]] void refuse_option(const std::string& keyword, const std::vector<std::string>& known);

template <class S>
void assign_options(S& settings, const OptionSchema<S>& schema, const OptionTexts& texts) {
  for (const auto& [keyword, values] : texts) {
    const OptionOf<S>& option = *schema.find(option_of(keyword, schema.list()));
    option.assign(settings, values, "`" + option.name + "`");
  }
}

}  // namespace gazetrace::python
