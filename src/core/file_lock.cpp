// SPDX-License-Identifier: Apache-2.0
#include "core/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {

FileLock::FileLock(const std::string& path, Kind kind, bool waits) {
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) {
    throw Error(ErrorKind::input, path, "cannot be written: " + std::system_category().message(errno),
                "choose another `output` folder");
  }
  const int operation = (kind == Kind::alone ? LOCK_EX : LOCK_SH) | (waits ? 0 : LOCK_NB);
  int result = 0;
  do {
    result = ::flock(file_, operation);
  } while (result != 0 && errno == EINTR);
  if (result != 0) {
    const int problem = errno;
    ::close(std::exchange(file_, -1));
    if (problem != EWOULDBLOCK) {
      throw Error(ErrorKind::input, path, "cannot be locked: " + std::system_category().message(problem),
                  "choose another `output` folder");
    }
  }
}

FileLock::~FileLock() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

FileLock::FileLock(FileLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

}  // namespace gazetrace
