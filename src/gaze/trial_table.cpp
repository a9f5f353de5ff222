// SPDX-License-Identifier: Apache-2.0
#include "gaze/trial_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include "core/text.hpp"

namespace gazetrace {
namespace {

constexpr int kSecondsToNs = 9;

class TrialTable {
 public:
  explicit TrialTable(const std::string& path) : path_(path), text_(read_text_file(path)), lines_(text_) {}

  std::vector<GazeTrial> read() {
    read_header();
    std::vector<GazeTrial> trials;
    while (next_row()) {
      GazeTrial trial;
      trial.name = name_ ? text_of(*name_) : "";
      trial.begin_ns = time_of(onset_, onset_is_ns_ ? 0 : kSecondsToNs);
      const bool fits =
          offset_ || !__builtin_add_overflow(trial.begin_ns, time_of(*duration_, kSecondsToNs), &trial.end_ns);
      trial.end_ns = offset_ ? time_of(*offset_, 0) : trial.end_ns;
      if (fits && trial.end_ns < trial.begin_ns) {
        fail("the trial ends before it begins");
      }
      // As of a log: durations are taken everywhere, and half of what an int64 holds leaves room for their sums.
      std::int64_t duration_ns = 0;
      if (!fits || __builtin_sub_overflow(trial.end_ns, trial.begin_ns, &duration_ns) ||
          duration_ns > std::numeric_limits<std::int64_t>::max() / 2) {
        fail("the trial lasts more than a hundred years",
             "give onset and duration in seconds, or onset_ns and offset_ns");
      }
      trials.push_back(std::move(trial));
    }
    std::stable_sort(trials.begin(), trials.end(),
                     [](const GazeTrial& a, const GazeTrial& b) { return a.begin_ns < b.begin_ns; });
    return trials;
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = {}) const {
    throw Error(ErrorKind::input, fmt::format("{}:{}", path_, lines_.number()), problem, remedy);
  }

  void read_header() {
    std::string_view line;
    if (!lines_.next(line)) {
      fail("is empty", "a table of trials begins with the names of its columns: onset and duration");
    }
    separator_ = line.find('\t') != std::string_view::npos  ? '\t'
                 : line.find(';') != std::string_view::npos ? ';'
                                                            : ',';
    split_cells(line, separator_, cells_);
    const auto column = [&](std::string_view name) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < cells_.size(); ++i) {
        if (to_lower(text_of(i)) == name) {
          return i;
        }
      }
      return std::nullopt;
    };
    name_ = column("name");
    name_ = name_ ? name_ : column("trial_type");
    duration_ = column("duration");
    offset_ = column("offset_ns");
    const std::optional<std::size_t> onset_ns = column("onset_ns");
    const std::optional<std::size_t> onset = column("onset");
    onset_is_ns_ = onset_ns && offset_;
    if (!onset_is_ns_ && !(onset && duration_)) {
      fail("names no columns onset and duration (seconds), nor onset_ns and offset_ns",
           "give the columns these names, on the clock of the log");
    }
    onset_ = onset_is_ns_ ? *onset_ns : *onset;
    offset_ = onset_is_ns_ ? offset_ : std::nullopt;
  }

  bool next_row() {
    std::string_view line;
    while (lines_.next(line)) {
      if (!trim(line).empty()) {
        split_cells(line, separator_, cells_);
        return true;
      }
    }
    return false;
  }

  std::string text_of(std::size_t column) {
    return column < cells_.size() ? std::string(cell_text(cells_[column], buffer_)) : "";
  }

  std::int64_t time_of(std::size_t column, int exponent) {
    const std::string text = text_of(column);
    std::int64_t value = 0;
    if (scaled_integer(text, exponent, value) != NumberStatus::ok) {
      fail(fmt::format("'{}' is not a time", text.substr(0, 40)));
    }
    return value;
  }

  std::string path_, text_;
  LineReader lines_;
  char separator_ = ',';
  std::vector<std::string_view> cells_;
  std::string buffer_;
  std::size_t onset_ = 0;
  bool onset_is_ns_ = false;
  std::optional<std::size_t> name_, duration_, offset_;
};

}  // namespace

std::vector<GazeTrial> read_trial_table(const std::string& path) {
  return TrialTable(path).read();
}

}  // namespace gazetrace
