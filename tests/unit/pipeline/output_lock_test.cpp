// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/output_lock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <numeric>
#include <vector>

#include "support/temporary_folder.hpp"

namespace gazetrace::output_lock_test {
namespace {

namespace fs = std::filesystem;

// Pictures go to one folder, and what tells of the run to another.
PipelineSettings run_of(const std::string& pattern, const std::string& record_folder) {
  PipelineSettings settings;
  settings.output.display.pattern = pattern;
  settings.output.run_name = record_folder + "/";
  return settings;
}

// The message of the refusal; empty: the claim is granted.
std::string refusal(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  try {
    const OutputLock lock = lock_outputs(settings, frames);
    return {};
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::runtime) << error.what();
    return error.what();
  }
}

// How a process ends that does this; what it returns is its exit code.
int in_another_process(const std::function<int()>& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(act());
  }
  int state = 0;
  EXPECT_EQ(::waitpid(child, &state, 0), child);
  return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
}

class OutputLocks : public testing::Test {
 protected:
  OutputLocks() {
    for (const char* name : {"a", "b", "record", "other"}) {
      fs::create_directory(folder / name);
    }
    fs::create_directory_symlink(folder / "a", folder / "link");
  }
  TemporaryFolder folder;
};

TEST_F(OutputLocks, TheSameFilesBySomeOtherNameAreRefused) {
  const OutputLock held = lock_outputs(run_of(folder / "a/f.####.png", folder / "record"), {3, 4, 5});
  for (const char* name : {"a/f.####.png", "a/f.%04d.png", "link/f.####.png", "b/../a/f.####.png", "a//f.%04d.png"}) {
    const std::string message = refusal(run_of(folder / name, folder / "other"), {5, 6});
    EXPECT_NE(message.find("f.0005.png"), std::string::npos) << name << message;
    EXPECT_NE(message.find("process " + std::to_string(::getpid())), std::string::npos) << message;
  }
  EXPECT_NE(refusal(run_of(folder / "a/f.0004.png", folder / "other"), {1}), "");
}

TEST_F(OutputLocks, OtherFilesOfTheFolderAreFree) {
  const OutputLock held = lock_outputs(run_of(folder / "a/f.####.png", folder / "record"), {3, 4, 5});
  for (const char* name : {"a/g.####.png", "a/f.####.jpg", "a/f2.####.png", "b/f.####.png"}) {
    EXPECT_EQ(refusal(run_of(folder / name, folder / "other"), {3, 4, 5}), "") << name;
  }
  EXPECT_EQ(refusal(run_of(folder / "a/f.####.png", folder / "other"), {1, 2, 6, 7}), "");
}

TEST_F(OutputLocks, RecordsOfWholeRunsAreOneFileAndThoseOfPartsAreNot) {
  PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  const OutputLock held = lock_outputs(run, {1, 2});
  const std::string message = refusal(run, {3, 4});
  EXPECT_TRUE(message.starts_with(folder / "a/run.json") || message.starts_with(folder / "a/timing.csv")) << message;
  run.is_part = true;
  EXPECT_EQ(refusal(run, {3, 4}), "");
  EXPECT_NE(refusal(run, {2, 3}), "");
}

TEST_F(OutputLocks, MapsAreHeldToo) {
  PipelineSettings run = run_of(folder / "a/f.####.png", folder / "record");
  run.output.map_pattern = folder / "b/m.####.exr";
  const OutputLock held = lock_outputs(run, {1, 2});
  EXPECT_NE(refusal(run_of(folder / "b/m.%04d.exr", folder / "other"), {2}), "");
}

TEST_F(OutputLocks, FramesWithFoldersOfTheirOwnHaveOneLock) {
  const PipelineSettings run = run_of(folder / "a/%04d/f.%04d.png", folder / "record");
  const OutputLock held = lock_outputs(run, {1, 2, 3});
  EXPECT_NE(refusal(run_of(folder / "link/<frame>/f.<frame>.png", folder / "other"), {2}), refusal(run, {4}));
  EXPECT_NE(refusal(run, {3}), "");
  EXPECT_FALSE(fs::exists(folder / "a/0001"));
}

