// SPDX-License-Identifier: Apache-2.0
// Where this program is, for what starts it again.
#pragma once

#include <filesystem>

namespace gazetrace {

// Its name alone where the system does not tell.
inline std::filesystem::path own_program() {
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? std::filesystem::path("gazetrace") : path;
}

}  // namespace gazetrace
