// SPDX-License-Identifier: Apache-2.0
#include "gaze/inspect/inspect.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "gazelog/eyes.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

constexpr double kJump = 0.1;  // of the display, or of a unit vector, in any axis
constexpr std::size_t kFewestRows = 3;
constexpr std::size_t kFewestRowsInLog = 2000;  // one row in so many
constexpr std::size_t kFewestVisits = 3;

// In places where gaze may well be, a mark must occur more often, and no other place may occur as often.
constexpr std::size_t kFewestRowsInLogWhereGazeIs = 100;  // one row in so many
constexpr std::size_t kFewestVisitsWhereGazeIs = 10;
constexpr std::size_t kMarkOverNext = 4;

struct Visits {
  Vec3d raw;
  bool is_beside = false;  // beside the display
  std::size_t rows = 0;
  // Counted for each eye, as the rows of a chosen eye may be there twice. A loss in between does not end a visit, as a
  // value may be held.
  std::array<std::size_t, 3> times{};
  std::size_t moves = 0, jumps = 0;  // towards it and away from it

  [[nodiscard]] bool look_like_a_mark(std::size_t rows_in_log) const;
};

using Place = std::tuple<double, double, double>;

Vec3d place_of(const RawRows& rows, std::size_t i, bool has_three) {
  const Vec3d at = rows.at(i);
  return has_three ? at : Vec3d{at.x, at.y, 0};
}
Place key_of(const Vec3d& at) {
  return {at.x, at.y, at.z};
}
bool is_known(const Vec3d& at) {
  return !std::isnan(at.x) && !std::isnan(at.y) && !std::isnan(at.z);
}

bool is_often(std::size_t rows, std::size_t rows_in_log) {
  return rows >= kFewestRows && rows * kFewestRowsInLog >= rows_in_log;
}

// Steps within a fixation are small, so that gaze hardly ever reaches a place that it fixates by jumps.
bool Visits::look_like_a_mark(std::size_t rows_in_log) const {
  const std::size_t most_times = *std::max_element(times.begin(), times.end());
  if (is_beside) {
    return is_often(rows, rows_in_log) && most_times >= kFewestVisits && moves > 0 && jumps * 10 >= moves * 9;
  }
  // Where gaze fixates near the mark, the steps to it are short.
  return rows * kFewestRowsInLogWhereGazeIs >= rows_in_log && most_times >= kFewestVisitsWhereGazeIs && moves > 0 &&
         jumps * 2 >= moves;
}

// A place at which many rows of a log lie, and one of them.
struct FrequentPlace {
  Vec3d raw;            // as in the file
  std::size_t row = 0;  // index
};

// At most a few thousand places, whatever the log's length.
std::vector<FrequentPlace> frequent_places(const RawRows& rows, bool has_three) {
  // A log has nearly as many places as rows. Counting them by a hash first leaves only a few that must be compared
  // exactly.
  constexpr int kHashBits = 18;
  const auto hash = [](const Vec3d& at) {
    const auto x = std::bit_cast<std::uint64_t>(at.x);
    const auto y = std::bit_cast<std::uint64_t>(at.y);
    const auto z = std::bit_cast<std::uint64_t>(at.z);
    return ((x ^ std::rotl(y, 32) ^ std::rotl(z, 16)) * 0x9E37'79B9'7F4A'7C15U) >> (64 - kHashBits);
  };
  std::vector<std::uint32_t> counts(std::size_t{1} << kHashBits, 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ++counts[hash(place_of(rows, i, has_three))];
  }
  struct Found {
    std::size_t rows = 0, first = 0;
  };
  std::map<Place, Found> found;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vec3d at = place_of(rows, i, has_three);
    if (is_known(at) && is_often(counts[hash(at)], rows.size())) {
      ++found.try_emplace(key_of(at), Found{0, i}).first->second.rows;
    }
  }
  std::vector<FrequentPlace> frequent;
  for (const auto& [place, times] : found) {
    if (is_often(times.rows, rows.size())) {
      frequent.push_back({{std::get<0>(place), std::get<1>(place), std::get<2>(place)}, times.first});
    }
  }
  return frequent;
}

using VisitedPlaces = std::map<Place, Visits>;

// The places that may be a mark, by where they lie as gaze, without any visit yet.
VisitedPlaces candidates(const RowSamples& sample_of, const std::vector<FrequentPlace>& frequent) {
  const GazeKind kind = sample_of.kind();
  VisitedPlaces places;
  for (const FrequentPlace& place : frequent) {
    const Vec3d at = place_of(sample_of(place.row), kind);
    const bool is_zero = place.raw.x == 0 && place.raw.y == 0 && place.raw.z == 0;  // zeros are counted separately
    if (is_known(at) && !is_zero) {
      const bool is_beside = kind != GazeKind::direction && !(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1);
      places.try_emplace(key_of(at), Visits{.raw = place.raw, .is_beside = is_beside});
    }
  }
  return places;
}

// Where an eye is in a row.
struct Stay {
  std::optional<Vec3d> at;
  Visits* visits = nullptr;  // to that place, where it is one of the candidates
};

