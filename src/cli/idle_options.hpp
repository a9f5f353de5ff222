// SPDX-License-Identifier: Apache-2.0
// Options that were given and that nothing heeds beside the others.
#pragma once

#include "cli/option_table.hpp"
#include "cli/settings_options.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

// A line for each option with another value than its default, by the command line or a settings file, that does nothing
// under the settings `job`, which are those of the table.
Warnings idle_option_warnings(const OptionTable& table, const JobSettings& job);

}  // namespace gazetrace