TEST_F(OutputLocks, AFramesOwnFolderIsTheSameByEitherSpelling) {
  fs::create_directories(folder / "a/0002");
  fs::create_directory_symlink(folder / "b", folder / "a/0003");
  const PipelineSettings run = run_of(folder / "a/%04d/f.%04d.png", folder / "record");
  const PipelineSettings second = run_of(folder / "link/0002/f.####.png", folder / "other");
  const PipelineSettings third = run_of(folder / "b/f.####.png", folder / "other");
  {
    const OutputLock held = lock_outputs(run, {1, 2, 3, 4});
    EXPECT_NE(refusal(second, {2}).find("f.0002.png"), std::string::npos);
    EXPECT_EQ(refusal(second, {1, 3}), "");
    EXPECT_NE(refusal(third, {3}).find("f.0003.png"), std::string::npos);
    EXPECT_EQ(refusal(third, {2}), "");
    const std::string text = file_bytes(folder / "a/.gazetrace.lock");
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
    EXPECT_LE(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("process")), ' '), 4)
        << "frames with folders of their own are held as a range, too: " << text;
  }
  const OutputLock held = lock_outputs(second, {2});
  EXPECT_NE(refusal(run, {1, 2}).find("f.0002.png"), std::string::npos);
  EXPECT_EQ(refusal(run, {1}), "");
}

// The kernel looks through all ranges for each that is added, so that their number has a limit.
TEST_F(OutputLocks, OfVeryManyRangesAFewAreHeld) {
  std::vector<std::int32_t> odd(20000);
  std::generate(odd.begin(), odd.end(), [frame = -1]() mutable { return frame += 2; });
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "record");
  const OutputLock held = lock_outputs(run, odd);
  const std::string text = file_bytes(folder / "a/.gazetrace.lock");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_LE(std::count(text.begin(), text.end(), ' '), 4000 + 40);
  for (const std::int32_t frame : {1, 20001, 39999}) {
    EXPECT_NE(refusal(run_of(folder / "a/f.####.png", folder / "other"), {frame}), "") << frame;
  }
  EXPECT_EQ(refusal(run_of(folder / "a/f.####.png", folder / "other"), {40001}), "");
}

// Wherever the frame's number stands in the name, all other frames and sequences stay free: of few names alone none
// might lie where ranges were joined.
TEST_F(OutputLocks, ManyFramesHoldNothingOfOthers) {
  std::vector<std::int32_t> first(2500);
  std::iota(first.begin(), first.end(), 1);
  std::vector<std::int32_t> second(2500);
  std::iota(second.begin(), second.end(), 2501);
  for (const char* name : {"a/f.####.cam1.png", "a/f.####.v2024.png"}) {
    const OutputLock held = lock_outputs(run_of(folder / name, folder / "record"), first);
    EXPECT_NE(refusal(run_of(folder / name, folder / "other"), {2500}), "") << name;
    EXPECT_EQ(refusal(run_of(folder / name, folder / "other"), second), "") << name;
    for (const char* foreign : {"a/g.####.v2024.png", "a/f.####.cam2.png", "a/f.####.png"}) {
      EXPECT_EQ(refusal(run_of(folder / foreign, folder / "other"), first), "") << name << foreign;
    }
  }
}

// It may be stopped for days while it writes down its name.
TEST_F(OutputLocks, ARunThatIsStoppedAtTheTextHoldsUpNobody) {
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  std::ofstream(folder / "a/.gazetrace.lock").close();
  const int file = ::open((folder / "a/.gazetrace.lock").c_str(), O_RDWR | O_CLOEXEC);
  struct flock text {};
  text.l_type = F_WRLCK;
  text.l_start = off_t{1} << 62U;
  text.l_len = 1;
  ASSERT_EQ(::fcntl(file, F_OFD_SETLK, &text), 0);
  const int ended = in_another_process([&] {
    ::alarm(60);
    const OutputLock lock = lock_outputs(run, {1});
    return refusal(run, {1}).empty() ? 1 : 0;
  });
  EXPECT_EQ(ended, 0);
  ::close(file);
}

TEST_F(OutputLocks, WhoeverHoldsItIsNamedAndNobodyAfterwards) {
  std::vector<std::int32_t> frames(10000);
  std::iota(frames.begin(), frames.end(), 1);
  {
    const OutputLock held = lock_outputs(run_of(folder / "a/f.####.png", folder / "a"), frames);
    const std::string text = file_bytes(folder / "a/.gazetrace.lock");
    EXPECT_NE(text.find("process " + std::to_string(::getpid()) + " on "), std::string::npos);
    EXPECT_NE(text.find(program_invocation_short_name), std::string::npos) << text;
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 4) << "a sequence is held as one range";
    EXPECT_EQ(is_locked(folder / "a/run.json"), true);
    EXPECT_EQ(is_locked(folder / "a/run.1-3.json"), false);
  }
  EXPECT_EQ(is_locked(folder / "a/run.json"), false);
  EXPECT_EQ(file_bytes(folder / "a/.gazetrace.lock"), "");
}

TEST_F(OutputLocks, ARunThatWasKilledHoldsUpNobody) {
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  const int ended = in_another_process([&] {
    const OutputLock lock = lock_outputs(run, {1, 2});
    return ::raise(SIGKILL);
  });
  EXPECT_EQ(ended, -SIGKILL);
  EXPECT_NE(file_bytes(folder / "a/.gazetrace.lock"), "") << "it had no time to take its name out";
  EXPECT_EQ(is_locked(folder / "a/run.json"), false);
  EXPECT_EQ(refusal(run, {1, 2}), "");
}

