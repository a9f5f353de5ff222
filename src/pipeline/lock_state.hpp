// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gazetrace {

// Whether a run lives that writes the record of this name, as RunLock tells it, without waiting: of a run on another
// machine it is whether it has renewed its lock within the last minute, by the clock of the file system.
bool is_locked(const std::string& record_path);

}  // namespace gazetrace
