// SPDX-License-Identifier: Apache-2.0
#include "gaze/missing_values.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

namespace gazetrace {
namespace {

constexpr double kInt16Min = -32768;
constexpr double kLarge = 1e7;
constexpr double kJump = 0.1;                 // of the display, in either axis
constexpr std::size_t kMostPlaces = 200'000;  // a log in the wrong unit has a place for every row
constexpr std::size_t kFewestRows = 3;
constexpr std::size_t kFewestRowsInLog = 2000;  // one of so many

struct Visits {
  std::size_t rows = 0;
  std::size_t moves = 0, jumps = 0;  // to it and away from it
};

}  // namespace

bool is_missing_marker(double coordinate) {
  return coordinate == kInt16Min || std::abs(coordinate) >= kLarge;
}

void mark_missing_values(GazeLog& log, const GazeReadOptions& options) {
  for (GazeSample& sample : log.samples) {
    const bool is_given = options.missing_value && sample.u == *options.missing_value && sample.v == sample.u;
    if (is_given || is_missing_marker(sample.u) || is_missing_marker(sample.v)) {
      sample.u = sample.v = std::numeric_limits<double>::quiet_NaN();
      sample.validity = is_usable(sample.validity) ? GazeValidity::lost : sample.validity;
    }
  }
}

std::optional<RecurringPlace> find_recurring_place(const GazeLog& log, const std::vector<Vec2d>& raw) {
  std::map<std::pair<double, double>, Visits> places;
  struct Last {
    const GazeSample* sample = nullptr;
    Visits* visits = nullptr;  // of its place; none on the display
    Vec2d at;
  };
  std::array<Last, 3> last_of_eye;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    Last& last = last_of_eye[static_cast<std::size_t>(sample.eye)];
    if (!is_usable(sample.validity)) {
      last = {};
      continue;
    }
    Last now{&sample, nullptr, raw[i]};
    if (sample.u < 0 || sample.u > 1 || sample.v < 0 || sample.v > 1) {
      const std::pair<double, double> key(raw[i].x, raw[i].y);
      const auto known = places.find(key);
      now.visits = known != places.end() ? &known->second : places.size() < kMostPlaces ? &places[key] : nullptr;
    }
    if (now.visits != nullptr) {
      ++now.visits->rows;
    }
    if (last.sample != nullptr && (last.at.x != now.at.x || last.at.y != now.at.y)) {
      const bool jumps = std::abs(sample.u - last.sample->u) > kJump || std::abs(sample.v - last.sample->v) > kJump;
      for (Visits* const visits : {last.visits, now.visits}) {
        if (visits != nullptr) {
          ++visits->moves;
          visits->jumps += jumps ? 1 : 0;
        }
      }
    }
    last = now;
  }
  std::optional<RecurringPlace> most;
  for (const auto& [at, visits] : places) {
    const bool recurs = visits.rows >= kFewestRows && visits.rows * kFewestRowsInLog >= log.samples.size();
    const bool only_jumps = visits.moves > 0 && visits.jumps * 10 >= visits.moves * 9;
    if (recurs && only_jumps && (!most || visits.rows > most->rows)) {
      most = RecurringPlace{at.first, at.second, visits.rows};
    }
  }
  return most;
}

}  // namespace gazetrace
