// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/run_lock.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

constexpr int kHeldAlone = 0, kRefused = 1, kHeldTogether = 2;

RunRecord frames_of_a_run() {
  RunRecord record;
  record.frames = "1-3";
  return record;
}

// A process that dies with the lock in its hands.
void leave_lock_behind(const std::string& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    const RunLock lock(frames_of_a_run(), path);
    ::_exit(0);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
}

// What became of a process that wants the lock as soon as `gate` ends. While it has it, a mark of its own making
// stands.
int want_lock(int gate, const std::string& path, const std::string& mark) {
  char nothing = 0;
  static_cast<void>(::read(gate, &nothing, 1));
  try {
    const RunLock lock(frames_of_a_run(), path);
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

TEST(RunLock, OfManyThatFindADeadRunOneAtATimeTakesItOver) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.json";
  for (int round = 0; round < 40; ++round) {
    leave_lock_behind(path);
    std::array<int, 2> gate{};
    ASSERT_EQ(::pipe(gate.data()), 0);
    std::vector<pid_t> wanting(12);
    for (pid_t& child : wanting) {
      child = ::fork();
      if (child == 0) {
        ::close(gate[1]);
        ::_exit(want_lock(gate[0], path, folder / "mark"));
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

}  // namespace
}  // namespace gazetrace
