// SPDX-License-Identifier: Apache-2.0
// EyeLink ASC, what SR Research's edf2asc writes: `** ` preamble, MSG, START, SAMPLES, END, events, and samples that
// begin with a digit, `t x y pupil` or `t xl yl pl xr yr pr`, milliseconds of the tracker's clock. What a sample holds
// is announced by the SAMPLES line. At 2000 Hz each whole stamp stands twice; the second is half a millisecond later.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/eyelink_block.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/row_samples.hpp"

namespace gazetrace {
namespace {

constexpr std::int64_t kHalfMs = 500'000;
constexpr double kMissing = -32768;

// A block, with the messages that stand between the block before it and its START.
struct BlockBegin {
  std::int64_t line, begin_ns;
};

class AscReader {
 public:
  AscReader(const GazeFile& file, const GazeReadOptions& options) : file_(file), options_(options) {
    raw_ = raw_of(file, "tracker, from its start");
    exponent_ = declare_time(raw_, options, "first of a sample", 6, Evidence::format, file.path).exponent;
  }

  RawGaze read() {
    // Messages of a calibration go on in lines that begin with digits; only what stands between START and END is a
    // sample. Files of samples alone have neither.
    const bool has_blocks = file_.text.starts_with("START") || file_.text.find("\nSTART") != std::string::npos;
    if (const std::size_t numbers = has_blocks ? 0 : numbers_of_bare_samples(file_.text); numbers > 0) {
      is_bare_ = true;
      block_.has_right = numbers == 6;
    }
    LineReader lines(file_.text);
    for (std::string_view line; lines.next(line);) {
      line_ = lines.number();
      split_cells(line, ' ', words_);  // runs of blanks and tabs
      if (words_.empty()) {
        continue;
      }
      const char first = words_[0].front();
      if (first >= '0' && first <= '9') {
        if (in_block_ || !has_blocks) {
          read_sample();
        }
      } else if (first >= 'A' && first <= 'Z') {
        read_keyword(line);
      }
    }
    finish();
    return std::move(raw_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, std::string_view remedy = "the line is damaged; remove it") const {
    refuse_zero_bytes(words_, place_of(file_, line_));
    throw Error(ErrorKind::input, place_of(file_, line_), problem, remedy);
  }
  [[nodiscard]] bool has_word(std::string_view word) const {
    return std::find(words_.begin(), words_.end(), word) != words_.end();
  }
  [[nodiscard]] std::string_view word(std::size_t i) const { return i < words_.size() ? words_[i] : ""; }
  [[nodiscard]] std::int64_t time(std::string_view text) const {
    std::int64_t t_ns = 0;
    if (scaled_integer(text, exponent_, t_ns) != NumberStatus::ok) {
      fail(fmt::format("time '{}' is not a number of milliseconds", text.substr(0, 40)));
    }
    return t_ns;
  }
  [[nodiscard]] double number(std::size_t i) const {
    const auto value = number_from(word(i));
    // Anything else is what the exporter was told to write for missing values.
    return value && *value != kMissing && std::abs(*value) < 1e7 ? *value : kNan;
  }

  void read_keyword(std::string_view line) {
    const std::string_view key = words_[0];
    if (key == "MSG") {
      read_message(line);
    } else if (key == "START") {
      if (in_block_) {
        raw_.warnings.push_back(fmt::format("{}: the recording block that began at {} ns has no END",
                                            place_of(file_, line_), block_start_));
        add_segment(raw_.rows.empty() ? block_start_ : raw_.rows.back().t_ns, "recording block without its end",
                    line_ - 1);
      }
      block_start_ = time(word(1));
      blocks_.push_back({line_after_end_.value_or(line_), block_start_});
      line_after_end_.reset();
      in_block_ = true;
      last_stamp_.clear();
      compared_.fill(raw_.rows.size());  // the clock may start anew
      read_eyes();
    } else if (key == "END") {
      read_end();
    } else if (key == "SAMPLES") {
      read_samples_line();
    } else if (key == "PUPIL") {
      raw_.pupil_unit = to_lower(word(1));  // area or diameter, arbitrary units
    } else if (key == "EFIX" || key == "ESACC" || key == "EBLINK") {
      read_event(key);
    }
  }

  void read_eyes() {
    block_.has_left = has_word("LEFT") || !has_word("RIGHT");
    block_.has_right = has_word("RIGHT");
  }

  void add_segment(std::int64_t end_ns, std::string text, std::int64_t line) {
    raw_.events.push_back({GazeEventType::segment, Eye::cyclopean, block_start_, end_ns, std::move(text), line});
  }

  void read_samples_line() {
    block_ = {};
    read_eyes();
    block_.data = word(1);
    block_.has_velocity = has_word("VEL");
    block_.has_resolution = has_word("RES");
    block_.has_input = has_word("INPUT");
    block_.has_buttons = has_word("BUTTONS");
    const auto rate = std::find(words_.begin(), words_.end(), "RATE");
    if (rate != words_.end() && rate + 1 != words_.end()) {
      block_.rate_hz = number_from(rate[1]).value_or(0);
      raw_.nominal_rate_hz = std::max(raw_.nominal_rate_hz, block_.rate_hz);
    }
    if (block_.data != "GAZE") {
      fail(fmt::format("samples are {} data, not places on the screen", block_.data.substr(0, 20)),
           "export again with gaze positions: edf2asc -sg");
    }
  }

  void read_end() {
    const std::int64_t t_ns = time(word(1));
    line_after_end_ = line_ + 1;
    if (in_block_) {
      add_segment(t_ns, "recording block", line_);
    }
    in_block_ = false;
    const auto res = std::find(words_.begin(), words_.end(), "RES");
    if (res != words_.end() && words_.end() - res > 2) {
      const auto x = number_from(res[1]);
      const auto y = number_from(res[2]);
      if (x && y && *x > 0 && *y > 0) {
        resolutions_.push_back({*x, *y});
        raw_.pixels_per_degree_of_blocks.resize(blocks_.size());
        if (!blocks_.empty()) {
          raw_.pixels_per_degree_of_blocks.back() = {*x, *y};
        }
      }
    }
  }

  void read_message(std::string_view line) {
    const std::int64_t t_ns = time(word(1));
    const auto at = static_cast<std::size_t>(word(1).data() - line.data()) + word(1).size();
    const std::string_view text = trim(line.substr(at));
    if (word(2) == "GAZE_COORDS" || word(2) == "DISPLAY_COORDS") {
      read_coordinates(word(2) == "GAZE_COORDS");
    } else if (word(2) == "!CAL" && word(3) == "VALIDATION") {
      read_validation(t_ns);
    }
    add_message(raw_, t_ns, std::string(text), line_);
  }

  // Corners are inclusive: 0 0 1919 1079 is 1920 x 1080.
  void read_coordinates(bool is_gaze) {
    std::array<double, 4> corners{};
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = number(3 + i);
      if (std::isnan(corners[i])) {
        return;
      }
    }
    double width = corners[2] - corners[0] + 1;
    double height = corners[3] - corners[1] + 1;
    // Some programs write the size in place of the last corner: 0 0 1280 1024.
    const bool is_size = !is_usual_display_height(height) && is_usual_display_height(height - 1);
    width -= is_size ? 1 : 0;
    height -= is_size ? 1 : 0;
    if (!(width >= 2 && height >= 2 && width < 1e5 && height < 1e5) || (coordinates_are_gaze_ && !is_gaze)) {
      return;
    }
    coordinates_are_gaze_ = is_gaze;
    const std::array<int, 2> size{static_cast<int>(std::lround(width)), static_cast<int>(std::lround(height))};
    move_corner({corners[0], corners[1]}, size);
    if (raw_.rows.empty()) {
      raw_.recording_geometry = DisplayGeometry{.width_px = size[0], .height_px = size[1]};
      coordinates_ = fmt::format("{} {} {} {} {}, {}", word(2), word(3), word(4), word(5), word(6),
                                 is_size ? "which is the size, not the last pixel" : "inclusive corners");
    }
  }