TEST_F(OutputLocks, AChildThatLivesOnHoldsNothing) {
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  std::array<int, 2> gate{};
  ASSERT_EQ(::pipe(gate.data()), 0);
  pid_t child = 0;
  {
    const OutputLock lock = lock_outputs(run, {1, 2});
    child = ::fork();
    if (child == 0) {
      char nothing = 0;
      ::close(gate[1]);
      static_cast<void>(::read(gate[0], &nothing, 1));
      ::_exit(0);
    }
  }
  EXPECT_EQ(refusal(run, {1, 2}), "");
  ::close(gate[0]);
  ::close(gate[1]);
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
}

// Files that others could put there to have something else written over.
TEST_F(OutputLocks, WhatIsNoLockIsLeftAlone) {
  const std::string precious = folder / "precious";
  std::ofstream(precious) << "text";
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  fs::create_symlink(precious, folder / "a/.gazetrace.lock");
  EXPECT_THROW(lock_outputs(run, {1}), Error);
  EXPECT_EQ(file_bytes(precious), "text");
  fs::remove(folder / "a/.gazetrace.lock");
  ASSERT_EQ(::mkfifo((folder / "a/.gazetrace.lock").c_str(), 0666), 0);  // to open it could take for ever
  EXPECT_THROW(lock_outputs(run, {1}), Error);
  EXPECT_EQ(is_locked(folder / "a/run.json"), false);
}

constexpr int kHeldAlone = 0, kRefused = 1, kHeldTogether = 2;

// What became of a process that wants the lock as soon as `gate` ends. While it has it, a mark of its own making
// stands.
int want_lock(int gate, const PipelineSettings& run, const std::string& mark) {
  char nothing = 0;
  static_cast<void>(::read(gate, &nothing, 1));
  try {
    const OutputLock lock = lock_outputs(run, {1, 2, 3});
    const int file = ::open(mark.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (file < 0) {
      return kHeldTogether;
    }
    ::usleep(2000);
    ::unlink(mark.c_str());
    ::close(file);
    return kHeldAlone;
  } catch (const Error&) {
    return kRefused;
  }
}

TEST_F(OutputLocks, OfManyThatComeAtOnceOneAtATimeHasIt) {
  const PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  for (int round = 0; round < 20; ++round) {
    std::array<int, 2> gate{};
    ASSERT_EQ(::pipe(gate.data()), 0);
    std::vector<pid_t> wanting(12);
    for (pid_t& child : wanting) {
      child = ::fork();
      if (child == 0) {
        ::close(gate[1]);
        ::_exit(want_lock(gate[0], run, folder / "mark"));
      }
    }
    ::close(gate[0]);
    ::close(gate[1]);
    std::array<int, 3> outcomes{};
    for (const pid_t child : wanting) {
      int state = 0;
      ASSERT_EQ(::waitpid(child, &state, 0), child);
      ASSERT_TRUE(WIFEXITED(state) && WEXITSTATUS(state) <= kHeldTogether) << state;
      ++outcomes.at(WEXITSTATUS(state));
    }
    ASSERT_GE(outcomes[kHeldAlone], 1) << "round " << round;
    ASSERT_EQ(outcomes[kHeldTogether], 0) << "round " << round;
  }
}

// From then on this process finds no file system that locks: the kernel answers as one that has no locks.
bool take_locks_away(int answer) {
  std::array<sock_filter, 6> program{{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_fcntl, 0, 3),
                                      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[1])),
                                      BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, F_OFD_GETLK, 0, 1),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<unsigned>(answer)),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)}};
  const sock_fprog filter{program.size(), program.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

TEST_F(OutputLocks, WhereNothingCanBeLockedItIsSaidOnceForEachFolder) {
  PipelineSettings run = run_of(folder / "a/f.####.png", folder / "a");
  run.output.map_pattern = folder / "b/m.####.exr";
  for (const int answer : {ENOLCK, EOPNOTSUPP, ENOSYS}) {
    const int lines = in_another_process([&] {
      if (!take_locks_away(answer)) {
        return 100;
      }
      const OutputLock lock = lock_outputs(run, {1, 2});
      const bool said = lock.warnings().size() == 2 && lock.warnings()[0].starts_with(folder / "a") &&
                        lock.warnings()[1].starts_with(folder / "b");
      return said && is_locked(folder / "a/run.json") == std::nullopt ? 2 : 0;
    });
    if (lines == 100) {
      GTEST_SKIP() << "system calls cannot be filtered here";
    }
    EXPECT_EQ(lines, 2) << answer;
  }
}

}  // namespace
}  // namespace gazetrace::output_lock_test
