// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gazetrace/job.hpp"

namespace gazetrace {

// The option that names a preset.
inline constexpr const char* kPresetOption = "preset";
// Throws Error(usage, place, ...) with the known names.
const Preset& preset_by_name(const std::string& name, const std::string& place);

}  // namespace gazetrace
