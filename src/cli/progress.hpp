// SPDX-License-Identifier: Apache-2.0
// How far a run is: a bar on a terminal, plain lines elsewhere, on stderr; or lines on stdout for an engine that runs
// it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace gazetrace {

// openjd: what workers of Open Job Description read, "openjd_progress: 42.0" and "openjd_status: ...".
enum class ProgressStyle { none, bar, lines, openjd };

// auto: a bar on a terminal, else lines. Engines are told even where people want quiet.
ProgressStyle progress_style(const std::string& choice, bool quiet);

class Progress {
 public:
  Progress(ProgressStyle style, std::size_t frames);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // A frame is done; skipped ones say nothing about the speed.
  void frame_done(std::int32_t frame, double frame_ms, bool skipped);
  void finish();  // ends the bar's line

 private:
  using Clock = std::chrono::steady_clock;
  void draw_bar() const;
  void print_line(std::int32_t frame, double frame_ms);
  void tell_engine(std::int32_t frame);
  [[nodiscard]] std::string time_left() const;

  ProgressStyle style_;
  std::size_t frames_;
  std::size_t done_ = 0, rendered_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_line_ = start_;
  bool open_ = false;  // the bar's line has not ended
};

// What happens before the first frame. A bar's line is wiped when it is done; as plain lines only long loads are told.
class LoadProgress {
 public:
  explicit LoadProgress(ProgressStyle style) : style_(style) {}
  ~LoadProgress();
  LoadProgress(const LoadProgress&) = delete;
  LoadProgress& operator=(const LoadProgress&) = delete;

  void parts_done(std::size_t done, std::size_t total);  // textures and meshes
  void building_tree();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(std::size_t done, std::size_t total, const std::string& what);

  ProgressStyle style_;
  Clock::time_point last_ = Clock::now();
  bool open_ = false;
};

// "47 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

}  // namespace gazetrace
