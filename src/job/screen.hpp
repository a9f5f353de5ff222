// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/resolve.hpp"

namespace gazetrace {

// A screen by its name, or from a .json file. Throws Error(usage, `option`, ...) with the known names.
DisplayGeometry known_screen(const std::string& name, const std::string& option);

}  // namespace gazetrace
