// SPDX-License-Identifier: Apache-2.0
// One sweep at a time in a directory. The lock goes with the process, so that a killed sweep leaves none behind.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "gazetrace/error.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

SweepDirectory::SweepDirectory(const std::string& path) {
  const std::string file = path + "/lock";
  lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) {
    throw Error(ErrorKind::input, file, "cannot be written: " + std::system_category().message(errno),
                "choose another `output` folder");
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const int problem = errno;
    ::close(std::exchange(lock_, -1));
    throw Error(ErrorKind::input, path,
                problem == EWOULDBLOCK ? "another sweep is at work there"
                                       : "cannot be locked: " + std::system_category().message(problem),
                "wait for it, or give another `output` folder");
  }
}

SweepDirectory::~SweepDirectory() {
  if (lock_ >= 0) {
    ::close(lock_);
  }
}

SweepDirectory::SweepDirectory(SweepDirectory&& other) noexcept : lock_(std::exchange(other.lock_, -1)) {}

}  // namespace gazetrace
