// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gazetrace {

// The names that an option such as --filter accepts, as 'gazetrace list' prints them; empty: it takes other values.
// Views are left out, which depend on the OpenColorIO config.
std::vector<std::string> names_of_option(const std::string& flag);

}  // namespace gazetrace
