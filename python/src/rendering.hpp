// SPDX-License-Identifier: Apache-2.0
// A sequence in the hands of whoever asks for its frames. render_sequence() pushes frames, an iterator pulls them: the
// sequence runs on a thread of its own, and begins a frame when it is asked for and not before, so that nothing is
// rendered in vain and the times of a frame are its own.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "frame.hpp"
#include "gazetrace/run_job.hpp"
#include "threads.hpp"

namespace gazetrace::python {

class Rendering {
 public:
  // Starts run_job(), and waits until its first frame comes next; what is wrong with the job is thrown here. With
  // `scene` the job's own scene file is not read.
  Rendering(const Job& job, std::shared_ptr<const Scene> scene, Threads& threads);
  ~Rendering();
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;

  // The next frame; empty after the last. `interrupted` is asked a few times a second while it waits: where it says
  // true, the frame in hand is given up, and the call returns when the sequence has ended. Throws what the sequence
  // threw, and Error(interrupted) where `max-time` ended it.
  std::unique_ptr<GivenFrame> next(const std::function<bool()>& interrupted);
  // Gives up the frame in hand, and waits until the files that tell of the run are written.
  void close();

  // What was decided before the first frame.
  struct Facts {
    std::vector<std::int32_t> frames;
    Decisions decisions;
    std::string digest;
    std::vector<std::string> files;
    std::string view;
  };
  [[nodiscard]] const Facts& facts() const { return facts_; }
  // Of the sequence; empty until it has ended.
  [[nodiscard]] SequenceResult result() const;
  [[nodiscard]] bool has_ended() const;
  [[nodiscard]] Warnings warnings() const;

 private:
  using Clock = std::chrono::steady_clock;
  void run(const Job& job);
  void render(const Job& job);
  [[nodiscard]] std::unique_ptr<GivenFrame> packed(const FrameRequest& request, RenderedFrame&& rendered,
                                                   const TimingRow& row) const;
  [[nodiscard]] bool wait_until_wanted(double frame_ms);

  std::shared_ptr<const Scene> scene_;
  const StartedRun* run_ = nullptr;  // for the thread of the sequence alone
  Facts facts_;
  Warnings warnings_;
  std::optional<Clock::time_point> latest_;  // by `max-time`

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool begun_ = false, wanted_ = false, ended_ = false;
  std::unique_ptr<GivenFrame> given_;
  std::exception_ptr failure_;
  SequenceResult result_;
  std::atomic<bool> stop_{false}, out_of_time_{false};
};

}  // namespace gazetrace::python
