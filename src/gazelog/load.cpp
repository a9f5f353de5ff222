// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "core/enum_name.hpp"
#include "core/named.hpp"
#include "core/text.hpp"
#include "gazelog/gaze_format.hpp"
#include "gazelog/judge.hpp"
#include "gazelog/log_file.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/stamps.hpp"
#include "gazetrace/gaze_raw.hpp"

namespace gazetrace {

#define GAZE_FORMAT(name, ...)               \
  double sniff_gaze_##name(const GazeFile&); \
  RawGaze read_gaze_##name(const GazeFile&, const GazeReadOptions&);
#include "gazelog/formats/formats.def"
#undef GAZE_FORMAT

namespace {

const std::vector<GazeFormat>& formats() {
  static const std::vector<GazeFormat> all{
#define GAZE_FORMAT(name, text, proof, description) \
  {{text, description, FormatProof::proof}, sniff_gaze_##name, read_gaze_##name},
#include "gazelog/formats/formats.def"
#undef GAZE_FORMAT
  };
  return all;
}

const GazeFormat& format_by_name(const std::string& name) {
  return find_named(formats(), name, "gaze format", "");
}

struct Guess {
  const GazeFormat* format;
  double confidence;
};

// The surest first; of equals the one listed first.
std::vector<Guess> sniff(const GazeFile& file) {
  std::vector<Guess> guesses;
  for (const GazeFormat& format : formats()) {
    if (const double confidence = format.sniff(file); confidence > 0) {
      guesses.push_back({&format, confidence});
    }
  }
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const Guess& a, const Guess& b) { return a.confidence > b.confidence; });
  return guesses;
}

// A file of another format than the one that was named is told so: what `act` throws says what the file looks like.
template <class Act>
auto with_a_hint_of_the_format(const std::string& named, const GazeFile& file, const Act& act) {
  try {
    return act();
  } catch (const Error& error) {
    constexpr double kSure = 0.8;
    const std::vector<Guess> guesses =
        error.kind() == ErrorKind::input && !named.empty() ? sniff(file) : std::vector<Guess>();
    if (guesses.empty() || guesses.front().format->name == named || guesses.front().confidence < kSure) {
      throw;
    }
    throw Error(ErrorKind::input, "", error.what(), "it looks like `format` " + guesses.front().format->name);
  }
}

// Says so where the numbers of a table have decimal commas. The first rows decide.
void add_decimal_mark(const GazeFile& file, RawGaze& raw) {
  std::size_t commas = 0;
  std::size_t points = 0;
  std::vector<std::string_view> cells;
  LineReader lines(head_of(file));
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || ((text.front() < '0' || text.front() > '9') && text.front() != '-')) {
      continue;
    }
    split_cells(text, separator_of(text, ' '), cells);
    for (const std::string_view cell : cells) {
      const std::size_t mark = cell.find_first_of(",.");
      if (mark != std::string_view::npos && cells.size() > 2 && number_from(trim(cell))) {
        (cell[mark] == ',' ? commas : points) += 1;
      }
    }
  }
  if (commas > 9 * points) {
    add_note(raw, "decimal mark", "comma", Evidence::statistics, "understood");
  }
}

RawGaze read_opened(GazeFile& file, const std::string& path, const GazeReadOptions& options) {
  const GazeFormat* format = options.format.empty() ? nullptr : &format_by_name(options.format);
  double confidence = 1;
  if (file.text.empty() || trim(head_of(file)).empty()) {
    throw Error(ErrorKind::input, path, "is empty", "give a gaze log with a header and at least one sample");
  }
  split_vector_cells(file);
  if (format == nullptr) {
    const std::vector<Guess> guesses = sniff(file);
    constexpr double kClaimed = 0.8;
    if (guesses.empty() || guesses.front().confidence < kClaimed) {
      refuse_foreign_file(file);
    }
    if (guesses.empty()) {
      throw Error(ErrorKind::input, path, "is not a gaze log of a known format",
                  "give a CSV or TSV with a header, or name the format with `format`");
    }
    format = guesses.front().format;
    confidence = guesses.front().confidence;
  }
  refuse_other_tables(file, !options.format.empty());
  refuse_split_numbers(file);
  if (confidence < 0.8) {
    refuse_prose(file);
  }
  RawGaze raw = format->read(file, options);
  add_decimal_mark(file, raw);
  raw.source = path;
  raw.format = format->name;
  raw.format_confidence = confidence;
  note_damages(file, raw);
  mend_stamps(raw, options.unordered);
  choose_recording(raw, options.recording);
  settle_display(raw);
  if (!options.events_file.empty()) {
    take_events(options.events_file, raw);
  }
  return raw;
}

// Files may be pipes, which can be read once: all that can go wrong with the text goes wrong in `act`.
template <class Act>
auto with_file(const std::string& path, const GazeReadOptions& options, const Act& act) {
  if (!options.format.empty()) {
    format_by_name(options.format);  // a name that is not known is refused before anything is read
  }
  GazeFile file = open_log_file(path, options.most_unpacked_bytes);
  return with_a_hint_of_the_format(options.format, file, [&] { return act(file); });
}

}  // namespace

std::string_view to_string(GazeValidity validity) {
  return name_of(validity, {"ok", "low_confidence", "blink", "lost", "off_screen", "interpolated"});
}

std::string_view to_string(Eye eye) {
  return name_of(eye, {"left", "right", "cyclopean"});
}

std::string_view to_string(GazeDevice device) {
  return device == GazeDevice::desktop ? "desktop" : "head-mounted";
}

std::string_view to_string(GazeKind kind) {
  return name_of(kind, {"screen", "direction", "scene-camera"});
}

std::string_view to_string(Evidence evidence) {
  return name_of(evidence, {"option", "sidecar", "header", "format", "statistics"});
}

std::string_view to_string(GazeEventType type) {
  return name_of(type, {"fixation", "saccade", "blink", "message", "segment", "trial", "aoi"});
}

std::vector<GazeFormatInfo> gaze_formats() {
  return {formats().begin(), formats().end()};
}

RawGaze read_raw_gaze(const std::string& path, const GazeReadOptions& options) {
  return with_file(path, options, [&](GazeFile& file) { return read_opened(file, path, options); });
}

GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options) {
  return with_file(path, options, [&](GazeFile& file) {
    const RawGaze raw = read_opened(file, path, options);
    if (options.format.empty()) {
      file = {};  // no hint can be needed: the text is given back before samples are made of the rows
    }
    if (needs_a_choice(raw)) {
      throw Error(ErrorKind::input, path, words_of_restart(raw) + "holds " + recordings_in_words(raw.recordings),
                  "say which of them is meant with `gaze-recording`, such as `gaze-recording` 1");
    }
    const Conventions conventions = conclude_conventions(raw, options);
    if (!raw.faults.empty()) {
      const RawFault& fault = raw.faults.front();
      throw Error(ErrorKind::input, fault.place, fault.problem, fault.remedy);
    }
    for (const ReadingDoubt& doubt : conventions.doubts) {
      if (doubt.refuses) {
        refuse_doubt(raw, doubt, options);
      }
    }
    GazeLog log = interpret(raw, conventions);
    for (const ReadingDoubt& doubt : conventions.doubts) {
      log.warnings.push_back(fmt::format("{}: {} ({}){}", path, doubt.what, doubt.evidence,
                                         doubt.setting.empty() ? "" : "; give " + doubt.setting));
    }
    return log;
  });
}

}  // namespace gazetrace
