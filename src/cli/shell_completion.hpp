// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command_tree.hpp"

namespace gazetrace {

const std::vector<std::string>& completion_shells();  // bash, zsh, fish
// A script that completes commands, options and their values. Error(usage) for another shell.
std::string shell_completion(const CommandWords& program, const std::string& shell);

}  // namespace gazetrace
