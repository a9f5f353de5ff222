// SPDX-License-Identifier: Apache-2.0
#include "sweep/take_in.hpp"

#include <filesystem>
#include <optional>
#include <system_error>

#include "core/file_lock.hpp"
#include "gazetrace/error.hpp"
#include "sweep/sealed_json.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// Where both lie on one disk nothing is copied: no file of a sweep is ever written into, only replaced.
void take_file(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  const fs::path part = to.parent_path() / ("." + to.filename().string() + ".part");
  std::error_code failed;
  fs::remove(part, failed);
  fs::create_hard_link(from, part, failed);
  if (failed) {
    fs::copy_file(from, part, fs::copy_options::overwrite_existing);
  }
  fs::rename(part, to);
}

}  // namespace

void check_chunks_in(const SweepPlan& plan, const std::string& folder) {
  if (!fs::is_regular_file(folder + "/state.json")) {
    throw Error(ErrorKind::input, folder, "holds no chunk of a sweep",
                "give the folders that the chunks were written to");
  }
  claim_directory(plan, folder, kManyMachines);
}

void take_in(const std::string& folder, const std::string& directory) {
  if (fs::equivalent(folder, directory)) {
    return;
  }
  const FileLock lock(folder + "/lock", FileLock::Kind::alone, false);
  if (!lock.is_held()) {
    throw Error(ErrorKind::input, folder, "another sweep is at work there", "wait for it");
  }
  for (const std::string& record : sealed_records(folder)) {
    const std::string name = fs::path(record).lexically_relative(folder).string();
    const std::optional<WrittenFiles> pictures = files_of_record(record);
    if (!pictures || fs::exists(fs::path(directory) / name)) {
      continue;
    }
    // First the pictures, then the record that says that they are there. Those of other rows may be among them.
    for (const auto& [picture, file] : *pictures) {
      if (fs::exists(fs::path(folder) / picture)) {
        take_file(fs::path(folder) / picture, fs::path(directory) / picture);
      }
    }
    take_file(record, fs::path(directory) / name);
  }
}

}  // namespace gazetrace
