// SPDX-License-Identifier: Apache-2.0
// What a file may lead to: names that stand in data must not lead out of the data set that they are part of.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gazetrace {

// The folders that files named by `path`, a file that the user named, may lie in: its own folder, and that of the file
// that it is a symbolic link to. Where one of these belongs to a data set, that one's root in its place: the nearest
// folder upwards that holds a dataset_description.json (BIDS), a .datalad or a .git/annex; the store of the annex lies
// in it, or where .git says. The folders have no symbolic links in them.
std::vector<std::filesystem::path> data_roots(const std::string& path);

// Error(input) at `place` where the file `named`, with all symbolic links followed, lies outside of these roots.
// `words` is what the data says. The file need not exist, and is not opened.
void check_within(const std::vector<std::filesystem::path>& roots, const std::string& named, const std::string& words,
                  const std::string& place,
                  const std::string& remedy = "copy the file there, or give `allow-outside` where you trust the data");

// The file that a uri in the file `path` names, relative to the folder of that. Percent escapes are decoded (RFC 3986,
// section 2.1). Where nothing has that name, backslashes in it separate folders, as on Windows.
std::string file_of_uri(const std::string& path, std::string_view uri);
std::string percent_decoded(std::string_view uri);

}  // namespace gazetrace
