// SPDX-License-Identifier: Apache-2.0
// The file `.gazetrace.lock` of a folder, in which a run locks positions that stand for names of files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace gazetrace {

std::string lock_path(const std::string& folder);

// Where a folder's lock is held for a file, by its name from that folder on. The longest number of the file's own name,
// the last of several, counts positions, so that the frames of a sequence lie side by side; what else is in the name
// decides where they begin. The same number elsewhere in it, as in the names of folders, decides nothing.
std::int64_t lock_position(const std::string& name);

class FolderLock {
 public:
  using Files = std::map<std::int64_t, std::string>;  // what messages call them, by their positions
  enum class Use : std::uint8_t { claim, look };

  // Who claims makes the file where it is not there, and waits for nothing. Error(input) where that cannot be.
  FolderLock(const std::string& folder, Use use);
  ~FolderLock();  // gives back what it has claimed
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  // False where this file system has no locks. Error(runtime) that names the owner where another run holds one.
  [[nodiscard]] bool claim(const Files& files) const;
  void check(const Files& files) const;  // the error of claim(), and no claim
  // Whether a run has claimed this file of the folder; nothing where that cannot be told.
  [[nodiscard]] std::optional<bool> holds(const std::string& name) const;

 private:
  int file_ = -1;  // as the system numbers open files
  bool is_claim_ = false;
  int problem_ = 0;  // why it is not open
};

}  // namespace gazetrace
