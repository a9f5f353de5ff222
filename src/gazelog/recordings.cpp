// SPDX-License-Identifier: Apache-2.0
#include "gazelog/recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/text.hpp"

namespace gazetrace {
namespace {

// Far more than a study has: a column with more values counts something else.
constexpr std::size_t kMostRecordings = 10'000;

void go_on_with(RawGaze& raw, std::size_t recording, std::int64_t line) {
  raw.recording_lines.push_back({line, recording, raw.origins.size(), raw.head.size()});
}

void add_recording(RawGaze& raw, GazeRecording recording, std::int64_t line) {
  if (raw.recordings.size() == kMostRecordings) {
    throw Error(ErrorKind::input, fmt::format("{}:{}", raw.source, line),
                fmt::format("there are more than {} recordings up to here", kMostRecordings),
                "name the column that tells recordings apart with `recording-column`, or divide the file");
  }
  go_on_with(raw, raw.recordings.size(), line);
  raw.recordings.push_back(std::move(recording));
}

// The recordings of lines that are asked for in any order.
class RecordingOfLine {
 public:
  explicit RecordingOfLine(const RawGaze& raw) : lines_(raw.recording_lines) {}

  // What stands above the first recording belongs to it.
  std::size_t operator()(std::int64_t line) {
    if (at_ >= lines_.size() || lines_[at_].line > line || (at_ + 1 < lines_.size() && lines_[at_ + 1].line <= line)) {
      const auto behind = std::upper_bound(lines_.begin(), lines_.end(), line,
                                           [](std::int64_t l, const RecordingFromLine& from) { return l < from.line; });
      at_ = behind == lines_.begin() ? 0 : static_cast<std::size_t>(behind - lines_.begin()) - 1;
    }
    return lines_[at_].recording;
  }

 private:
  const std::vector<RecordingFromLine>& lines_;
  std::size_t at_ = 0;
};

void count_rows(RawGaze& raw) {
  for (GazeRecording& recording : raw.recordings) {
    recording.rows = 0;
  }
  RecordingOfLine recording_of(raw);
  for (const RawSample row : raw.rows) {
    GazeRecording& recording = raw.recordings[recording_of(row.row)];
    recording.first_ns = recording.rows == 0 ? row.t_ns : std::min(recording.first_ns, row.t_ns);
    recording.last_ns = recording.rows == 0 ? row.t_ns : std::max(recording.last_ns, row.t_ns);
    recording.first_row = recording.rows == 0 ? row.row : recording.first_row;
    ++recording.rows;
  }
}

// The number of `choice` among the recordings, from 0.
std::size_t number_of(const RawGaze& raw, const std::string& choice) {
  const std::size_t number = count_from(choice).value_or(0);
  if (number >= 1 && number <= std::max<std::size_t>(raw.recordings.size(), 1)) {
    return number - 1;
  }
  for (std::size_t i = 0; i < raw.recordings.size(); ++i) {
    if (raw.recordings[i].name == choice) {
      return i;
    }
  }
  const bool is_alone = raw.recordings.empty();
  throw Error(ErrorKind::input, raw.source,
              is_alone ? fmt::format("holds one recording, and no recording '{}'", choice)
                       : fmt::format("holds no recording '{}', but {}", choice, recordings_in_words(raw.recordings)),
              is_alone ? "leave `gaze-recording` out" : "give one of these numbers to `gaze-recording`, or a name");
}

// Elements without a line: they were appended while the lines were read.
template <class Element>
void keep_elements(std::vector<Element>& elements, const std::vector<RecordingFromLine>& lines,
                   std::size_t RecordingFromLine::*begin, std::size_t chosen) {
  std::vector<Element> kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t first = i == 0 ? 0 : lines[i].*begin;
    const std::size_t end = i + 1 < lines.size() ? lines[i + 1].*begin : elements.size();
    if (lines[i].recording == chosen) {
      kept.insert(kept.end(), elements.begin() + static_cast<std::ptrdiff_t>(first),
                  elements.begin() + static_cast<std::ptrdiff_t>(end));
    }
  }
  elements = std::move(kept);
}

void leave_only(RawGaze& raw, std::size_t chosen) {
  RecordingOfLine recording_of(raw);
  std::vector<CornerFromRow> corners;
  RawRows kept;
  auto corner = raw.corners.begin();
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    for (; corner != raw.corners.end() && corner->first_row <= i; ++corner) {
      corners.push_back({kept.size(), corner->corner, corner->size_px});
    }
    const RawSample row = raw.rows[i];
    if (recording_of(row.row) == chosen) {
      kept.push_back(row);
    }
  }
  raw.rows = std::move(kept);
  const bool size_changes = std::any_of(raw.corners.begin(), raw.corners.end(), [&](const CornerFromRow& c) {
    return raw.recording_geometry && c.size_px[0] > 0 && c.size_px[0] != raw.recording_geometry->width_px;
  });
  if (size_changes && chosen < raw.pixels_per_degree_of_blocks.size() &&
      raw.pixels_per_degree_of_blocks[chosen].x > 0) {
    raw.pixels_per_degree = raw.pixels_per_degree_of_blocks[chosen];
  }
  raw.corners = std::move(corners);
  // What is measured before a block holds for it as well, since all blocks are of one session.
  const bool is_block = raw.recordings[chosen].is_block;
  std::erase_if(raw.calibrations, [&](const GazeCalibration& calibration) {
    const std::size_t at = recording_of(calibration.row);
    return is_block ? at > chosen : at != chosen;
  });
  std::erase_if(raw.events, [&](const GazeEvent& event) { return recording_of(event.row) != chosen; });
  keep_elements(raw.origins, raw.recording_lines, &RecordingFromLine::origins, chosen);
  keep_elements(raw.head, raw.recording_lines, &RecordingFromLine::head, chosen);
}

}  // namespace

