// SPDX-License-Identifier: Apache-2.0
// I-DT: a window of the shortest fixation's length slides until the gaze stays within D in it, and then grows as long
// as it does; D = (max x - min x) + (max y - min y). Gaze that was seen outside such windows counts as saccade.
// Salvucci & Goldberg, "Identifying fixations and saccades in eye-tracking protocols", 2000.
//
// x and y are azimuth and elevation around the window's first direction, so that D means the same everywhere, also in
// the world of a head-mounted display. The extents of a sliding window come from queues of candidates, in linear time.
#include <algorithm>
#include <array>
#include <cstddef>

#include "gaze/angles.hpp"
#include "gaze/events/event_method.hpp"

namespace gazetrace {
namespace {

// The largest value in a window whose ends only move forward. Values are dropped when a later one is larger, as that
// one stays in the window longer.
class SlidingMaximum {
 public:
  void clear() {
    entries_.clear();
    head_ = 0;
  }
  void push(std::size_t index, double value) {
    while (entries_.size() > head_ && entries_.back().value <= value) {
      entries_.pop_back();
    }
    entries_.push_back({index, value});
  }
  void drop_before(std::size_t index) {
    while (entries_[head_].index < index) {
      ++head_;
    }
  }
  [[nodiscard]] double value() const { return entries_[head_].value; }

 private:
  struct Entry {
    std::size_t index;
    double value;
  };
  std::vector<Entry> entries_;
  std::size_t head_ = 0;
};

// The dispersion of samples [begin, end).
class Window {
 public:
  explicit Window(const std::vector<Vec3d>& direction) : direction_(direction) {}

  void start(std::size_t begin) {
    begin_ = end_ = begin;
    center();
  }
  void push() {
    if (begin_ == end_) {
      center();
    }
    add(end_);
    ++end_;
  }
  void pop() {
    ++begin_;
    // The angles are accurate near the frame's own direction, which is enough for small extents.
    if (begin_ < end_ && angle_between_rad(frame_.forward, direction_[begin_]) > 5 * kRadPerDeg) {
      center();
      return;
    }
    for (SlidingMaximum& extreme : extremes_) {
      if (begin_ < end_) {
        extreme.drop_before(begin_);
      }
    }
  }
  [[nodiscard]] std::size_t end() const { return end_; }
  [[nodiscard]] double dispersion_deg() const {
    double sum = 0;
    for (const SlidingMaximum& extreme : extremes_) {
      sum += extreme.value();
    }
    return sum * kDegPerRad;
  }
  // What the dispersion would be with the next sample.
  [[nodiscard]] double dispersion_with_next_deg() const {
    const Vec2d a = frame_.angles(direction_[end_]);
    return (std::max(extremes_[0].value(), a.x) + std::max(extremes_[1].value(), -a.x) +
            std::max(extremes_[2].value(), a.y) + std::max(extremes_[3].value(), -a.y)) *
           kDegPerRad;
  }

 private:
  void center() {
    frame_ = TangentFrame(direction_[begin_]);
    for (SlidingMaximum& extreme : extremes_) {
      extreme.clear();
    }
    for (std::size_t i = begin_; i < end_; ++i) {
      add(i);
    }
  }
  void add(std::size_t i) {
    const Vec2d a = frame_.angles(direction_[i]);
    extremes_[0].push(i, a.x);
    extremes_[1].push(i, -a.x);
    extremes_[2].push(i, a.y);
    extremes_[3].push(i, -a.y);
  }

  const std::vector<Vec3d>& direction_;
  std::size_t begin_ = 0, end_ = 0;
  TangentFrame frame_;
  std::array<SlidingMaximum, 4> extremes_;
};

}  // namespace

void classify_idt(const GazeDirections& gaze, EyeEvents& events) {
  const EventSettings& settings = events.settings;
  std::vector<EyeMovement>& labels = events.labels;
  Window window(gaze.direction);
  for (const LabelRun& run : label_runs(labels, gaze.t_ns)) {
    if (run.movement != EyeMovement::unclassified) {
      continue;
    }
    const std::size_t end = run.last + 1;
    std::fill(labels.begin() + static_cast<std::ptrdiff_t>(run.first),
              labels.begin() + static_cast<std::ptrdiff_t>(end), EyeMovement::saccade);
    window.start(run.first);
    for (std::size_t begin = run.first; begin < end;) {
      while (window.end() < end &&
             (window.end() == begin || gaze.t_ns[window.end() - 1] - gaze.t_ns[begin] < settings.min_fixation_ns)) {
        window.push();
      }
      if (gaze.t_ns[window.end() - 1] - gaze.t_ns[begin] < settings.min_fixation_ns) {
        break;
      }
      if (window.dispersion_deg() > settings.dispersion_deg) {
        window.pop();
        ++begin;
        continue;
      }
      while (window.end() < end && window.dispersion_with_next_deg() <= settings.dispersion_deg) {
        window.push();
      }
      std::fill(labels.begin() + static_cast<std::ptrdiff_t>(begin),
                labels.begin() + static_cast<std::ptrdiff_t>(window.end()), EyeMovement::fixation);
      begin = window.end();
      events.cuts.push_back(begin);  // the next fixation may begin directly here
      if (begin < end) {
        window.start(begin);
      }
    }
  }
}

}  // namespace gazetrace
