// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "core/text.hpp"
#include "gazelog/mapped_table.hpp"

namespace gazetrace {
namespace {

// Takes the words of a line that is not about geometry one after another. Throws Error(input) naming the line where one
// is wrong.
class Words {
 public:
  Words(std::string_view key, std::string_view rest, const std::string& place)
      : key_(key), rest_(rest), place_(place) {}

  std::string_view next() {
    const std::size_t end = std::min(rest_.find_first_of(" \t"), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_ = trim(rest_.substr(end));
    return word;
  }
  // NaN where the log did not know it.
  double number() {
    const std::string_view word = next();
    const auto value = is_missing(word) && !word.empty() ? std::optional(kNan) : number_from(word);
    return value ? *value : fail(word, "a number");
  }
  std::int64_t time_ns() {
    const std::string_view word = next();
    std::int64_t t_ns = 0;
    const bool is_whole = word.find_first_not_of("-0123456789") == std::string_view::npos;
    return is_whole && scaled_integer(word, 0, t_ns) == NumberStatus::ok ? t_ns : fail(word, "whole nanoseconds");
  }
  template <class Value>
  Value one_of(std::initializer_list<Value> values) {
    const std::string_view word = next();
    for (const Value value : values) {
      if (word == to_string(value)) {
        return value;
      }
    }
    return static_cast<Value>(fail(word, "one of the names known for it"));
  }
  // A value behind its name, where the next word has one.
  std::optional<double> named_number(std::string_view name) {
    return take(name) ? std::optional(number()) : std::nullopt;
  }
  std::optional<std::int64_t> named_time_ns(std::string_view name) {
    return take(name) ? std::optional(time_ns()) : std::nullopt;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  bool take(std::string_view name) {
    const bool is_next = rest_.starts_with(name);
    rest_.remove_prefix(is_next ? name.size() : 0);
    return is_next;
  }
  [[noreturn]] int fail(std::string_view word, std::string_view wanted) const {
    throw Error(ErrorKind::input, place_, fmt::format("`# {}` has '{}' where it needs {}", key_, word, wanted),
                "mend the line, or leave it out");
  }

  std::string_view key_, rest_;
  const std::string& place_;
};

// Reads the lines that gazetrace writes besides rows. Returns whether the line was one of them.
bool read_record(std::string_view key, std::string_view rest, const PreambleLine& line, const std::string& place,
                 GazetracePreamble& preamble) {
  Words words(key, rest, place);
  if (key == "event") {
    GazeEvent event;
    event.type =
        words.one_of({GazeEventType::fixation, GazeEventType::saccade, GazeEventType::blink, GazeEventType::message,
                      GazeEventType::segment, GazeEventType::trial, GazeEventType::aoi});
    event.eye = words.one_of({Eye::left, Eye::right, Eye::cyclopean});
    event.begin_ns = words.time_ns();
    event.end_ns = words.time_ns();
    if (std::int64_t length_ns = 0; __builtin_sub_overflow(event.end_ns, event.begin_ns, &length_ns)) {
      throw Error(ErrorKind::input, place,
                  fmt::format("`# event` lasts from {} to {}, longer than int64 nanoseconds count", event.begin_ns,
                              event.end_ns),
                  "mend the line, or leave it out");
    }
    if (event.type == GazeEventType::fixation || event.type == GazeEventType::saccade ||
        event.type == GazeEventType::blink) {
      event.stated_duration_ns = words.named_time_ns("duration_ns=");
      event.stated_amplitude_deg = words.named_number("amplitude_deg=");
      event.stated_peak_velocity_deg_s = words.named_number("peak_deg_s=");
    }
    event.text = words.rest();
    event.row = line.line;
    preamble.stated.events.push_back(std::move(event));
  } else if (key == "calibration") {
    GazeCalibration calibration;
    calibration.eye = words.one_of({Eye::left, Eye::right, Eye::cyclopean});
    calibration.t_ns = words.time_ns();
    calibration.mean_error_deg = words.number();
    calibration.max_error_deg = words.number();
    calibration.row = line.line;
    preamble.stated.calibrations.push_back(calibration);
  } else if (key == "head") {
    HeadPose pose;
    pose.t_ns = words.time_ns();
    for (double* const value : {&pose.position_m.x, &pose.position_m.y, &pose.position_m.z, &pose.orientation.x,
                                &pose.orientation.y, &pose.orientation.z, &pose.orientation.w}) {
      *value = words.number();
    }
    preamble.stated.head.push_back(pose);
  } else if (key == "eye") {
    preamble.stated.stated_eye = words.one_of({Eye::left, Eye::right});
  } else if (key == "device") {
    preamble.stated.device = words.one_of({GazeDevice::desktop, GazeDevice::head_mounted});
  } else if (key == "rate_hz") {
    preamble.stated.nominal_rate_hz = words.number();
  } else if (key == "sample_age") {
    preamble.stated.sample_age_unknown = rest == "unknown";
  } else {
    return false;
  }
  return true;
}

// "# display_px 1920 1080", also with a colon or an equals sign after the key.
void read_line(const PreambleLine& preamble_line, const std::string& place, GazetracePreamble& preamble) {
  std::string_view line = preamble_line.text;
  line.remove_prefix(std::min(line.find_first_not_of('#'), line.size()));
  line = trim(line);
  const std::size_t key_end = std::min(line.find_first_of(" \t:="), line.size());
  const std::string_view key = line.substr(0, key_end);
  std::string_view rest = line.substr(key_end);
  while (!rest.empty() && (rest.front() == ':' || rest.front() == '=' || rest.front() == ' ' || rest.front() == '\t')) {
    rest.remove_prefix(1);
  }
  // Other tables may have comments that begin with one of these words.
  if (preamble.version && read_record(key, rest, preamble_line, place, preamble)) {
    return;
  }
  std::vector<std::string_view> words;
  split_cells(rest, ' ', words);
  const auto numbers = [&](std::size_t count, bool positive) {
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = i < words.size() ? number_from(words[i]) : std::nullopt;
      if (!value || words.size() != count || (positive && !(*value > 0))) {
        throw Error(ErrorKind::input, place,
                    fmt::format("`# {}` needs {} {}, not '{}'", key, count,
                                positive ? (count == 1 ? "positive number" : "positive numbers") : "numbers", rest));
      }
      values[i] = *value;
    }
    return values;
  };
  const auto geometry = [&]() -> DisplayGeometry& {
    std::optional<DisplayGeometry>& stated = preamble.stated.recording_geometry;
    return stated ? *stated : stated.emplace();
  };
  if (key == "gazetrace-gaze") {
    preamble.version = static_cast<int>(std::min(numbers(1, true)[0], 1e9));
  } else if (key == "clock") {
    preamble.stated.clock = rest;
  } else if (key == "kind") {
    preamble.stated.kind = rest == to_string(GazeKind::scene_camera) ? GazeKind::scene_camera : GazeKind::screen;
  } else if (key == "display_px") {
    const auto px = numbers(2, true);
    if (px[0] != std::floor(px[0]) || px[1] != std::floor(px[1]) || px[0] > 1e6 || px[1] > 1e6) {
      throw Error(ErrorKind::input, place, fmt::format("`# display_px` needs two whole numbers, not '{}'", rest));
    }
    geometry().width_px = static_cast<int>(px[0]);
    geometry().height_px = static_cast<int>(px[1]);
  } else if (key == "display_mm" || key == "display_cm") {
    const auto size = numbers(2, true);
    const double per_cm = key == "display_mm" ? 10.0 : 1.0;
    geometry().width_cm = size[0] / per_cm;
    geometry().height_cm = size[1] / per_cm;
  } else if (key == "distance_mm" || key == "distance_cm") {
    geometry().distance_cm = numbers(1, true)[0] / (key == "distance_mm" ? 10.0 : 1.0);
  } else if (key == "pixels_per_degree") {
    const auto density = numbers(2, true);
    preamble.stated.pixels_per_degree = Vec2d{density[0], density[1]};
  } else if (key == "eye_cm") {
    const auto offset = numbers(2, false);
    geometry().eye_x_cm = offset[0];
    geometry().eye_y_cm = offset[1];
  }
}

}  // namespace

GazetracePreamble read_preamble(const GazeFile& file, const DelimitedTable& table) {
  GazetracePreamble preamble;
  for (const PreambleLine& line : table.preamble) {
    read_line(line, place_of(file, line.line), preamble);
  }
  return preamble;
}

}  // namespace gazetrace
