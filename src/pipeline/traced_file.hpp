// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gazetrace {

// The settings' digest of a file of save_traced(); empty where there is no file, or one of another kind.
std::string read_traced_digest(const std::string& path);

}  // namespace gazetrace
