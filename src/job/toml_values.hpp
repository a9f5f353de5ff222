// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/former_options.hpp"
#include "gazetrace/option_schema.hpp"
#include "job/toml_tree.hpp"

namespace gazetrace {

// The values that an option takes from a node, as they would be written on the command line. Throws Error(input) with
// path:line.
std::vector<std::string> toml_values(const TomlNode& node, const Option& option, const std::string& path);

// What a key sets: one option, or those that took the place of a former one; nothing for an empty array. Throws as
// read_toml_settings() does. `names`: values are not checked, for which some options open the files that they name.
// `given`: what stands in the same table, which former options look at.
enum class TomlChecks : std::uint8_t { values, names };
std::vector<TomlSetting> toml_settings(const std::string& key, const TomlNode& node,
                                       const std::vector<OptionText>& given, const OptionList& options,
                                       const std::string& path, const std::string& remedy,
                                       PathsBegin paths = PathsBegin::beside_settings,
                                       TomlChecks checks = TomlChecks::values);
// Values of a former option, which were read without knowing what takes its place.
std::vector<std::string> values_for(const Option& option, const std::vector<std::string>& values);
// Keys and values of a table, apart from tables in it.
std::vector<OptionText> given_in(const TomlNode& table, const std::string& path);

}  // namespace gazetrace