  // A corner and a size hold for the rows below the line that states them.
  void move_corner(const Vec2d& corner, const std::array<int, 2>& size) {
    const std::size_t next_row = raw_.rows.size();
    const std::array<int, 2> before = raw_.corners.empty() ? size_ : raw_.corners.back().size_px;
    if (next_row == 0) {
      raw_.declared.corner = corner;
      size_ = size;
    } else if (!(corner == corner_of(raw_, raw_.declared, next_row)) || before != size) {
      raw_.corners.push_back({next_row, corner, size});
    }
  }

  // !CAL VALIDATION HV13 LR LEFT  GOOD ERROR 0.35 avg. 0.48 max  OFFSET 0.18 deg. -6.4,-0.9 pix.
  void read_validation(std::int64_t t_ns) {
    const auto error = std::find(words_.begin(), words_.end(), "ERROR");
    if (error == words_.end() || words_.end() - error < 4) {
      return;
    }
    const auto mean = number_from(error[1]);
    const auto most = number_from(error[3]);
    if (mean) {
      raw_.calibrations.push_back({t_ns,
                                   has_word("LEFT")    ? Eye::left
                                   : has_word("RIGHT") ? Eye::right
                                                       : Eye::cyclopean,
                                   *mean, most.value_or(kNan), line_});
    }
  }

