// SPDX-License-Identifier: Apache-2.0
// Names of filters, which are taken for those of densities: one name, `linear`, is of both.
#pragma once

#include <string>

namespace gazetrace {

// Error(usage, place, ...) with the nearest known name, or with the option that takes this one. "auto" is a name, too.
void check_filter_name(const std::string& name, const std::string& place);

}  // namespace gazetrace
