// SPDX-License-Identifier: Apache-2.0
#include "core/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw Error(ErrorKind::runtime, path, std::string(what) + ": " + std::generic_category().message(error),
              error == ENOSPC ? "free some space and run again (a render: with `resume`)" : "check the folder");
}

constexpr int kMaxAttempts = 1000;

// A file that is being written. Where the file system can hold a file without a name, it has none until it is complete,
// so that a process that is killed leaves nothing behind; elsewhere it has a temporary name.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& final_path) : final_path_(final_path) {
    const std::string folder = std::filesystem::path(final_path).parent_path().string();
    if (::access("/proc/self/fd", X_OK) == 0) {
      descriptor_ = ::open(folder.empty() ? "." : folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    }
    if (descriptor_ < 0) {
      take_name([&](const char* name) {
        descriptor_ = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        return descriptor_ >= 0;
      });
    }
  }
  // Removes the file unless it has its final name.
  ~TemporaryFile() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    if (!temporary_.empty()) {
      ::unlink(temporary_.c_str());
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) {
        continue;
      }
      if (written <= 0) {
        fail(final_path_, "cannot write the file", written < 0 ? errno : EIO);
      }
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  // Onto the disk, before it has its name: after a loss of power what has a name is whole.
  void flush() const {
    if (::fsync(descriptor_) != 0 && errno != EINVAL &&
        errno != ENOTSUP) {  // file systems that cannot have no more to give
      fail(final_path_, "cannot write the file", errno);
    }
  }

  // False where there is a file of the final name.
  bool put_in_place_once() {
    if (temporary_.empty() ? link_unnamed(final_path_.c_str()) : ::link(temporary_.c_str(), final_path_.c_str()) == 0) {
      return true;
    }
    if (errno == EEXIST) {
      return false;
    }
    // A file system without links: the name is taken first, and the file under it replaced at once.
    const int taken = ::open(final_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (taken < 0) {
      if (errno == EEXIST) {
        return false;
      }
      fail(final_path_, "cannot create the file", errno);
    }
    ::close(taken);
    try {
      put_in_place();
    } catch (...) {  // an empty file under the name would look as if another writer had made it
      ::unlink(final_path_.c_str());
      throw;
    }
    return true;
  }

  void put_in_place() {
    if (temporary_.empty()) {
      const auto link_to = [this](const char* name) { return link_unnamed(name); };
      if (link_to(final_path_.c_str())) {
        return;
      }
      if (errno != EEXIST) {
        fail(final_path_, "cannot put the finished file in place", errno);
      }
      take_name(link_to);  // a link cannot replace an existing file, but a rename can
    }
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) {  // network file systems report a full disk here
      fail(final_path_, "cannot write the file", errno);
    }
    if (::rename(temporary_.c_str(), final_path_.c_str()) != 0) {
      fail(final_path_, "cannot put the finished file in place", errno);
    }
    temporary_.clear();
  }

 private:
  [[nodiscard]] bool link_unnamed(const char* name) const {
    const std::string unnamed = "/proc/self/fd/" + std::to_string(descriptor_);
    return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
  }
  // Takes the first free name: another thread, another process, or a process of the same number on another machine that
  // shares the folder may have taken some.
  template <class Make>
  void take_name(const Make& make) {
    for (int attempt = 0; temporary_.empty(); ++attempt) {
      const std::string name = temporary_name(final_path_, attempt).string();
      if (make(name.c_str())) {
        temporary_ = name;
      } else if (errno != EEXIST || attempt == kMaxAttempts) {
        fail(final_path_, "cannot create the file", errno);
      }
    }
  }

  std::string final_path_;
  std::string temporary_;  // the temporary name; empty: there is no file under one
  int descriptor_ = -1;
};

// Its names. Where a folder cannot be flushed, as in some network file systems, names reach the disk with the files.
void flush_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int file = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file >= 0) {
    ::fsync(file);
    ::close(file);
  }
}

}  // namespace

std::filesystem::path temporary_name(const std::filesystem::path& path, int attempt) {
  constexpr std::size_t kLongestStem = 200;  // with what follows, a name that every file system holds
  const std::string number = std::to_string(::getpid()) + (attempt == 0 ? "" : "-" + std::to_string(attempt));
  std::filesystem::path name = path;
  return name.replace_filename("." + path.stem().string().substr(0, kLongestStem) + "." + number + ".part" +
                               path.extension().string());
}

void refuse_impossible_file(const std::string& path) {
  constexpr std::size_t kLongestName = 255;
  for (const std::filesystem::path& part : std::filesystem::path(path)) {
    if (const std::size_t bytes = part.string().size(); bytes > kLongestName) {
      throw Error(ErrorKind::input, bounded(path),
                  "a name in it has " + std::to_string(bytes) + " bytes, and file systems hold 255",
                  "give a shorter one");
    }
  }
  std::error_code problem;
  if (std::filesystem::is_other(path, problem)) {
    throw Error(ErrorKind::input, path, "is a device, pipe or socket, which no file replaces", "choose another name");
  }
  if (std::filesystem::is_directory(path, problem)) {
    throw Error(ErrorKind::input, path, "a folder is in the place of this file", "remove it or choose another name");
  }
}

bool create_file_once(const std::string& path, std::span<const std::byte> bytes) {
  TemporaryFile file(path);
  file.write(bytes);
  file.flush();
  const bool is_ours = file.put_in_place_once();
  flush_folder_of(path);
  return is_ours;
}

void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes) {
  refuse_impossible_file(path);
  TemporaryFile file(path);
  file.write(bytes);
  file.flush();
  file.put_in_place();
  flush_folder_of(path);
}

void put_file_in_place(const std::string& temporary, const std::string& path) {
  const int file = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  const int flushed = file < 0 ? -1 : ::fsync(file);
  const int problem = errno;
  if (file >= 0) {
    ::close(file);
  }
  if (flushed != 0 && problem != EINVAL && problem != ENOTSUP) {
    fail(path, "cannot write the file", problem);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    fail(path, "cannot put the finished file in place", errno);
  }
  flush_folder_of(path);
}

}  // namespace gazetrace
