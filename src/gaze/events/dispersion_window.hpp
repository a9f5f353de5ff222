// SPDX-License-Identifier: Apache-2.0
// The dispersion of gaze in a sliding window, D = (max x - min x) + (max y - min y) of Salvucci & Goldberg 2000, in
// linear time. x and y are azimuth and elevation around the window's first direction, so that D means the same
// everywhere, also in the world of a head-mounted display.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "gaze/angles.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

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
class DispersionWindow {
 public:
  explicit DispersionWindow(const std::vector<Vec3d>& direction) : direction_(direction) {}

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

// Slides the window over samples [first, end) of a stretch until the gaze stays within `most_deg` in `least_ns` of it,
// lets it grow as long as it does, and calls still(begin, end) for each such place. Returns where the rest begins,
// which is too short to fill the window; the window holds it.
template <class Still>
std::size_t find_still(const GazeDirections& gaze, std::size_t first, std::size_t end, std::int64_t least_ns,
                       double most_deg, DispersionWindow& window, const Still& still) {
  window.start(first);
  std::size_t begin = first;
  while (begin < end) {
    const auto is_filled = [&] {
      return window.end() > begin && gaze.t_ns[window.end() - 1] - gaze.t_ns[begin] >= least_ns;
    };
    while (window.end() < end && !is_filled()) {
      window.push();
    }
    if (!is_filled()) {
      break;
    }
    if (window.dispersion_deg() > most_deg) {
      window.pop();
      ++begin;
      continue;
    }
    while (window.end() < end && window.dispersion_with_next_deg() <= most_deg) {
      window.push();
    }
    still(begin, window.end());
    begin = window.end();
    if (begin < end) {
      window.start(begin);
    }
  }
  return begin;
}

}  // namespace gazetrace
