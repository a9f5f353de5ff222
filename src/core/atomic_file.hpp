// SPDX-License-Identifier: Apache-2.0
// Writes files so that they exist completely or not at all, whenever the process is killed. A file is on the
// disk before it has its name, and its name before the writer goes on, so that the same holds for a loss of power.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace gazetrace {

// Writes a file without a name in the folder of `path`, and gives it that name once it is complete; where the file
// system has no such files, it writes `.name.PID.part.ext` and renames that. Where several writers, in any processes,
// write the same file at once, each succeeds and the bytes of the last one stay. On failure no other file is left, what
// was under `path` stays as it was, and Error(runtime) gives the path and the system's reason.
void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes);

// The same for a file that another program has written under a name of its own beside `path`.
void put_file_in_place(const std::string& temporary, const std::string& path);

// The name under which a file is written before it gets its own: hidden, of this process, with the same suffix.
std::filesystem::path temporary_name(const std::filesystem::path& path, int attempt = 0);

// What can be no output is Error(input): a device, pipe or socket, a folder, a name that no file system holds.
// write_bytes_atomically() asks it itself.
void refuse_impossible_file(const std::string& path);

// The same for a file that must not replace another one: false where the name is taken, by whomever and however
// recently. Of several writers exactly one gets true.
bool create_file_once(const std::string& path, std::span<const std::byte> bytes);

}  // namespace gazetrace
