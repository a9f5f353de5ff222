// SPDX-License-Identifier: Apache-2.0
// Files that are there completely or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace gazetrace {

// Writes a file without a name in the folder of `path` and gives it that name once it is whole; where the file system
// has no such files, `.name.PID.part.ext`, which is then renamed. Of several that write the same file at once, in any
// processes, each succeeds and the last one's bytes stay. On failure nothing else is left, what stood under `path`
// stays, and Error(runtime) gives the path and the system's reason.
void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gazetrace
