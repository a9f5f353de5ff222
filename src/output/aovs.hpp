// SPDX-License-Identifier: Apache-2.0
// What the channels of an EXR need of the frames that they are written from.
#pragma once

#include <string>
#include <vector>

#include "gazetrace/aovs.hpp"

namespace gazetrace {

// Whether the AOVs show what samples hit first, which TraceSettings::guides collects.
bool show_first_hits(const std::vector<std::string>& aovs);

}  // namespace gazetrace
