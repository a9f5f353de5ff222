// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace gazetrace {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::seconds kLineEvery{5};
constexpr std::chrono::milliseconds kDrawEvery{50};

std::string bar_text(std::size_t done, std::size_t total) {
  const std::size_t filled = total == 0 ? kBarWidth : done * kBarWidth / total;
  return "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '-') + "]";
}

}  // namespace

ProgressStyle progress_style(const std::string& choice, bool quiet) {
  if (choice == "openjd") {
    return ProgressStyle::openjd;
  }
  if (quiet || choice == "never" || choice == "json") {
    return ProgressStyle::none;
  }
  return choice == "always" || isatty(STDERR_FILENO) == 1 ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string duration_text(double seconds) {
  if (seconds < 9.95) {
    return fmt::format("{:.1f} s", seconds);
  }
  const auto total = static_cast<std::int64_t>(seconds + 0.5);
  if (total < 60) {
    return fmt::format("{} s", total);
  }
  if (total < 3600) {
    return fmt::format("{} min {:02} s", total / 60, total % 60);
  }
  return fmt::format("{} h {:02} min", total / 3600, total / 60 % 60);
}

Progress::Progress(ProgressStyle style, std::size_t frames) : style_(style), frames_(frames) {
  if (style_ == ProgressStyle::bar) {
    draw_bar();
    open_ = true;
  }
}

Progress::~Progress() {
  finish();
}

void Progress::finish() {
  if (open_) {
    std::fputc('\n', stderr);
    open_ = false;
  }
}

void Progress::frame_done(std::int32_t frame, double frame_ms, bool skipped) {
  ++done_;
  rendered_ += skipped ? 0 : 1;
  if (style_ == ProgressStyle::bar) {
    draw_bar();
  } else if (style_ == ProgressStyle::lines && !skipped) {
    print_line(frame, frame_ms);
  } else if (style_ == ProgressStyle::openjd) {
    tell_engine(frame);
  }
}

void Progress::draw_bar() const {
  // \x1b[K: clear to the end of the line, because the text may get shorter.
  const std::string text =
      fmt::format("\r{} {}/{} frames{}\x1b[K", bar_text(done_, frames_), done_, frames_, time_left());
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

void Progress::print_line(std::int32_t frame, double frame_ms) {
  const Clock::time_point now = Clock::now();
  const bool is_first_or_last = rendered_ == 1 || done_ == frames_;
  if (!is_first_or_last && now - last_line_ < kLineEvery) {
    return;
  }
  last_line_ = now;
  const std::string text =
      fmt::format("frame {} done in {:.0f} ms ({}/{}){}\n", frame, frame_ms, done_, frames_, time_left());
  std::fputs(text.c_str(), stderr);
}

// At most a line a second, since workers pass each on.
void Progress::tell_engine(std::int32_t frame) {
  const Clock::time_point now = Clock::now();
  if (done_ != frames_ && done_ != 1 && now - last_line_ < std::chrono::seconds(1)) {
    return;
  }
  last_line_ = now;
  std::printf("openjd_progress: %.1f\nopenjd_status: frame %d done, %zu of %zu%s\n",
              100.0 * static_cast<double>(done_) / static_cast<double>(frames_), frame, done_, frames_,
              time_left().c_str());
  std::fflush(stdout);
}

std::string Progress::time_left() const {
  if (rendered_ == 0 || done_ == frames_) {
    return {};
  }
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  return ", " + duration_text(elapsed_s / static_cast<double>(rendered_) * static_cast<double>(frames_ - done_)) +
         " left";
}

LoadProgress::~LoadProgress() {
  if (open_) {
    std::fputs("\r\x1b[K", stderr);
  }
}

void LoadProgress::parts_done(std::size_t done, std::size_t total) {
  const Clock::time_point now = Clock::now();
  if (style_ == ProgressStyle::bar && (done == total || now - last_ >= kDrawEvery)) {
    draw(done, total, fmt::format("loading: {}/{} textures and meshes", done, total));
    last_ = now;
  } else if (style_ == ProgressStyle::lines && now - last_ >= kLineEvery) {
    std::fputs(fmt::format("loading: {} of {} textures and meshes\n", done, total).c_str(), stderr);
    last_ = now;
  }
}

void LoadProgress::building_tree() {
  if (style_ == ProgressStyle::bar) {
    draw(1, 1, "loaded; building the tree for rays");
  }
}

void LoadProgress::draw(std::size_t done, std::size_t total, const std::string& what) {
  std::fputs(fmt::format("\r{} {}\x1b[K", bar_text(done, total), what).c_str(), stderr);
  std::fflush(stderr);
  open_ = true;
}

}  // namespace gazetrace
