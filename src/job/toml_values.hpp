// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gazetrace/option_schema.hpp"
#include "job/toml_tree.hpp"

namespace gazetrace {

// The values that an option takes from a node, as they would be written on the command line. Throws Error(input) with
// path:line.
std::vector<std::string> toml_values(const TomlNode& node, const Option& option, const std::string& path);

}  // namespace gazetrace
