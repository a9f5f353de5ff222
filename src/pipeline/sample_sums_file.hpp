// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gazetrace {

// The settings' digest of a file of save_samples(); empty: not there, or another file.
std::string read_samples_digest(const std::string& path);

}  // namespace gazetrace