  // EFIX L begin end duration x y pupil; ESACC L begin end duration x y x y amplitude velocity, with two more where
  // the resolution is written. Durations count the time of the last sample, too. They can be garbage, and are believed
  // where they fit begin and end.
  void read_event(std::string_view key) {
    if (words_.size() < 4) {
      return;
    }
    const Eye eye = word(1) == "R" ? Eye::right : Eye::left;
    const std::int64_t begin = time(word(2));
    const std::int64_t end = time(word(3));
    if (end < begin) {
      return;
    }
    const GazeEventType type = key == "EFIX"    ? GazeEventType::fixation
                               : key == "ESACC" ? GazeEventType::saccade
                                                : GazeEventType::blink;
    GazeEvent event{type, eye, begin, end, {}, line_};
    constexpr std::int64_t kLongestSampleNs = 20'000'000;
    std::int64_t duration_ns = 0;
    std::int64_t length_ns = 0;
    if (scaled_integer(word(4), exponent_, duration_ns) == NumberStatus::ok &&
        !__builtin_sub_overflow(end, begin, &length_ns) && duration_ns >= length_ns &&
        duration_ns - length_ns <= kLongestSampleNs) {
      event.stated_duration_ns = duration_ns;
    }
    if (type == GazeEventType::saccade && (words_.size() == 11 || words_.size() == 13)) {
      event.stated_amplitude_deg = number_from(word(9));
      event.stated_peak_velocity_deg_s = number_from(word(10));
    }
    raw_.events.push_back(std::move(event));
    if (type == GazeEventType::fixation) {
      compare_fixation(eye, begin, end);
    } else {
      (type == GazeEventType::blink ? blinks_ : saccades_)[eye == Eye::right ? 1 : 0].push_back({begin, end});
    }
  }

  // The tracker's own mean of a fixation, behind the duration, or behind HREF's where both are written, against that of
  // its samples, which stand above it. Fixations of one eye follow each other, so each sample is looked at for one
  // only.
  void compare_fixation(Eye eye, std::int64_t begin_ns, std::int64_t end_ns) {
    const std::size_t column = words_.size() == 8 || words_.size() == 10 ? 5 : 8;
    if (words_.size() < column + 2) {
      return;
    }
    double x = 0;
    double y = 0;
    double count = 0;
    std::size_t& compared = compared_[eye == Eye::right ? 1 : 0];
    const auto first = raw_.rows.begin() + static_cast<std::ptrdiff_t>(compared);
    const auto behind =
        std::partition_point(first, raw_.rows.end(), [&](const RawSample& sample) { return sample.t_ns <= end_ns; });
    for (auto sample = behind; sample != first && (sample - 1)->t_ns >= begin_ns; --sample) {
      const RawSample s = *(sample - 1);
      if (s.eye == eye && s.validity != GazeValidity::lost) {
        const Vec2d corner = corner_of(raw_, raw_.declared, static_cast<std::size_t>(sample - 1 - raw_.rows.begin()));
        x += s.at.x - corner.x;
        y += s.at.y - corner.y;
        ++count;
      }
    }
    compared = static_cast<std::size_t>(behind - raw_.rows.begin());
    if (count > 0) {
      const Vec2d corner = corner_of(raw_, raw_.declared, raw_.rows.size());
      const Vec2d mean{number(column) - corner.x, number(column + 1) - corner.y};
      fixations_.add(x / count, y / count, mean.x, mean.y);
      fixations_of_eye_[eye == Eye::right ? 1 : 0].add(x / count, y / count, mean.x, mean.y);
    }
  }

