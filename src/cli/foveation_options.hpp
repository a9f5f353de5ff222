// SPDX-License-Identifier: Apache-2.0
// The options of where samples go.
#pragma once

#include "cli/option_table.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {

// The table refers to `settings`, which must outlive it.
void add_foveation_options(OptionTable& table, FoveationSettings& settings);

}  // namespace gazetrace
