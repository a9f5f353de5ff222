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
#include "gazetrace/output_lock.hpp"
#include "gazetrace/resolve.hpp"
#include "threads.hpp"

namespace gazetrace::python {

class Rendering {
 public:
  // Loads and checks everything that the job names, as the program does before its first ray; its errors are those of
  // resolve() and prepare_outputs(). With `scene` the job's own scene file is not read.
  Rendering(Job job, std::shared_ptr<const Scene> scene, Threads& threads);
  ~Rendering();
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;

  // The next frame; empty after the last. `interrupted` is asked a few times a second while it waits: where it says
  // true, the frame in hand is given up, and the call returns when the sequence has ended. Throws what the sequence
  // threw, and Error(interrupted) where `max-time` ended it.
  std::unique_ptr<GivenFrame> next(const std::function<bool()>& interrupted);
  // Gives up the frame in hand, and waits until the files that tell of the run are written.
  void close();

  [[nodiscard]] const ResolvedJob& resolved() const { return resolved_; }
  // Of the sequence; empty until it has ended.
  [[nodiscard]] SequenceResult result() const;
  [[nodiscard]] bool has_ended() const;
  [[nodiscard]] Warnings warnings() const;
  [[nodiscard]] std::vector<std::string> files() const { return files_; }
  [[nodiscard]] std::string view() const { return color_->description(); }

 private:
  using Clock = std::chrono::steady_clock;
  void run();
  void render();
  [[nodiscard]] std::unique_ptr<GivenFrame> packed(const FrameRequest& request, RenderedFrame&& rendered,
                                                   const TimingRow& row) const;
  [[nodiscard]] bool wait_until_wanted(double frame_ms);

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<ColorPipeline> color_;
  ResolvedJob resolved_;
  std::vector<std::string> files_;
  OutputLock lock_;
  std::optional<PathTracer> tracer_;
  RunRecord record_;
  Warnings warnings_;
  std::optional<Clock::time_point> latest_;  // by `max-time`

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool wanted_ = false, ended_ = false;
  std::unique_ptr<GivenFrame> given_;
  std::exception_ptr failure_;
  SequenceResult result_;
  std::atomic<bool> stop_{false}, out_of_time_{false};
};

}  // namespace gazetrace::python