  void read_sample() {
    std::int64_t t_ns = time(words_[0]);
    const bool repeats = words_[0] == last_stamp_;
    last_stamp_ = words_[0];
    if (repeats && block_.rate_hz > 1000) {
      t_ns += kHalfMs;
      last_stamp_.clear();  // a third one would be a repeat indeed
    }
    const std::size_t needed = 1 + 3 * block_.eyes();
    if (words_.size() < needed) {
      fail(fmt::format("the sample has {} of {} values of {}", words_.size(), needed,
                       block_.eyes() == 2 ? "two eyes" : "one eye"),
           "it is short or cut off; remove or mend it");
    }
    const std::string_view flags = find_flags();
    if (is_bare_ && block_.eyes() == 1) {
      raw_.rows.push_back(eye_sample(t_ns, Eye::cyclopean, 1, flags));  // which eye it was is not said
      return;
    }
    std::size_t column = 1;
    for (const Eye eye : {Eye::left, Eye::right}) {
      if (eye == Eye::left ? block_.has_left : block_.has_right) {
        raw_.rows.push_back(eye_sample(t_ns, eye, column, flags));
        column += 3;
      }
    }
    if (block_.has_resolution) {
      const Vec2d res{number(block_.resolution_column()), number(block_.resolution_column() + 1)};
      if (res.x > 0 && res.y > 0) {
        resolutions_.push_back(res);
      }
    }
  }

  [[nodiscard]] std::string_view find_flags() const {
    const std::string_view text = word(block_.flags_column());
    const std::size_t length = block_.eyes() == 2 ? 5 : 3;
    return text.size() == length && text.find_first_not_of(".ICR") == std::string_view::npos ? text : "";
  }

  RawSample eye_sample(std::int64_t t_ns, Eye eye, std::size_t column, std::string_view flags) {
    RawSample sample = position_row(t_ns, line_, eye, {number(column), number(column + 1)}, number(column + 2));
    if (sample.at.x == 0 && sample.at.y == 0 && number(column + 2) == 0) {
      return missing_row(t_ns, line_, eye);  // edf2asc was told to write missing values as 0
    }
    // What the tracker says of its own sample is not believed where the user says that there is none.
    const auto both_are = [&](double value) { return sample.at.x == value && sample.at.y == value; };
    const auto is_given = [&](double mark) {
      return mark == 0 ? both_are(0) : sample.at.x == mark || sample.at.y == mark;
    };
    const bool is_mark = options_.missing_value && is_given(*options_.missing_value);
    if (is_mark) {
      sample.validity = GazeValidity::lost;
    } else if (sample.validity == GazeValidity::ok && !flags.empty()) {
      // I..: interpolated. Then two for each eye: the corneal reflection lost, or just found again.
      const std::size_t at = flags.size() == 5 && eye == Eye::right ? 3 : 1;
      if (flags[at] == 'C' || flags[at + 1] == 'R') {
        sample.validity = GazeValidity::low_confidence;
      } else if (flags[0] == 'I') {
        sample.validity = GazeValidity::interpolated;
      }
    }
    return sample;
  }

  // A tracker that was started anew counts from another zero: then another session begins.
  void divide() {
    std::size_t sessions = 1;
    for (std::size_t i = 1; i < blocks_.size(); ++i) {
      sessions += blocks_[i].begin_ns < blocks_[i - 1].begin_ns ? 1 : 0;
    }
    std::size_t session = 1;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      session += i > 0 && blocks_[i].begin_ns < blocks_[i - 1].begin_ns ? 1 : 0;
      if (sessions == 1) {
        begin_block(raw_, blocks_[i].line);
      } else {
        begin_recording(raw_, std::to_string(session), blocks_[i].line);
      }
    }
  }

