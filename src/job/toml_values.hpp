// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gazetrace/option_schema.hpp"
#include "job/toml_tree.hpp"

namespace gazetrace {

// The values that an option takes from a node, as the command line would carry them. Error(input) with path:line.
std::vector<std::string> toml_values(const TomlNode& node, const Option& option, const std::string& path);

}  // namespace gazetrace
