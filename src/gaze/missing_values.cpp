// SPDX-License-Identifier: Apache-2.0
#include "gaze/missing_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

namespace gazetrace {
namespace {

constexpr double kInt16Min = -32768;
constexpr double kLarge = 1e7;
constexpr double kJump = 0.1;  // of the display, in either axis
constexpr std::size_t kFewestRows = 3;
constexpr std::size_t kFewestRowsInLog = 2000;  // one of so many
constexpr std::size_t kFewestVisits = 3;

struct Visits {
  double raw_x = 0, raw_y = 0;
  std::size_t rows = 0;
  // Of each eye: rows of a chosen eye may be there twice. A loss between is no end of a visit, as a value may be held.
  std::array<std::size_t, 3> times{};
  std::size_t moves = 0, jumps = 0;  // to it and away from it
};

using Place = std::pair<double, double>;

bool is_often(std::size_t rows, std::size_t rows_in_log) {
  return rows >= kFewestRows && rows * kFewestRowsInLog >= rows_in_log;
}

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

std::vector<FrequentPlace> frequent_places(const std::vector<GazeSample>& samples) {
  // A log has nearly as many places as rows. Counting them by a hash first leaves few to be told apart.
  constexpr int kHashBits = 18;
  const auto hash = [](const GazeSample& sample) {
    const auto u = std::bit_cast<std::uint64_t>(sample.u);
    const auto v = std::bit_cast<std::uint64_t>(sample.v);
    return ((u ^ std::rotl(v, 32)) * 0x9E37'79B9'7F4A'7C15U) >> (64 - kHashBits);
  };
  std::vector<std::uint32_t> counts(std::size_t{1} << kHashBits, 0);
  for (const GazeSample& sample : samples) {
    ++counts[hash(sample)];
  }
  struct Found {
    std::size_t rows = 0, first = 0;
  };
  std::map<Place, Found> found;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const GazeSample& sample = samples[i];
    if (!std::isnan(sample.u) && !std::isnan(sample.v) && is_often(counts[hash(sample)], samples.size())) {
      ++found.try_emplace({sample.u, sample.v}, Found{0, i}).first->second.rows;
    }
  }
  std::vector<FrequentPlace> frequent;
  for (const auto& [place, times] : found) {
    if (is_often(times.rows, samples.size())) {
      frequent.push_back({place.first, place.second, times.first});
    }
  }
  return frequent;
}

std::optional<RecurringPlace> find_recurring_place(const GazeLog& log, const std::vector<FrequentPlace>& frequent) {
  std::map<Place, Visits> places;
  for (const FrequentPlace& place : frequent) {
    const GazeSample& sample = log.samples[place.sample];
    const bool on_display = sample.u >= 0 && sample.u <= 1 && sample.v >= 0 && sample.v <= 1;
    if (!on_display && !std::isnan(sample.u) && !std::isnan(sample.v)) {
      places.try_emplace({sample.u, sample.v}, Visits{place.x, place.y});
    }
  }
  if (places.empty()) {
    return std::nullopt;
  }
  struct Last {
    const GazeSample* sample = nullptr;
    Visits* visits = nullptr;  // of its place, where it is one of those looked at
  };
  std::array<Last, 3> last_of_eye;
  std::array<const Visits*, 3> was_at{};  // the same, losses left out
  for (const GazeSample& sample : log.samples) {
    const auto eye = static_cast<std::size_t>(sample.eye);
    Last& last = last_of_eye[eye];
    if (!is_usable(sample.validity) || std::isnan(sample.u) || std::isnan(sample.v)) {
      last = {};
      continue;
    }
    const auto known = places.find({sample.u, sample.v});
    const Last now{&sample, known == places.end() ? nullptr : &known->second};
    if (now.visits != nullptr) {
      ++now.visits->rows;
      now.visits->times[eye] += was_at[eye] != now.visits ? 1 : 0;
    }
    was_at[eye] = now.visits;
    if (last.sample != nullptr && (last.sample->u != sample.u || last.sample->v != sample.v)) {
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
    const bool only_jumps = visits.moves > 0 && visits.jumps * 10 >= visits.moves * 9;
    const bool comes_again = *std::max_element(visits.times.begin(), visits.times.end()) >= kFewestVisits;
    if (is_often(visits.rows, log.samples.size()) && comes_again && only_jumps && (!most || visits.rows > most->rows)) {
      most = RecurringPlace{visits.raw_x, visits.raw_y, visits.rows};
    }
  }
  return most;
}

}  // namespace gazetrace
