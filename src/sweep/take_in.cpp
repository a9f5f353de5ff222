// SPDX-License-Identifier: Apache-2.0
#include "sweep/take_in.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/file_lock.hpp"
#include "gazetrace/error.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Where both lie on one disk nothing is copied: no file of a sweep is ever written into, only replaced.
void take_file(const fs::path& from, const fs::path& to) {
  if (fs::exists(to)) {
    return;
  }
  fs::create_directories(to.parent_path());
  std::error_code failed;
  fs::create_hard_link(from, to, failed);
  if (failed) {
    const fs::path part = to.parent_path() / ("." + to.filename().string() + ".part");
    fs::copy_file(from, part, fs::copy_options::overwrite_existing);
    fs::rename(part, to);
  }
}

// First the pictures, then the records that say that they are there.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files.push_back(entry.path());
    }
  }
  std::stable_partition(files.begin(), files.end(), [](const fs::path& path) { return path.extension() != ".json"; });
  return files;
}

void take_folder(const fs::path& from, const fs::path& to) {
  if (fs::is_directory(from)) {
    for (const fs::path& file : files_below(from)) {
      take_file(file, to / file.lexically_relative(from));
    }
  }
}

}  // namespace

void check_chunks_in(const std::string& folder) {
  if (!fs::is_regular_file(folder + "/state.json")) {
    throw Error(ErrorKind::input, folder, "holds no chunk of a sweep",
                "give the folders that the chunks were written to");
  }
  claim_directory(folder, kManyMachines);
}

void take_in(const std::string& folder, const std::string& directory) {
  if (fs::equivalent(folder, directory)) {
    return;
  }
  const FileLock lock(folder + "/lock", FileLock::Kind::alone, false);
  if (!lock.is_held()) {
    throw Error(ErrorKind::input, folder, "another sweep is at work there", "wait for it");
  }
  for (const char* name : {"runs", "frames"}) {
    take_folder(fs::path(folder) / name, fs::path(directory) / name);
  }
  const fs::path references = fs::path(folder) / "references";
  if (!fs::is_directory(references)) {
    return;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(references)) {
    const fs::path to = fs::path(directory) / "references" / entry.path().filename();
    take_folder(entry.path(), to);
  }
}

}  // namespace gazetrace
