// SPDX-License-Identifier: Apache-2.0
// Names of fall-offs and filters. They are taken for each other, and one name, `linear`, is of both.
#pragma once

#include <string>

namespace gazetrace {

// Error(usage, place, ...) with the nearest known name, or with the option that takes this one.
void check_falloff_name(const std::string& name, const std::string& place);
// "auto" is a name here, too.
void check_filter_name(const std::string& name, const std::string& place);

}  // namespace gazetrace
