// SPDX-License-Identifier: Apache-2.0
#include "core/list_folder.hpp"

#include <algorithm>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> listed(const fs::path& folder, bool must_be_there) {
  std::error_code failed;
  std::vector<fs::path> paths = list_folder(folder, failed);
  const bool absent = failed == std::errc::no_such_file_or_directory || failed == std::errc::not_a_directory;
  if (failed && (must_be_there || !absent)) {
    throw Error(ErrorKind::input, folder.empty() ? "." : folder.string(), "cannot be listed: " + failed.message(),
                "check that the folder is there and may be read");
  }
  return paths;
}

}  // namespace

std::vector<fs::path> list_folder(const fs::path& folder, std::error_code& failed) {
  std::vector<fs::path> paths;
  for (fs::directory_iterator at(folder.empty() ? fs::path(".") : folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    paths.push_back(at->path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<fs::path> list_folder(const fs::path& folder) {
  return listed(folder, true);
}

std::vector<fs::path> list_folder_if_there(const fs::path& folder) {
  return listed(folder, false);
}

}  // namespace gazetrace
