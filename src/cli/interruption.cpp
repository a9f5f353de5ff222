// SPDX-License-Identifier: Apache-2.0
#include "cli/interruption.hpp"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <utility>

#include "cli/exit_codes.hpp"

namespace gazetrace {
namespace {

constexpr std::array<std::pair<int, const char*>, 5> kSignals{
    {{SIGTERM, "TERM"}, {SIGINT, "INT"}, {SIGHUP, "HUP"}, {SIGUSR1, "USR1"}, {SIGXCPU, "XCPU"}}};

// Of nohup: a blocked signal would be told of all the same.
bool is_ignored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;  // NOLINT: a union of POSIX
}

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  for (const auto& [signal, name] : kSignals) {
    if (signal != SIGHUP || !is_ignored(signal)) {
      sigaddset(&set, signal);
    }
  }
  return set;
}

std::string name_of(int number) {
  for (const auto& [signal, name] : kSignals) {
    if (signal == number) {
      return std::string("signal ") + name;
    }
  }
  return "a signal";
}

// As if nobody had watched.
void end_at_once(int signal) {
  std::signal(signal, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  ::raise(signal);
}

}  // namespace

void hold_signals() {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void let_signals_go() {
  const sigset_t set = watched();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

Interruption::Interruption(std::chrono::nanoseconds grace, std::optional<std::chrono::nanoseconds> max_time)
    : grace_(std::chrono::duration_cast<Clock::duration>(grace)) {
  if (max_time) {
    latest_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(*max_time);
  }
  hold_signals();
  watcher_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
  ended_ = true;
  watcher_.join();
  let_signals_go();
}

bool Interruption::stop_before_frame(double frame_ms) {
  const std::lock_guard guard(mutex_);
  if (reason_.empty() && latest_ && Clock::now() + std::chrono::duration<double, std::milli>(frame_ms) > *latest_) {
    reason_ = "--max-time";
    end_ = *latest_;
  }
  return !reason_.empty();
}

std::string Interruption::reason() const {
  const std::lock_guard guard(mutex_);
  return reason_;
}

void Interruption::ask(const std::string& reason, Clock::time_point end) {
  const std::lock_guard guard(mutex_);
  if (reason_.empty()) {
    reason_ = reason;
    end_ = latest_ ? std::min(end, *latest_) : end;
  }
}

void Interruption::watch() {
  const sigset_t set = watched();
  int interrupts = 0;
  while (!ended_) {
    const timespec wait{0, 50'000'000};
    const int signal = ::sigtimedwait(&set, nullptr, &wait);
    if (signal == SIGINT && ++interrupts > 1) {
      end_at_once(signal);
    }
    const Clock::time_point now = Clock::now();
    if (signal > 0) {
      ask(name_of(signal), now + grace_);
    } else if (latest_ && now >= *latest_ - grace_) {
      ask("--max-time", *latest_);
    }
    bool over = false;
    {
      const std::lock_guard guard(mutex_);
      over = end_ && now >= *end_;
    }
    if (over && !in_frames_ && !ended_) {
      std::fprintf(stderr,
                   "gazetrace: interrupted by %s before the first frame; nothing that was finished before is lost\n",
                   reason().c_str());
      ::_exit(exit_interrupted);
    }
    over_ = over;
  }
}

}  // namespace gazetrace
