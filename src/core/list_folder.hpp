// SPDX-License-Identifier: Apache-2.0
// What a folder holds. The loops of std::filesystem over a folder throw an exception of their own where reading goes
// wrong after it has begun, as on a network file system, even those that were given an error code.
#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace gazetrace {

// `folder` / name of everything in it, in the order of names; an empty `folder` is the working folder, "." / name.
// Where it cannot be listed, or not to its end, `failed` says why, and what was read until then is returned.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder, std::error_code& failed);
// The same; Error(input) where it cannot be listed to its end.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);
// The same; nothing where there is no such folder.
std::vector<std::filesystem::path> list_folder_if_there(const std::filesystem::path& folder);

}  // namespace gazetrace
