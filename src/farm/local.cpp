// SPDX-License-Identifier: Apache-2.0
// The tasks of a farm as processes of this machine.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>
#include <map>
#include <thread>
#include <utility>

#include "farm/engine.hpp"
#include "gazetrace/error.hpp"

extern char** environ;  // NOLINT: POSIX

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kLook{50};
constexpr int kInterrupted = 4;

// In a process group of its own, so that an interrupt from the keyboard reaches it through us alone; what it says goes
// to the task's log.
pid_t start(const FarmPlan& plan, const std::string& task) {
  const std::string script = task_script_path(plan);
  const std::string log = (fs::path(plan.folder) / "logs" / (task + ".log")).string();
  std::vector<std::string> words{"sh", script, task};
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1, SIGXCPU, SIGHUP, SIGPIPE}) {
    sigaddset(&usual, signal);
  }
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = -1;
  const int problem = ::posix_spawnp(&child, "sh", &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) {
    throw Error(ErrorKind::runtime, script, std::string("cannot be started: ") + std::strerror(problem));
  }
  return child;
}

// The exit code of a process that has ended, as the shell tells it; empty while it runs.
std::optional<int> ended(pid_t child) {
  int state = 0;
  const pid_t found = ::waitpid(child, &state, WNOHANG);
  if (found == 0 || (found < 0 && errno == EINTR)) {
    return std::nullopt;
  }
  return found < 0 ? 3 : WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
}

// By chance or from outside; what is wrong with the input is wrong the next time, too.
bool may_be_tried_again(int code) {
  return code == 3 || code == kInterrupted || code > 128;
}

// A task that goes on by itself (4) is better than one that has failed, whatever its number.
int worse_of(int a, int b) {
  return a == 0 || (a == kInterrupted && b != 0) ? b : b == 0 || b == kInterrupted ? a : std::max(a, b);
}

class Runner {
 public:
  Runner(const FarmPlan& plan, const LocalSettings& settings) : plan_(plan), settings_(settings) {}
  ~Runner() {
    for (const auto& [child, task] : running_) {  // an error ends the farm: nobody waits for them any more
      ::kill(child, SIGTERM);
    }
  }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  // The worst exit code, see worse_of(). Whatever is waiting is begun, as many at a time as are wanted.
  int run(std::deque<std::string> waiting) {
    int worst = 0;
    bool stopped = false;
    while (!running_.empty() || (!waiting.empty() && !stopped)) {
      if (!stopped && settings_.stop && settings_.stop()) {
        stopped = true;
        for (const auto& [child, task] : running_) {
          ::kill(child, SIGTERM);
        }
      }
      while (!stopped && !waiting.empty() &&
             running_.size() < static_cast<std::size_t>(std::max(settings_.processes, 1))) {
        const std::string task = waiting.front();
        waiting.pop_front();
        tell(task, "begins");
        running_.emplace(start(plan_, task), task);
      }
      worst = worse_of(worst, collect(stopped, waiting));
      std::this_thread::sleep_for(kLook);
    }
    return stopped ? kInterrupted : worst;
  }

 private:
  int collect(bool stopped, std::deque<std::string>& waiting) {
    int worst = 0;
    for (auto at = running_.begin(); at != running_.end();) {
      const std::optional<int> code = ended(at->first);
      if (!code) {
        ++at;
        continue;
      }
      const std::string task = at->second;
      at = running_.erase(at);
      const bool again = *code != 0 && !stopped && may_be_tried_again(*code) && tries_[task] < plan_.retries;
      tell(task, fmt::format("exit code {}{}", *code, again ? ", tried again" : ""));
      if (again) {
        ++tries_[task];
        waiting.push_back(task);
      } else if (*code != 0) {
        worst = worse_of(worst, *code);
      }
    }
    return worst;
  }

  void tell(const std::string& task, const std::string& what) const {
    if (settings_.tell) {
      settings_.tell(task, what);
    }
  }

  const FarmPlan& plan_;
  const LocalSettings& settings_;
  std::map<pid_t, std::string> running_;
  std::map<std::string, int> tries_;
};

}  // namespace

FileLock lock_farm(const FarmPlan& plan) {
  FileLock lock((fs::path(plan.folder) / "tasks" / "local.lock").string(), FileLock::Kind::alone, false);
  if (!lock.is_held()) {
    throw Error(ErrorKind::runtime, plan.folder, "another 'gazetrace farm' runs these tasks", "wait for it or end it");
  }
  return lock;
}

int run_local(const FarmPlan& plan, const std::vector<std::size_t>& chunks, const LocalSettings& settings) {
  const FileLock alone = lock_farm(plan);
  Runner runner(plan, settings);
  std::deque<std::string> tasks;
  for (const std::size_t chunk : chunks) {
    tasks.push_back(std::to_string(chunk + 1));
  }
  if (const int code = runner.run(std::move(tasks)); code != 0) {
    return code;
  }
  for (const std::string& task : tasks_after_chunks(plan)) {
    if (const int code = runner.run({task}); code != 0) {
      return code;
    }
  }
  return 0;
}

}  // namespace gazetrace
