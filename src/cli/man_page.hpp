// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command_tree.hpp"

namespace gazetrace {

// "gazetrace-gaze-inspect.1", the file of a command's page.
std::string man_page_name(const CommandWords& command);
// The page in the language of man(7). It holds no date, so that the same program makes the same page.
std::string man_page(const CommandWords& command);

}  // namespace gazetrace