  void finish() {
    if (raw_.rows.empty()) {
      const bool has_events = std::any_of(raw_.events.begin(), raw_.events.end(), [](const GazeEvent& event) {
        return event.type == GazeEventType::fixation || event.type == GazeEventType::saccade;
      });
      if (has_events) {
        throw Error(ErrorKind::input, file_.path,
                    "holds the tracker's events and no samples, as `edf2asc -e` writes it",
                    "run edf2asc again without -e, for samples and events");
      }
      return;
    }
    if (is_bare_ && !options_.display && !options_.fallback_display && !options_.guess_display) {
      throw Error(ErrorKind::input, file_.path,
                  "holds EyeLink samples without a header, as edf2asc writes them without messages: the size of the "
                  "display is not in it",
                  "run edf2asc again with messages, or give `screen-px` W,H of the recording");
    }
    divide();
    mark_blinks(raw_.rows, Eye::left, blinks_[0], saccades_[0]);
    mark_blinks(raw_.rows, Eye::right, blinks_[1], saccades_[1]);
    if (in_block_) {
      add_segment(raw_.rows.back().t_ns, "recording block without its end", line_);
      raw_.damages.push_back(
          fmt::format("{}: the last recording block has no END: the file may be cut off", file_.path));
    }
    if (!resolutions_.empty()) {
      Vec2d sum;
      for (const Vec2d& r : resolutions_) {
        sum = {sum.x + r.x, sum.y + r.y};
      }
      const auto n = static_cast<double>(resolutions_.size());
      raw_.pixels_per_degree = Vec2d{sum.x / n, sum.y / n};
      add_note(raw_, "resolution",
               fmt::format("{:.2f} x {:.2f} px/deg", raw_.pixels_per_degree->x, raw_.pixels_per_degree->y),
               Evidence::header, block_.has_resolution ? "RES of the samples and blocks" : "RES of END");
    }
    if (const auto& g = raw_.recording_geometry) {
      add_note(raw_, "display size", fmt::format("{}x{} px", g->width_px, g->height_px), Evidence::header,
               coordinates_);
    }
    fixations_.finish(raw_, "the fixations' means (EFIX)");
    if (block_.eyes() == 2) {
      fixations_of_eye_[0].finish(raw_, "the left eye's fixations' means (EFIX L)", Eye::left);
      fixations_of_eye_[1].finish(raw_, "the right eye's fixations' means (EFIX R)", Eye::right);
    }
    declare_places(raw_, {PositionUnit::px, PositionOrigin::top_left, Evidence::header, "SAMPLES GAZE"}, file_.path);
  }

  const GazeFile& file_;
  const GazeReadOptions& options_;
  RawGaze raw_;
  int exponent_ = 6;
  EyeLinkBlock block_;
  std::int64_t line_ = 0;
  std::vector<std::string_view> words_;
  std::string last_stamp_;
  std::int64_t block_start_ = 0;
  std::optional<std::int64_t> line_after_end_ = 1;  // of the block before; empty: it has not ended
  std::vector<BlockBegin> blocks_;
  bool in_block_ = false;
  bool is_bare_ = false;       // samples alone, without a header
  std::array<int, 2> size_{};  // of the display where the rows begin
  bool coordinates_are_gaze_ = false;
  std::string coordinates_;
  std::vector<Vec2d> resolutions_;
  std::array<std::vector<TimeSpan>, 2> blinks_, saccades_;
  WitnessTally fixations_;
  std::array<WitnessTally, 2> fixations_of_eye_;
  std::array<std::size_t, 2> compared_{};  // of each eye: the first sample behind its last fixation in the block
};

}  // namespace

double sniff_gaze_eyelink(const GazeFile& file) {
  const std::string_view head = head_of(file);
  const WordsIn has{head};
  if (head.starts_with("** CONVERTED FROM") && has("EYELINK")) {
    return 0.99;
  }
  const int marks = (has("\nSAMPLES") ? 1 : 0) + (has("\nSTART") ? 1 : 0) + (has("\nMSG") ? 1 : 0) +
                    (has("\nPRESCALER") ? 1 : 0) + (head.starts_with("**") || head.starts_with("MSG") ? 1 : 0);
  return marks >= 3 ? 0.9 : marks == 2 ? 0.4 : marks == 0 && numbers_of_bare_samples(head) > 0 ? 0.85 : 0.0;
}

RawGaze read_gaze_eyelink(const GazeFile& file, const GazeReadOptions& options) {
  return AscReader(file, options).read();
}

}  // namespace gazetrace
