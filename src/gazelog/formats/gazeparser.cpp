// SPDX-License-Identifier: Apache-2.0
// SimpleGazeTracker of GazeParser: `#` lines of settings and messages, then rows after `#DATAFORMAT`, milliseconds and
// pixels of the screen; `#START_REC` begins a recording with a clock of its own; FAIL stands for what is missing.
#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"

namespace gazetrace {
namespace {

struct GazeParserCells {
  std::optional<std::size_t> time, x, y, pupil, right_x, right_y, right_pupil;
};

GazeParserCells cells_of(const std::vector<std::string_view>& names) {
  const auto at = [&](std::initializer_list<std::string_view> wanted) -> std::optional<std::size_t> {
    for (std::size_t i = 1; i < names.size(); ++i) {
      if (std::find(wanted.begin(), wanted.end(), trim(names[i])) != wanted.end()) {
        return i - 1;
      }
    }
    return std::nullopt;
  };
  return {at({"T"}), at({"X", "LX"}), at({"Y", "LY"}), at({"P", "LP"}), at({"RX"}), at({"RY"}), at({"RP"})};
}

class GazeParserReader {
 public:
  GazeParserReader(const GazeFile& file, const GazeReadOptions& options) : file_(file) {
    raw_.source = file.path;
    scale_ = declare_time(raw_, options, "T", 6, Evidence::format, file.path);
  }

  RawGaze read() {
    LineReader lines(file_.text);
    for (std::string_view line; lines.next(line);) {
      split_cells(trim(line), ',', words_);
      line_ = lines.number();
      if (words_.empty() || words_[0].empty()) {
        continue;
      }
      words_[0].front() == '#' ? read_setting() : read_row();
    }
    if (display_.width_px > 0 && display_.height_px > 0) {
      display_.width_cm = per_cm_.x > 0 ? display_.width_px / per_cm_.x : 0;
      display_.height_cm = per_cm_.y > 0 ? display_.height_px / per_cm_.y : 0;
      raw_.recording_geometry = display_;
      state_display_px(raw_, display_.width_px, display_.height_px, Evidence::header, "SCREEN_WIDTH and SCREEN_HEIGHT");
    }
    declare_places(raw_, {PositionUnit::px, origin_, Evidence::format, "X, Y", false, Evidence::header}, file_.path);
    return std::move(raw_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(ErrorKind::input, place_of(file_, line_), problem, "mend the line, or remove it");
  }
  [[nodiscard]] std::string_view word(std::size_t i) const { return i < words_.size() ? trim(words_[i]) : ""; }
  [[nodiscard]] double number(const std::optional<std::size_t>& i) const {
    return i ? number_from(word(*i)).value_or(kNan) : kNan;  // FAIL
  }
  [[nodiscard]] std::int64_t time(std::string_view text) const {
    std::int64_t t_ns = 0;
    if (scaled_integer(text, scale_.exponent, t_ns) != NumberStatus::ok) {
      fail(fmt::format("time '{}' is not a number", text.substr(0, 40)));
    }
    return t_ns;
  }

  void read_setting() {
    const std::string_view key = word(0);
    if (key == "#DATAFORMAT") {
      cells_ = cells_of(words_);
    } else if (key == "#SCREEN_WIDTH") {
      display_.width_px = static_cast<int>(number(1));
    } else if (key == "#SCREEN_HEIGHT") {
      display_.height_px = static_cast<int>(number(1));
    } else if (key == "#DOTS_PER_CENTIMETER_H") {
      per_cm_.x = number(1);
    } else if (key == "#DOTS_PER_CENTIMETER_V") {
      per_cm_.y = number(1);
    } else if (key == "#VIEWING_DISTANCE") {
      display_.distance_cm = number(1);
    } else if (key == "#SCREEN_ORIGIN") {
      const std::string origin = to_lower(word(1));
      origin_ = origin == "topleft"      ? PositionOrigin::top_left
                : origin == "bottomleft" ? PositionOrigin::bottom_left
                : origin == "center"     ? PositionOrigin::center
                                         : PositionOrigin::automatic;
    } else if (key == "#RECORDED_EYE") {
      eye_ = word(1) == "L" ? Eye::left : word(1) == "R" ? Eye::right : Eye::cyclopean;
    } else if (key == "#START_REC") {
      begin_recording(raw_, std::to_string(++recordings_), line_);
    } else if (key == "#MESSAGE" && words_.size() > 2) {
      add_message(raw_, time(word(1)), std::string(word(2)), line_);
    }
  }

  void read_row() {
    if (!cells_.time || !cells_.x || !cells_.y) {
      fail("there is no #DATAFORMAT with T, X and Y above the rows");
    }
    const std::int64_t t_ns = time(word(*cells_.time));
    const Eye first = cells_.right_x ? Eye::left : eye_;
    raw_.rows.push_back(position_row(t_ns, line_, first, {number(cells_.x), number(cells_.y)}, number(cells_.pupil)));
    if (cells_.right_x) {
      raw_.rows.push_back(position_row(t_ns, line_, Eye::right, {number(cells_.right_x), number(cells_.right_y)},
                                       number(cells_.right_pupil)));
    }
  }

  const GazeFile& file_;
  RawGaze raw_;
  TimeScale scale_;
  std::vector<std::string_view> words_;
  std::int64_t line_ = 0;
  GazeParserCells cells_;
  DisplayGeometry display_;
  Vec2d per_cm_;
  PositionOrigin origin_ = PositionOrigin::automatic;
  Eye eye_ = Eye::cyclopean;
  int recordings_ = 0;
};

}  // namespace

double sniff_gaze_gazeparser(const GazeFile& file) {
  return file.text.starts_with("#SimpleGazeTrackerDataFile") ? 0.99 : 0.0;
}

RawGaze read_gaze_gazeparser(const GazeFile& file, const GazeReadOptions& options) {
  return GazeParserReader(file, options).read();
}

}  // namespace gazetrace
