// SPDX-License-Identifier: Apache-2.0
// Logs with one JSON object in each line, as Tobii's glasses write them.
#pragma once

#include <optional>
#include <string_view>

#include "core/text.hpp"
#include "gazelog/json.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

// Three numbers at `path`, or NaN.
inline Vec3d json_vector(const JsonLeaves& json, std::string_view path) {
  const std::vector<double> values = json.numbers(path);
  return values.size() == 3 ? Vec3d{values[0], values[1], values[2]} : Vec3d{kNan, kNan, kNan};
}

// `scaled_integer` of a number as it was written; empty where there is none.
inline std::optional<std::int64_t> json_time_ns(const JsonLeaves& json, std::string_view path, int exponent,
                                                const std::string& place) {
  const JsonLeaf* const leaf = json.find(path);
  if (leaf == nullptr || !leaf->is_number) {
    return std::nullopt;
  }
  std::int64_t t_ns = 0;
  if (scaled_integer(leaf->text, exponent, t_ns) != NumberStatus::ok) {
    throw Error(ErrorKind::input, place, "time '" + leaf->text.substr(0, 40) + "' does not fit int64 nanoseconds");
  }
  return t_ns;
}

// The raw gaze of Tobii's glasses: directions from the head where these are asked for, else places on the scene video.
inline RawGaze raw_of_glasses(const GazeFile& file, const GazeReadOptions& options, std::string clock) {
  RawGaze raw = raw_of(file, std::move(clock), "mm");
  raw.way_out =
      "`frame` head takes the directions of the eyes from the head; or map gaze onto the display "
      "and export that";
  raw.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  return raw;
}

// Declares the rows by the names of the direction, of the place, and of the point in space that is its witness.
inline void declare_glasses(RawGaze& raw, const GazeFile& file, const std::string& direction, const std::string& place,
                            const std::string& point, const WitnessTally& points) {
  if (raw.kind == GazeKind::direction) {
    declare_directions(raw, {direction, Evidence::format, "of each eye"}, GazeAxes::sranipal, Evidence::format,
                       file.path);
  } else {
    points.finish(raw, point);
    declare_places(raw, {PositionUnit::fraction, PositionOrigin::top_left, Evidence::format, place}, file.path);
  }
}

// The row of an eye's direction; lost where it is none.
inline RawSample direction_row(std::int64_t t_ns, std::int64_t row, std::size_t side, const Vec3d& direction,
                               double pupil_mm) {
  RawSample sample = missing_row(t_ns, row, side == 0 ? Eye::left : Eye::right);
  if (length(direction) > 0) {
    sample.at = direction;
    sample.validity = GazeValidity::ok;
  }
  sample.pupil = static_cast<float>(pupil_mm);
  return sample;
}

// Calls use(json, line number, place) for each line. A last line that was cut off is left out and told among `damages`,
// because recordings end like this when the battery is empty.
template <class Use>
void for_each_json_line(const GazeFile& file, Warnings& damages, const Use& use) {
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    if (trim(line).empty()) {
      continue;
    }
    const std::string place = place_of(file, lines.number());
    std::optional<JsonLeaves> json;
    try {
      json.emplace(line, place);
    } catch (const Error&) {
      if (!lines.rest().empty() || file.text.ends_with('\n') || lines.number() == 1) {
        throw;
      }
      damages.push_back(place + ": the last line is cut off; left out");
      return;
    }
    use(*json, lines.number(), place);
  }
}

}  // namespace gazetrace