// Counts the step between two rows that follow each other for both places.
void count_step(const Stay& from, const Stay& to) {
  if (!from.at || key_of(*from.at) == key_of(*to.at)) {
    return;
  }
  const Vec3d step = *to.at - *from.at;
  const bool jumps = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)}) > kJump;
  for (Visits* const visits : {from.visits, to.visits}) {
    if (visits != nullptr) {
      ++visits->moves;
      visits->jumps += jumps ? 1 : 0;
    }
  }
}

VisitedPlaces with_visits(VisitedPlaces places, const RowSamples& sample_of, std::size_t rows) {
  const GazeKind kind = sample_of.kind();
  std::array<Stay, 3> last_of_eye;
  std::array<const Visits*, 3> was_at{};  // the same, with losses left out
  for (std::size_t row = 0; row < rows; ++row) {
    const GazeSample sample = sample_of(row);
    const auto eye = static_cast<std::size_t>(sample.eye);
    const Vec3d at = place_of(sample, kind);
    if (!is_usable(sample.validity) || !is_known(at)) {
      last_of_eye[eye] = {};
      continue;
    }
    const auto known = places.find(key_of(at));
    const Stay now{at, known == places.end() ? nullptr : &known->second};
    if (now.visits != nullptr) {
      ++now.visits->rows;
      now.visits->times[eye] += was_at[eye] != now.visits ? 1 : 0;
    }
    was_at[eye] = now.visits;
    count_step(last_of_eye[eye], now);
    last_of_eye[eye] = now;
  }
  return places;
}

// Beside the display a few rows are enough; elsewhere the place must hold a hundredth of the rows, and no other place
// may be like it.
std::optional<RecurringPlace> mark_among(const VisitedPlaces& places, std::size_t rows_in_log) {
  const Visits* beside = nullptr;
  const Visits* within = nullptr;
  std::size_t next_within_rows = 0;
  for (const auto& [at, visits] : places) {
    if (!visits.look_like_a_mark(rows_in_log)) {
      continue;
    }
    const Visits*& most = visits.is_beside ? beside : within;
    const Visits* next = &visits;
    if (most == nullptr || visits.rows > most->rows) {
      std::swap(most, next);
    }
    if (!visits.is_beside && next != nullptr) {
      next_within_rows = std::max(next_within_rows, next->rows);
    }
  }
  // Gaze without noise, such as that of a mouse or a model, repeats many places exactly and leaves them by jumps.
  if (within != nullptr && next_within_rows * kMarkOverNext > within->rows) {
    within = nullptr;
  }
  const Visits* const mark = beside != nullptr ? beside : within;
  return mark == nullptr ? std::nullopt : std::optional(RecurringPlace{mark->raw, mark->rows});
}

// A place that gaze reaches again and again, and by jumps from elsewhere.
std::optional<RecurringPlace> find_mark(const RawGaze& raw, const Conventions& conventions,
                                        const std::vector<FrequentPlace>& frequent) {
  const RowSamples sample_of(raw, conventions);
  VisitedPlaces places = candidates(sample_of, frequent);
  if (places.empty()) {
    return std::nullopt;
  }
  const std::size_t rows = raw.rows.size();
  return mark_among(with_visits(std::move(places), sample_of, rows), rows);
}

}  // namespace

std::optional<RecurringPlace> find_recurring_place(const RawGaze& raw, const Conventions& conventions) {
  const bool has_three = conventions.form == PlaceForm::vector;
  const std::vector<FrequentPlace> frequent = frequent_places(raw.rows, has_three);
  if (frequent.empty()) {
    return std::nullopt;
  }
  const std::optional<RecurringPlace> mark = find_mark(raw, conventions, frequent);
  // Of directions, only those that loggers write as marks count: three times the same number, and straight ahead.
  const bool is_plain =
      mark && ((mark->raw.x == mark->raw.y && mark->raw.y == mark->raw.z) || (mark->raw.x == 0 && mark->raw.y == 0));
  return mark && (!has_three || is_plain) ? mark : std::nullopt;
}

std::optional<RecurringPlace> find_mark_in_one_axis(const RawGaze& raw, const Conventions& conventions) {
  if (conventions.form != PlaceForm::position || conventions.missing_value) {
    return std::nullopt;
  }
  constexpr std::size_t kMostLookedAt = 200'000;
  constexpr std::size_t kOneRowIn = 200;
  std::map<double, std::size_t> counts;
  std::size_t all = 0;
  const std::size_t stride = raw.rows.size() / kMostLookedAt + 1;
  for (std::size_t i = 0; i < raw.rows.size(); i += stride) {
    const RawSample row = raw.rows[i];
    for (const double value : {row.at.x, row.at.y}) {
      if (is_usable(row.validity) && value < 0 && value == std::floor(value) && !is_missing_marker(value)) {
        ++counts[value];
        ++all;
      }
    }
  }
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  // Gaze beside the display comes to many places there, and none stands out.
  if (most == counts.end() || most->second < kFewestRows || most->second * kOneRowIn * stride < raw.rows.size() ||
      most->second * 2 < all) {
    return std::nullopt;
  }
  return RecurringPlace{{most->first, most->first, 0}, most->second * stride};
}

}  // namespace gazetrace
