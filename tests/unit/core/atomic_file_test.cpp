// SPDX-License-Identifier: Apache-2.0
// Several that write the same file at once: two renders into one folder both write run.json.
#include "core/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "gazetrace/error.hpp"
#include "support/temporary_folder.hpp"

namespace {

// The functions below stand in for the system's, so that a test can have a file system without links that fails to
// rename.
bool file_system_refuses = false;

int refused(int error) {
  errno = error;
  return -1;
}

}  // namespace

extern "C" int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  return file_system_refuses ? refused(EPERM)
                             : static_cast<int>(::syscall(SYS_linkat, from_folder, from, to_folder, to, flags));
}
extern "C" int link(const char* from, const char* to) noexcept {
  return ::linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}
extern "C" int rename(const char* from, const char* to) noexcept {
  return file_system_refuses ? refused(EIO)
                             : static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace gazetrace::atomic_file_test {
namespace {

constexpr int kWriters = 4, kTimes = 300;

// `kTimes` files of 70000 bytes of one value; how many could not be written.
int write_often(const std::string& path, unsigned char value) {
  const std::vector<std::byte> bytes(70000, std::byte{value});
  int failed = 0;
  for (int i = 0; i < kTimes; ++i) {
    try {
      write_bytes_atomically(path, bytes);
    } catch (const Error&) {
      ++failed;
    }
  }
  return failed;
}

void expect_one_writers_file(const TemporaryFolder& folder) {
  EXPECT_EQ(folder.names(), std::vector<std::string>{"run.json"});
  const std::string bytes = file_bytes(folder / "run.json");
  ASSERT_EQ(bytes.size(), 70000U);
  EXPECT_EQ(bytes, std::string(70000, bytes[0]));
}

TEST(AtomicFile, ThreadsMayWriteTheSameFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  std::vector<int> failed(kWriters);
  std::vector<std::thread> threads;
  for (int i = 0; i < kWriters; ++i) {
    threads.emplace_back(
        [&, i] { failed[static_cast<std::size_t>(i)] = write_often(path, static_cast<unsigned char>(i)); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(failed, std::vector<int>(kWriters));
  expect_one_writers_file(folder);
}

TEST(AtomicFile, ProcessesMayWriteTheSameFile) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  std::vector<pid_t> children;
  for (int i = 0; i < kWriters; ++i) {
    children.push_back(::fork());
    if (children.back() == 0) {
      ::_exit(write_often(path, static_cast<unsigned char>(i)) == 0 ? 0 : 1);
    }
  }
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  expect_one_writers_file(folder);
}

TEST(AtomicFile, AProcessThatIsKilledWhileItWritesLeavesNothing) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  const int unnamed = ::open(path.substr(0, path.rfind('/')).c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0600);
  if (unnamed < 0) {
    GTEST_SKIP() << "this file system has no files without names";
  }
  ::close(unnamed);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_DFL);
    const rlimit few{4096, 4096};  // the system kills who writes more
    ::setrlimit(RLIMIT_FSIZE, &few);
    ::_exit(write_often(path, 1));
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGXFSZ);
  EXPECT_EQ(folder.names(), std::vector<std::string>());
}

// Of many that begin at the same moment one makes the file, and all others find it whole.
TEST(AtomicFile, AFileThatIsMadeOnceHasOneWriter) {
  for (int round = 0; round < 50; ++round) {
    const TemporaryFolder folder;
    const std::string path = folder / "borders.json";
    std::vector<int> made(kWriters);
    std::vector<std::string> found(kWriters);
    std::vector<std::thread> threads;
    for (int i = 0; i < kWriters; ++i) {
      threads.emplace_back([&, i] {
        const auto at = static_cast<std::size_t>(i);
        const std::vector<std::byte> bytes(5000, static_cast<std::byte>(i));
        made[at] = create_file_once(path, bytes) ? 1 : 0;
        found[at] = file_bytes(path);
      });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    EXPECT_EQ(std::accumulate(made.begin(), made.end(), 0), 1);
    const auto winner = static_cast<char>(std::find(made.begin(), made.end(), 1) - made.begin());
    EXPECT_EQ(found, std::vector<std::string>(kWriters, std::string(5000, winner)));
    EXPECT_EQ(folder.names(), std::vector<std::string>{"borders.json"});
  }
}

TEST(AtomicFile, AFileThatCannotBePutInPlaceLeavesItsNameFree) {
  const TemporaryFolder folder;
  const std::string path = folder / "borders.json";
  file_system_refuses = true;
  EXPECT_THROW((void)create_file_once(path, std::vector<std::byte>(5000)), Error);
  file_system_refuses = false;
  EXPECT_EQ(folder.names(), std::vector<std::string>());
  EXPECT_TRUE(create_file_once(path, std::vector<std::byte>(5000)));
}

}  // namespace
}  // namespace gazetrace::atomic_file_test