void begin_recording(RawGaze& raw, const std::string& name, std::int64_t line) {
  for (std::size_t i = raw.recordings.size(); i-- > 0;) {
    if (raw.recordings[i].name == name) {
      go_on_with(raw, i, line);
      return;
    }
  }
  add_recording(raw, {.name = name}, line);
}

void begin_block(RawGaze& raw, std::int64_t line) {
  add_recording(raw, {.name = {}, .is_block = true}, line);
}

RecordingColumns::RecordingColumns(const DelimitedTable& table, const std::string& declared,
                                   std::initializer_list<std::string_view> names) {
  if (!declared.empty()) {
    columns_ = {declared_column(table, declared)};
  } else {
    for (const std::string_view name : names) {
      if (const auto column = table.find(name)) {
        columns_.push_back(*column);
      }
    }
  }
  current_.resize(columns_.size());
}

std::size_t RecordingColumns::needed_cells() const {
  return columns_.empty() ? 0 : *std::max_element(columns_.begin(), columns_.end()) + 1;
}

bool RecordingColumns::note(TableRows& rows, RawGaze& raw) {
  bool is_other = false;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::string_view cell = rows.cell(columns_[i]);
    if (cell != current_[i] && !is_missing(cell)) {
      current_[i] = cell;
      is_other = true;
    }
  }
  if (is_other) {
    std::string name;
    for (const std::string& part : current_) {
      name += (name.empty() || part.empty() ? "" : "/") + part;
    }
    begin_recording(raw, name, rows.line());
  }
  return is_other;
}

void choose_recording(RawGaze& raw, const std::string& choice) {
  if (raw.recordings.size() > 1 && raw.recording == 0) {
    count_rows(raw);
  }
  if (!choice.empty()) {
    const std::size_t chosen = number_of(raw, choice);
    if (raw.recordings.size() > 1) {
      leave_only(raw, chosen);
      raw.recording = chosen + 1;
    }
  }
  if (raw.recordings.size() <= 1) {
    raw.recordings.clear();
    raw.recording_lines.clear();
  }
}

std::int64_t duration_ns(const GazeRecording& recording) {
  std::int64_t duration = 0;
  return __builtin_sub_overflow(recording.last_ns, recording.first_ns, &duration)
             ? std::numeric_limits<std::int64_t>::max()
             : duration;
}

bool needs_a_choice(const RawGaze& raw) {
  return raw.recording == 0 && std::any_of(raw.recordings.begin(), raw.recordings.end(),
                                           [](const GazeRecording& recording) { return !recording.is_block; });
}

std::string recordings_in_words(const std::vector<GazeRecording>& recordings) {
  constexpr std::size_t kMostListed = 8;
  const bool are_blocks = !recordings.empty() && recordings.front().is_block;
  std::string text = fmt::format("{} {}: ", recordings.size(), are_blocks ? "blocks" : "recordings");
  for (std::size_t i = 0; i < std::min(recordings.size(), kMostListed); ++i) {
    const GazeRecording& recording = recordings[i];
    const double seconds = static_cast<double>(duration_ns(recording)) * 1e-9;
    text += fmt::format("{}{} ({} rows from line {} on, {:.1f} s)", i == 0 ? "" : ", ", i + 1, recording.rows,
                        recording.first_row, seconds);
  }
  return text + (recordings.size() > kMostListed ? ", ..." : "");
}

}  // namespace gazetrace
