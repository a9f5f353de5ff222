// SPDX-License-Identifier: Apache-2.0
// Signals that ask a run to end, and its own limit of time: what is in hand is finished if the time allows it.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace gazetrace {

// Of TERM, INT, HUP, USR1 and XCPU the first one asks the run to end; a second INT ends the process at once. The
// signals reach only threads that exist when this is made and those that it makes, so it comes before all others.
//
// From its first line on the program holds them, so that one that comes before is not lost: whoever makes no
// Interruption lets them go.
void hold_signals();
void let_signals_go();

class Interruption {
 public:
  using Clock = std::chrono::steady_clock;
  // `max_time` counts from now. After a signal the run has `grace` left; of `max_time` the last `grace` is that time.
  Interruption(std::chrono::nanoseconds grace, std::optional<std::chrono::nanoseconds> max_time);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  // From here on the run looks after itself; before, while a scene is loaded, the end of the grace time ends the
  // process.
  void frames_begin() { in_frames_ = true; }
  // No frame is begun any more, or this one, which will take so long, would not end in time.
  [[nodiscard]] bool stop_before_frame(double frame_ms);
  // The grace time is over: the frame in hand is given up. Asked often, from many threads.
  [[nodiscard]] bool stop_now() const { return over_.load(std::memory_order_relaxed); }
  // "signal TERM", "--max-time".
  [[nodiscard]] std::string reason() const;

 private:
  void watch();
  void ask(const std::string& reason, Clock::time_point end);

  const Clock::duration grace_;
  std::optional<Clock::time_point> latest_;  // by `max_time`
  mutable std::mutex mutex_;
  std::string reason_;                    // empty: nobody has asked
  std::optional<Clock::time_point> end_;  // of the grace time
  std::atomic<bool> over_{false}, in_frames_{false}, ended_{false};
  std::thread watcher_;
};

}  // namespace gazetrace
