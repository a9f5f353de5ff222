// SPDX-License-Identifier: Apache-2.0
#include "output/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw Error(ErrorKind::runtime, path, std::string(what) + ": " + std::generic_category().message(error),
              error == ENOSPC ? "free some space and run again with --resume" : "check the output folder");
}

constexpr int kMaxAttempts = 1000;

std::filesystem::path temporary_name(const std::filesystem::path& path, int attempt) {
  const std::string number = std::to_string(::getpid()) + (attempt == 0 ? "" : "-" + std::to_string(attempt));
  std::filesystem::path name = path;
  return name.replace_filename("." + path.stem().string() + "." + number + ".part" + path.extension().string());
}

// Removes the temporary file unless it was renamed, and closes the descriptor in any case.
class TemporaryFile {
 public:
  // The first name that nobody has: not another thread's, another process's, or one of the same number on another
  // machine that shares the folder.
  explicit TemporaryFile(const std::string& final_path) : final_path_(final_path) {
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      temporary_ = temporary_name(final_path, attempt);
      descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && (errno != EEXIST || attempt == kMaxAttempts)) {
        fail(final_path_, "cannot create the file", errno);
      }
    }
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    if (!renamed_) {
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

  void rename() {
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) {  // network file systems report a full disk here
      fail(final_path_, "cannot write the file", errno);
    }
    if (::rename(temporary_.c_str(), final_path_.c_str()) != 0) {
      fail(final_path_, "cannot put the finished file in place", errno);
    }
    renamed_ = true;
  }

 private:
  std::string final_path_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

}  // namespace

void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes) {
  TemporaryFile file(path);
  file.write(bytes);
  file.rename();
}

void write_text_atomically(const std::string& path, const std::string& text) {
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
