// SPDX-License-Identifier: Apache-2.0
// A lock on a file, which goes with the process that holds it, so that a killed one leaves none behind.
#pragma once

#include <cstdint>
#include <string>

namespace gazetrace {

class FileLock {
 public:
  enum class Kind : std::uint8_t { alone, shared };
  // Makes the file where it is not there. Where another process holds it, a lock that waits is held in the end, and one
  // that does not wait is_held() or not. Error(input) where the file cannot be made or locked.
  FileLock(const std::string& path, Kind kind, bool waits);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  [[nodiscard]] bool is_held() const { return file_ >= 0; }

 private:
  int file_ = -1;
};

}  // namespace gazetrace
