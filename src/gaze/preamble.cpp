// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.hpp"
#include "gaze/mapped_table.hpp"

namespace gazetrace {
namespace {

// "# display_px 1920 1080", also with a colon or an equals sign after the key.
void read_line(std::string_view line, const std::string& place, GazetracePreamble& preamble) {
  line.remove_prefix(std::min(line.find_first_not_of('#'), line.size()));
  line = trim(line);
  const std::size_t key_end = std::min(line.find_first_of(" \t:="), line.size());
  const std::string_view key = line.substr(0, key_end);
  std::string_view rest = line.substr(key_end);
  while (!rest.empty() && (rest.front() == ':' || rest.front() == '=' || rest.front() == ' ' || rest.front() == '\t')) {
    rest.remove_prefix(1);
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
    if (!preamble.geometry) {
      preamble.geometry.emplace();
    }
    return *preamble.geometry;
  };
  if (key == "gazetrace-gaze") {
    preamble.version = static_cast<int>(std::min(numbers(1, true)[0], 1e9));
  } else if (key == "clock") {
    preamble.clock = rest;
  } else if (key == "kind") {
    preamble.is_scene_camera = rest == to_string(GazeKind::scene_camera);
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
    preamble.pixels_per_degree = Vec2d{density[0], density[1]};
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
    read_line(line.text, place_of(file, line.line), preamble);
  }
  return preamble;
}

}  // namespace gazetrace
